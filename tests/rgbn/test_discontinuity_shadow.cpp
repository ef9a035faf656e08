#include <cmath>
#include <limits>

#include "style_checks.h"
#include <gtest/gtest.h>

#include "normalshop/core/error.h"
#include "normalshop/rgbn/discontinuity_shadow.h"

namespace normalshop::test {
namespace {

/// A ball of radius 30 in front of a wall that faces the viewer.
Image<Vec3f> ball_before_wall() {
  return picture_of(161, 161, [](double x, double y) {
    const double z2 = 900.0 - x * x - y * y;
    if (z2 <= 0.0) return Vec3f(0.0F, 0.0F, 1.0F);
    return Vec3f((Vec3d(x, y, std::sqrt(z2)) / 30.0).cast<float>());
  });
}

MaskImage shadow_of(const Image<Vec3f>& normals, const DiscontinuityShadowOptions& options) {
  MaskImage out(normals.width(), normals.height(), 9.0F);
  discontinuity_shadow(normals, out, out.rect(), options);
  return out;
}

TEST(DiscontinuityShadow, FallsOnTheSideAwayFromTheLightOnly) {
  DiscontinuityShadowOptions options;
  options.azimuth = 90.0F;  // from above
  options.length = 20.0F;
  options.softness = 0.0F;
  const MaskImage lit = shadow_of(ball_before_wall(), options);
  EXPECT_NEAR(lit(80, 80 + 31), 1.0F - options.strength, 0.02F);  // just below the ball
  EXPECT_GT(lit(80, 80 + 41), lit(80, 80 + 33));                  // fading
  EXPECT_EQ(lit(80, 80 + 52), 1.0F);                              // out of reach
  EXPECT_EQ(lit(80, 80 - 32), 1.0F);                              // towards the light
  EXPECT_EQ(lit(80, 80), 1.0F);                                   // the ball itself
  EXPECT_EQ(lit(80 + 40, 80), 1.0F);                              // beside it
}

TEST(DiscontinuityShadow, AnOutlineCastsOneOnThePaper) {
  DiscontinuityShadowOptions options;
  options.azimuth = 180.0F;  // from the left
  options.softness = 0.0F;
  const MaskImage lit = shadow_of(ball(161, 30.0), options);
  EXPECT_NEAR(lit(80 + 31, 80), 1.0F - options.strength, 0.02F);
  EXPECT_EQ(lit(80 - 31, 80), 1.0F);
  EXPECT_EQ(lit(80 + 29, 80), 1.0F);
}

TEST(DiscontinuityShadow, ACreaseIsNoStepInDepth) {
  // A roof whose ridge runs up: its far side is dark in any light, but nothing stands before it.
  const auto roof =
      picture_of(80, 40, [](double x, double) { return tilted(x < 0.0 ? 0.25 : -0.25, 0.0); });
  DiscontinuityShadowOptions options;
  options.azimuth = 180.0F;
  const MaskImage lit = shadow_of(roof, options);
  EXPECT_TRUE(same_in(lit, MaskImage(80, 40, 1.0F), lit.rect()));
}

TEST(DiscontinuityShadow, GrainNeitherCastsNorBreaksShadows) {
  const auto clean = ball_before_wall();
  auto grainy = clean;
  for (int y = 3; y < 161; y += 9) {
    for (int x = 2; x < 161; x += 7) {
      if (std::hypot(x - 80, y - 80) > 40.0) grainy(x, y) = tilted(0.0, -1.2);  // falls to below
    }
  }
  DiscontinuityShadowOptions options;
  options.azimuth = 90.0F;
  options.softness = 0.0F;
  EXPECT_TRUE(same_in(shadow_of(grainy, options), shadow_of(clean, options), clean.rect()));
  options.shortest = 0.0F;
  EXPECT_FALSE(same_in(shadow_of(grainy, options), shadow_of(clean, options), clean.rect()));
}

TEST(DiscontinuityShadow, NeutralOptionsLightEverything) {
  const MaskImage all(161, 161, 1.0F);
  DiscontinuityShadowOptions options;
  options.strength = 0.0F;
  EXPECT_TRUE(same_in(shadow_of(ball_before_wall(), options), all, all.rect()));
  options = {};
  options.length = 0.0F;
  EXPECT_TRUE(same_in(shadow_of(ball_before_wall(), options), all, all.rect()));
}

TEST(DiscontinuityShadow, RegionsThreadsEdgesAndGaps) {
  const auto draw = [](ImageView<Vec3f> normals, MaskSpan target, Rect region) {
    return discontinuity_shadow(normals, target, region);
  };
  expect_a_style(9.0F, std::optional<float>(), draw);
}

TEST(DiscontinuityShadow, RejectsOptionsOutOfRange) {
  const Image<Vec3f> normals(1, 1, Vec3f(0.0F, 0.0F, 1.0F));
  MaskImage out(1, 1);
  using Options = DiscontinuityShadowOptions;
  for (float Options::*member : {&Options::azimuth, &Options::length, &Options::strength,
                                 &Options::jump, &Options::shortest, &Options::softness}) {
    Options options;
    options.*member = std::numeric_limits<float>::quiet_NaN();
    EXPECT_THROW(discontinuity_shadow(normals, out, out.rect(), options), InvalidInput);
  }
}

}  // namespace
}  // namespace normalshop::test
