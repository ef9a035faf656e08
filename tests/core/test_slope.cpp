#include <cmath>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "normalshop/core/random.h"
#include "normalshop/core/slope.h"

namespace normalshop {
namespace {

Vec3f random_direction(Random& random) {
  const float z = random.uniform(-1.0F, 1.0F);
  const float turn = random.uniform(0.0F, 6.2831853F);
  const float r = std::sqrt(1.0F - z * z);
  return Vec3f(r * std::cos(turn), r * std::sin(turn), z).normalized();
}

TEST(Slope, OfAPlane) {
  // z = 0.5 x - 2 y has the normal (-0.5, 2, 1) / |.|.
  const Vec3f n = Vec3f(-0.5F, 2.0F, 1.0F).normalized();
  EXPECT_LT((slope_from_normal(n) - Vec2f(0.5F, -2.0F)).norm(), 1e-6F);
  EXPECT_LT((slope_from_normal(3.0F * n) - Vec2f(0.5F, -2.0F)).norm(), 1e-6F);
  EXPECT_LT(angle_degrees(normal_from_slope({0.5F, -2.0F}), n), 1e-5);
}

TEST(Slope, AndNormalAreInverse) {
  Random random(1);
  for (int i = 0; i < 10000; ++i) {
    const Vec3f n = random_direction(random);
    if (n.z() < 0.03F) continue;
    EXPECT_LT(angle_degrees(normal_from_slope(slope_from_normal(n)), n), 1e-5);
  }
}

TEST(Slope, SaturatesAtTheHorizonAndKeepsTheAzimuth) {
  for (const Vec3f& n : {Vec3f(0.6F, 0.8F, 0.0F), Vec3f(0.6F, 0.8F, -1e-3F)}) {
    const Vec2f slope = slope_from_normal(n);
    EXPECT_NEAR(slope.norm(), max_slope, 1e-2F);
    EXPECT_LT((slope.normalized() + Vec2f(0.6F, 0.8F)).norm(), 1e-5F);
  }
}

TEST(Slope, OfNoDirectionIsZero) { EXPECT_EQ(slope_from_normal(Vec3f::Zero()), Vec2f(0.0F, 0.0F)); }

TEST(AngleDegrees, IsExactForSmallAngles) {
  EXPECT_NEAR(angle_degrees({0.0F, 0.0F, 1.0F}, {1e-6F, 0.0F, 1.0F}), 1e-6 * 57.29577951, 1e-11);
  EXPECT_NEAR(angle_degrees({0.0F, 0.0F, 1.0F}, {0.0F, 2.0F, 0.0F}), 90.0, 1e-12);
  EXPECT_NEAR(angle_degrees({0.0F, 0.0F, 1.0F}, {0.0F, 0.0F, -1.0F}), 180.0, 1e-12);
}

}  // namespace
}  // namespace normalshop
