#include <cmath>
#include <limits>

#include "style_checks.h"
#include <gtest/gtest.h>

#include "normalshop/core/color_map.h"
#include "normalshop/core/error.h"
#include "normalshop/rgbn/shade_exaggerated.h"

namespace normalshop::test {
namespace {

TEST(ShadeExaggerated, APlaneKeepsItsPlainLight) {
  for (const double slope : {-1.5, -0.3, 0.0, 0.6, 2.0}) {
    const Vec3f n = tilted(slope, -0.4 * slope);
    const Image<Vec3f> normals(60, 60, n);
    ColorImage out(60, 60);
    ExaggeratedOptions options;
    for (const float detail : {0.0F, 0.4F, 1.0F}) {
      options.detail = detail;
      shade_exaggerated(normals, {}, out, out.rect(), options);
      const float expected = 0.5F + 0.5F * (1.0F - 0.5F * detail) * n.dot(light_vector(options));
      EXPECT_NEAR(tone(out(30, 30)), expected, 3e-3F) << slope;
      EXPECT_NEAR(tone(out(0, 59)), expected, 3e-3F) << slope;
    }
  }
}

TEST(ShadeExaggerated, ShowsDetailsHoweverTheSurfaceStandsToTheLight) {
  // Small furrows that run up, on a plane with this slope.
  for (const double slope : {-0.8, 0.0, 0.5}) {
    const auto normals = picture_of(160, 60, [&](double x, double) {
      return tilted(slope + 0.1 * std::cos(x * 3.14159265 / 6.0), 0.0);
    });
    ExaggeratedOptions options;
    options.azimuth = 180.0F;
    ColorImage out(160, 60);
    shade_exaggerated(normals, {}, out, out.rect(), options);
    const float contrast = std::abs(tone(out(80, 30)) - tone(out(86, 30)));
    const float lit = normals(80, 30).dot(light_vector(options));
    const float plain = 0.5F * std::abs(lit - normals(86, 30).dot(light_vector(options)));
    EXPECT_GT(contrast, 0.1F) << slope;
    EXPECT_GT(contrast, plain) << slope;
  }
}

TEST(ShadeExaggerated, WithoutDetailItIsTheSmoothestNormalsLight) {
  const auto normals = lively(80, 60);
  const auto drawn = [&](float gain, float detail) {
    ExaggeratedOptions options;
    options.gain = gain;
    options.detail = detail;
    ColorImage out(80, 60, Vec3f::Zero());
    shade_exaggerated(normals, {}, out, out.rect(), options);
    return out;
  };
  const ColorImage plain = drawn(16.0F, 0.0F);
  EXPECT_TRUE(same_in(drawn(0.0F, 0.0F), plain, plain.rect()));
  const ColorImage no_gain = drawn(0.0F, 0.5F);
  for (int y = 0; y < 60; ++y) {
    for (int x = 0; x < 80; ++x) {
      if (plain(x, y) == Vec3f(Vec3f::Zero())) continue;
      EXPECT_NEAR(tone(no_gain(x, y)), 0.5F + 0.75F * (tone(plain(x, y)) - 0.5F), 4e-3F);
    }
  }
}

TEST(ShadeExaggerated, RegionsThreadsEdgesAndGaps) {
  const auto draw = [](ImageView<Vec3f> normals, ColorSpan target, Rect region) {
    ExaggeratedOptions options;
    options.levels = 4;
    return shade_exaggerated(normals, {}, target, region, options);
  };
  const Vec3f background(0.1F, 0.2F, 7.0F);
  expect_a_style(background, std::optional(background), draw);
}

TEST(ShadeExaggerated, RejectsOptionsOutOfRange) {
  const Image<Vec3f> normals(1, 1, Vec3f(0.0F, 0.0F, 1.0F));
  ColorImage out(1, 1);
  ExaggeratedOptions options;
  options.levels = 99;
  EXPECT_THROW(shade_exaggerated(normals, {}, out, out.rect(), options), InvalidInput);
  for (float ExaggeratedOptions::*member :
       {&ExaggeratedOptions::scale, &ExaggeratedOptions::gain, &ExaggeratedOptions::detail,
        &ExaggeratedOptions::balance}) {
    options = {};
    options.*member = std::numeric_limits<float>::quiet_NaN();
    EXPECT_THROW(shade_exaggerated(normals, {}, out, out.rect(), options), InvalidInput);
  }
}

}  // namespace
}  // namespace normalshop::test
