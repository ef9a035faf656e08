#include <cmath>
#include <limits>
#include <set>

#include "style_checks.h"
#include <gtest/gtest.h>

#include "normalshop/core/error.h"
#include "normalshop/rgbn/shade_toon.h"

namespace normalshop::test {
namespace {

/// Light from the front, hard normals.
ToonOptions frontal(int bands) {
  ToonOptions options;
  options.elevation = 90.0F;
  options.bands = bands;
  options.wrap = 0.0F;
  options.sigma = 0.0F;
  options.tint = 0.0F;
  return options;
}

/// Where along x the tone crosses the middle between two bands, right of `from`.
double crossing(const ColorImage& image, int y, int from, float level) {
  for (int x = from; x + 1 < image.width(); ++x) {
    const float a = image(x, y).y();
    const float b = image(x + 1, y).y();
    if ((a - level) * (b - level) <= 0.0F && a != b) return x + (a - level) / (a - b);
  }
  return -1.0;
}

TEST(ShadeToon, BandsMeetAtTheirPlaceOnASphere) {
  const double radius = 100.0;
  const auto normals = ball(241, radius);
  ColorImage out(241, 241, Vec3f::Zero());
  shade_toon(normals, {}, out, out.rect(), frontal(3));
  std::set<float> tones;
  for (int x = 120; x < 220; x += 4) tones.insert(out(x, 120).y());
  const float light = *tones.rbegin();
  const float dark = *tones.begin();
  EXPECT_EQ(light, out(120, 120).y());
  EXPECT_NEAR(light, 1.0F, 1e-6F);
  const float middle = out(120 + 80, 120).y();  // n . l = 0.6
  EXPECT_LT(dark, middle);
  EXPECT_LT(middle, light);
  // n . l = sqrt(1 - (x / R)^2) = 2 / 3 and 1 / 3
  EXPECT_NEAR(crossing(out, 120, 120, 0.5F * (light + middle)) - 120.0,
              radius * std::sqrt(1.0 - 4.0 / 9.0), 0.1);
  EXPECT_NEAR(crossing(out, 120, 120, 0.5F * (middle + dark)) - 120.0,
              radius * std::sqrt(1.0 - 1.0 / 9.0), 0.1);
}

TEST(ShadeToon, StepsAreOnePixelWideOrAsSoftAsWished) {
  const auto normals = ball(241, 100.0);
  const auto between = [&](float softness) {
    ToonOptions options = frontal(2);
    options.softness = softness;
    ColorImage out(241, 241, Vec3f::Zero());
    shade_toon(normals, {}, out, out.rect(), options);
    int count = 0;  // n . l = 1 / 2 at 86.6
    for (int x = 120; x < 219; ++x) {
      count += out(x, 120).y() < 0.999F && out(x, 120).y() > out(218, 120).y() + 0.001F ? 1 : 0;
    }
    return count;
  };
  EXPECT_GE(between(0.0F), 1);
  EXPECT_LE(between(0.0F), 2);
  EXPECT_NEAR(between(10.0F), 10, 2);
}

TEST(ShadeToon, NeutralOptionsKeepTheColours) {
  const auto normals = lively(60, 60);
  const ColorImage albedo(60, 60, Vec3f(0.123F, 0.45F, 0.678F));
  for (const bool by_bands : {false, true}) {
    ToonOptions options;
    if (by_bands) options.bands = 1;
    if (!by_bands) options.dark = 1.0F;
    ColorImage out(60, 60, albedo(0, 0));
    shade_toon(normals, albedo, out, out.rect(), options);
    EXPECT_TRUE(same_in(out, albedo, out.rect())) << by_bands;
  }
}

TEST(ShadeToon, TheLightComesFromTheUpperLeft) {
  const auto normals = ball(101, 45.0);
  ColorImage out(101, 101, Vec3f::Zero());
  shade_toon(normals, {}, out, out.rect());
  EXPECT_GT(out(50 - 20, 50 - 20).sum(), out(50 + 30, 50 + 25).sum());
  EXPECT_EQ(out(0, 0), Vec3f(Vec3f::Zero()));  // nothing there
}

TEST(ShadeToon, RegionsThreadsEdgesAndGaps) {
  const auto draw = [](ImageView<Vec3f> normals, ColorSpan target, Rect region) {
    return shade_toon(normals, {}, target, region);
  };
  const Vec3f background(0.1F, 0.2F, 7.0F);
  expect_a_style(background, std::optional(background), draw);
}

TEST(ShadeToon, RejectsOptionsOutOfRange) {
  const Image<Vec3f> normals(1, 1, Vec3f(0.0F, 0.0F, 1.0F));
  ColorImage out(1, 1);
  ToonOptions options;
  options.bands = 0;
  EXPECT_THROW(shade_toon(normals, {}, out, out.rect(), options), InvalidInput);
  for (float ToonOptions::*member : {&ToonOptions::dark, &ToonOptions::wrap, &ToonOptions::tint,
                                     &ToonOptions::sigma, &ToonOptions::softness}) {
    options = {};
    options.*member = std::numeric_limits<float>::quiet_NaN();
    EXPECT_THROW(shade_toon(normals, {}, out, out.rect(), options), InvalidInput);
  }
  options = {};
  options.azimuth = std::numeric_limits<float>::infinity();
  EXPECT_THROW(shade_toon(normals, {}, out, out.rect(), options), InvalidInput);
}

}  // namespace
}  // namespace normalshop::test
