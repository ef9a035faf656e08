#include <cmath>
#include <vector>

#include "combine_fixtures.h"
#include <gtest/gtest.h>

#include "normalshop/core/slope.h"

namespace normalshop::test {
namespace {

TEST(CombineReoriented, IsTheShortestRotationFromTheViewToTheBase) {
  const SlopeImage base = random_slopes(60, 60, 1);
  const SlopeImage details = random_slopes(60, 60, 2);
  double worst = 0.0;
  int above = 0;
  for (int y = 0; y < 60; ++y) {
    for (int x = 0; x < 60; ++x) {
      const Vec3d truth =
          rotated_by_hand(normal(details(x, y)), Vec3d::UnitZ(), normal(base(x, y)));
      if (truth.z() < 0.021) continue;
      ++above;
      const Vec2f out = rnm(base(x, y), details(x, y));
      worst = std::max(worst, degrees_between(normal(out), truth));
    }
  }
  EXPECT_GT(above, 1200);
  EXPECT_LT(worst, 1e-5);
}

TEST(CombineReoriented, HasNeutralSides) {
  for (const double tilt : {0.5, 20.0, 60.0, 88.0}) {
    const Vec2f t = tilted_slope(tilt, 77.0);
    EXPECT_EQ(rnm(t, Vec2f::Zero()), t);
    EXPECT_LT(degrees_between(normal(rnm(Vec2f::Zero(), t)), normal(t)), 1e-5);
  }
}

TEST(CombineReoriented, IsTheRotationOfTheBaseByItself) {
  const SlopeImage base = random_slopes(60, 60, 4);
  const SlopeImage details = random_slopes(60, 60, 5);
  int above = 0;
  for (int y = 0; y < 60; ++y) {
    for (int x = 0; x < 60; ++x) {
      const Vec3d turned = normal(combined(base(x, y), details(x, y), CombineModel::Rotation));
      if (turned.z() < 0.0201) continue;  // each stops at the horizon in its own way
      ++above;
      EXPECT_LT(degrees_between(turned, normal(rnm(base(x, y), details(x, y)))), 1e-5);
    }
  }
  EXPECT_GT(above, 1200);
}

TEST(CombineReoriented, StopsAtTheHorizonHoweverFarItWouldGo) {
  for (const double tilt : {10.0, 30.0, 88.0}) {
    const Vec3d n = normal(rnm(tilted_slope(85.0, 30.0), tilted_slope(tilt, 30.0)));
    EXPECT_NEAR(n.z(), static_cast<double>(min_cosine), 1e-6);
    EXPECT_NEAR(std::atan2(n.y(), n.x()) / degree, 30.0, 1e-4);
  }
}

/// The rotation model with angles, and saturation by bisection along the arc.
Vec3d rotation_by_hand(const Vec3d& a, const Vec3d& n, const Vec3d& u) {
  constexpr double least = 0.02;
  Vec3d b = rotated_by_hand(u, Vec3d::UnitZ(), n);
  if (b.z() < least) {
    const Vec3d across = (b - b.dot(n) * n).normalized();
    double low = 0.0;
    double high = std::atan2(b.dot(across), b.dot(n));
    for (int i = 0; i < 100; ++i) {
      const double middle = 0.5 * (low + high);
      const double z = std::cos(middle) * n.z() + std::sin(middle) * across.z();
      (z >= least ? low : high) = middle;
    }
    b = std::cos(low) * n + std::sin(low) * across;
  }
  return rotated_by_hand(a, n, b);
}

TEST(CombineRotation, IsTheExplicitRotation) {
  const SlopeImage smooth = random_slopes(60, 60, 1);
  const SlopeImage details = random_slopes(60, 60, 2);
  const SlopeImage fine = random_slopes(60, 60, 3, 1.0F);
  SlopeImage base(60, 60);
  for (int y = 0; y < 60; ++y) {
    for (int x = 0; x < 60; ++x) base(x, y) = smooth(x, y) + fine(x, y);
  }
  SlopeImage out(60, 60);
  combine_rotation(base, smooth, details, {}, 1.0F, out, out.rect());
  double worst = 0.0;
  int saturated = 0;
  for (int y = 0; y < 60; ++y) {
    for (int x = 0; x < 60; ++x) {
      const Vec3d n = normal(smooth(x, y));
      const Vec3d u = normal(details(x, y));
      const Vec3d truth = rotation_by_hand(normal(base(x, y)), n, u);
      saturated += rotated_by_hand(u, Vec3d::UnitZ(), n).z() < 0.02 ? 1 : 0;
      if (truth.z() < 0.0199) {
        EXPECT_NEAR(normal(out(x, y)).z(), static_cast<double>(min_cosine), 1e-5);
      }
      if (truth.z() < 0.0201) continue;
      worst = std::max(worst, degrees_between(normal(out(x, y)), truth));
    }
  }
  EXPECT_GT(saturated, 200);
  EXPECT_LT(worst, 1e-5);
}

TEST(CombineRotation, StopsAtTheHorizonOnTheGreatArc) {
  const Vec2f base = tilted_slope(75.0, 0.0);
  double before = -1.0;
  for (const double tilt : {5.0, 13.0, 13.9, 20.0, 50.0, 85.0}) {
    // Straight on over the horizon, and aslant.
    const Vec3d straight = normal(combined(base, tilted_slope(tilt, 0.0), CombineModel::Rotation));
    EXPECT_NEAR(std::acos(straight.z()) / degree, std::min(75.0 + tilt, 88.854), 1e-3);
    EXPECT_NEAR(straight.y(), 0.0, 1e-7);
    const Vec3d aslant = normal(combined(base, tilted_slope(tilt, 40.0), CombineModel::Rotation));
    EXPECT_GE(aslant.z(), 0.02 - 1e-8);
    // On the great arc: perpendicular to its axis.
    const Vec3d goal =
        rotated_by_hand(normal(tilted_slope(tilt, 40.0)), Vec3d::UnitZ(), normal(base));
    EXPECT_NEAR(aslant.dot(normal(base).cross(goal).normalized()), 0.0, 3e-7);
    const double turned = degrees_between(aslant, normal(base));
    EXPECT_GE(turned, before);
    before = turned - 1e-5;
  }
}

TEST(CombineRotation, KeepsTheFineFrequenciesOfTheBase) {
  // A ripple on tilted surface, turned by a constant direction, keeps its angles.
  const Vec2f n = tilted_slope(40.0, 30.0);
  const std::vector<Vec3d> ripple{
      rotated_by_hand(normal(tilted_slope(8.0, 0.0)), Vec3d::UnitZ(), normal(n)),
      rotated_by_hand(normal(tilted_slope(8.0, 180.0)), Vec3d::UnitZ(), normal(n))};
  std::vector<Vec3d> out;
  for (const Vec3d& a : ripple) {
    const SlopeImage base(1, 1, Vec2d(-a.x() / a.z(), -a.y() / a.z()).cast<float>());
    SlopeImage target(1, 1);
    combine_rotation(base, SlopeImage(1, 1, n), SlopeImage(1, 1, tilted_slope(20.0, 100.0)), {},
                     1.0F, target, target.rect());
    out.push_back(normal(target(0, 0)));
  }
  EXPECT_NEAR(degrees_between(out[0], out[1]), 16.0, 1e-4);
  EXPECT_NEAR(degrees_between(out[0], ripple[0]), 20.0, 0.5);
}

}  // namespace
}  // namespace normalshop::test
