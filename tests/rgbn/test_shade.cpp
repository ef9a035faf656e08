#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "normalshop/rgbn/heatmap.h"
#include "normalshop/rgbn/shade.h"

namespace normalshop::test {
namespace {

TEST(Shade, LightComesFromTheUpperLeft) {
  const Vec3f lit = Vec3f(-0.5F, 0.5F, 0.7F).normalized();
  const Vec3f unlit = Vec3f(0.3F, -0.8F, 0.5F).normalized();
  ColorImage normals(3, 1, Vec3f::Zero());
  normals(0, 0) = lit;
  normals(1, 0) = unlit;
  ColorImage out(3, 1, Vec3f::Constant(0.25F));
  shade(normals, {}, {}, {}, out);
  EXPECT_GT(out(0, 0).minCoeff(), 2.0F * out(1, 0).maxCoeff());
  EXPECT_EQ(out(2, 0), Vec3f(Vec3f::Constant(0.25F)));  // background
  EXPECT_GE(out.view()(1, 0).minCoeff(), 0.0F);
  EXPECT_LE(out.view()(0, 0).maxCoeff(), 1.0F);
}

TEST(Shade, OcclusionAndShadowDarken) {
  const ColorImage normals(1, 1, Vec3f(0.0F, 0.0F, 1.0F));
  const MaskImage none(1, 1, 0.0F);
  ColorImage open(1, 1);
  ColorImage closed(1, 1);
  ColorImage shadow(1, 1);
  shade(normals, {}, {}, {}, open);
  shade(normals, {}, none, {}, closed);
  shade(normals, {}, {}, none, shadow);
  EXPECT_LT(closed(0, 0).sum(), open(0, 0).sum());
  EXPECT_LT(shadow(0, 0).sum(), 0.6F * open(0, 0).sum());
}

TEST(Shade, PlanesAreOpenAndPitsAreNot) {
  MaskImage height(60, 60, 0.0F);
  MaskImage open(60, 60);
  ambient_occlusion(height, 20.0F, open);
  EXPECT_EQ(open(30, 30), 1.0F);
  for (int y = 25; y < 36; ++y) {
    for (int x = 25; x < 36; ++x) height(x, y) = -30.0F;
  }
  height(0, 0) = -std::numeric_limits<float>::infinity();
  ambient_occlusion(height, 20.0F, open);
  EXPECT_LT(open(30, 30), 0.6F);
  EXPECT_EQ(open(0, 0), 1.0F);
}

TEST(Shade, AWallCastsAShadowAwayFromTheLight) {
  MaskImage height(80, 20, 0.0F);
  for (int y = 0; y < 20; ++y) height(40, y) = 20.0F;
  MaskImage lit(80, 20);
  cast_shadow(height, {-1.0F, 0.0F, 1.0F}, 60.0F, lit);
  EXPECT_EQ(lit(20, 10), 1.0F);
  EXPECT_LT(lit(48, 10), 0.1F);
  EXPECT_EQ(lit(75, 10), 1.0F);
}

TEST(Shade, NormalColorsAndBackground) {
  const ColorImage normals(4, 4, Vec3f(0.0F, 0.0F, 1.0F));
  ColorImage out(4, 4, Vec3f::Zero());
  normal_colors(normals, out);
  EXPECT_EQ(out(1, 1), Vec3f(0.5F, 0.5F, 1.0F));
  studio_background(out);
  EXPECT_LT(out(1, 1).maxCoeff(), 0.2F);
}

TEST(Heatmap, GrowsLighterAndMarksWhatIsNoNumber) {
  const auto lightness = [](float t) {
    const Vec3f linear = heat_color(t).array().pow(2.2F);
    return 116.0F * std::cbrt(linear.dot(Vec3f(0.2126F, 0.7152F, 0.0722F))) - 16.0F;
  };
  for (float t = 0.05F; t <= 1.0F; t += 0.05F) {
    const float step = lightness(t) - lightness(t - 0.05F);
    EXPECT_GT(step, 1.5F) << t;
    EXPECT_LT(step, 9.0F) << t;
  }
  EXPECT_EQ(heat_color(std::numeric_limits<float>::quiet_NaN()), Vec3f(Vec3f::Constant(0.35F)));
  MaskImage values(2, 1, 5.0F);
  ColorImage out(2, 1);
  heatmap(values, 5.0F, out);
  EXPECT_EQ(out(0, 0), heat_color(1.0F));
}

}  // namespace
}  // namespace normalshop::test
