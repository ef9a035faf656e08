#include <cmath>
#include <limits>

#include "style_checks.h"
#include <gtest/gtest.h>

#include "normalshop/core/color_map.h"
#include "normalshop/core/error.h"
#include "normalshop/rgbn/shade_curvature.h"

namespace normalshop::test {
namespace {

TEST(ShadeCurvature, SumsTheScalesOfASphere) {
  const auto normals = ball(241, 100.0);
  CurvatureShadeOptions options;
  options.scale = 2.0F;
  options.levels = 4;
  options.gain = 10.0F;
  options.balance = 0.5F;
  ColorImage out(241, 241, Vec3f::Zero());
  shade_curvature(normals, {}, out, out.rect(), options);
  double sum = 0.0;
  double total = 0.0;
  for (int i = 0; i < 4; ++i) {
    const double r = 2.0 * std::pow(2.0, 0.5 * i);
    sum += std::pow(r / 2.0, 0.5) * std::tanh(10.0 * r / 100.0);
    total += std::pow(r / 2.0, 0.5);
  }
  EXPECT_NEAR(tone(out(120, 120)), 0.5 + 0.5 * sum / total, 3e-3);
  EXPECT_NEAR(tone(out(150, 100)), 0.5 + 0.5 * sum / total, 3e-3);
}

TEST(ShadeCurvature, RidgesAreLightAndFurrowsDark) {
  const auto normals = picture_of(120, 40, [](double x, double) {
    return tilted(-1.5 * std::sin(x * 3.14159265 / 30.0), 0.0);  // crests at 0, furrows at 30
  });
  ColorImage out(120, 40);
  shade_curvature(normals, {}, out, out.rect());
  EXPECT_GT(tone(out(60, 20)), 0.55F);
  EXPECT_LT(tone(out(90, 20)), 0.45F);
}

TEST(ShadeCurvature, IsMiddleGreyWithoutGainAndOnPlanes) {
  ColorImage out(60, 60);
  CurvatureShadeOptions options;
  const Image<Vec3f> plane(60, 60, tilted(0.5, 0.25));
  shade_curvature(plane, {}, out, out.rect(), options);
  EXPECT_NEAR(tone(out(0, 0)), 0.5F, 2e-3F);
  EXPECT_NEAR(tone(out(30, 30)), 0.5F, 2e-3F);
  const ColorImage even(60, 60, out(30, 30));
  options.gain = 0.0F;
  ColorImage flat(60, 60, out(30, 30));
  shade_curvature(lively(60, 60), {}, flat, flat.rect(), options);
  EXPECT_TRUE(same_in(flat, even, flat.rect()));
}

TEST(ShadeCurvature, RegionsThreadsEdgesAndGaps) {
  const auto draw = [](ImageView<Vec3f> normals, ColorSpan target, Rect region) {
    CurvatureShadeOptions options;
    options.levels = 4;
    return shade_curvature(normals, {}, target, region, options);
  };
  const Vec3f background(0.1F, 0.2F, 7.0F);
  expect_a_style(background, std::optional(background), draw);
}

TEST(ShadeCurvature, RejectsOptionsOutOfRange) {
  const Image<Vec3f> normals(1, 1, Vec3f(0.0F, 0.0F, 1.0F));
  ColorImage out(1, 1);
  CurvatureShadeOptions options;
  options.levels = 0;
  EXPECT_THROW(shade_curvature(normals, {}, out, out.rect(), options), InvalidInput);
  for (float CurvatureShadeOptions::*member :
       {&CurvatureShadeOptions::scale, &CurvatureShadeOptions::gain,
        &CurvatureShadeOptions::balance, &CurvatureShadeOptions::guard}) {
    options = {};
    options.*member = std::numeric_limits<float>::quiet_NaN();
    EXPECT_THROW(shade_curvature(normals, {}, out, out.rect(), options), InvalidInput);
  }
}

}  // namespace
}  // namespace normalshop::test
