#include <algorithm>
#include <limits>

#include <gtest/gtest.h>

#include "normalshop/core/curve.h"
#include "normalshop/core/error.h"

namespace normalshop {
namespace {

const Curve bump({{-1.0F, 0.0F}, {-0.4F, 0.9F}, {0.1F, 1.0F}, {1.0F, 0.0F}});

TEST(Curve, GoesThroughItsPoints) {
  for (const Vec2f& p : bump.points()) EXPECT_NEAR(bump.value(p.x()), p.y(), 1e-6F);
}

TEST(Curve, IsConstantOutside) {
  EXPECT_EQ(bump.value(-7.0F), 0.0F);
  EXPECT_EQ(bump.value(7.0F), 0.0F);
  EXPECT_EQ(bump.derivative(-7.0F), 0.0F);
  EXPECT_EQ(bump.derivative(7.0F), 0.0F);
}

TEST(Curve, NeverOvershootsItsPoints) {
  const Curve step({{0.0F, 0.0F}, {1.0F, 0.0F}, {1.01F, 1.0F}, {2.0F, 1.0F}});
  float last = 0.0F;
  for (int i = 0; i <= 4000; ++i) {
    const float y = step.value(static_cast<float>(i) / 2000.0F);
    EXPECT_GE(y, last - 1e-6F);
    EXPECT_LE(y, 1.0F + 1e-6F);
    last = std::max(last, y);
  }
}

TEST(Curve, DerivativeIsThatOfTheValue) {
  constexpr float h = 1e-3F;
  for (int i = 1; i < 200; ++i) {
    const float x = -1.0F + 0.01F * static_cast<float>(i) + 0.0013F;
    const float difference = (bump.value(x + h) - bump.value(x - h)) / (2.0F * h);
    EXPECT_NEAR(bump.derivative(x), difference, 0.02F) << x;
  }
}

TEST(Curve, DerivativeIsContinuousAtThePoints) {
  for (std::size_t i = 1; i + 1 < bump.points().size(); ++i) {
    const float x = bump.points()[i].x();
    EXPECT_NEAR(bump.derivative(x - 1e-5F), bump.derivative(x + 1e-5F), 1e-3F);
  }
}

TEST(Curve, OfOnePointIsAConstant) {
  const Curve constant({{3.0F, 2.0F}});
  EXPECT_EQ(constant.value(-1.0F), 2.0F);
  EXPECT_EQ(constant.value(5.0F), 2.0F);
  EXPECT_EQ(constant.derivative(3.0F), 0.0F);
}

TEST(Curve, EmptyIsZero) {
  EXPECT_TRUE(Curve().empty());
  EXPECT_EQ(Curve().value(1.0F), 0.0F);
  EXPECT_EQ(Curve().derivative(1.0F), 0.0F);
}

TEST(Curve, RefusesUnusablePoints) {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(Curve(std::vector<Vec2f>{}), InvalidInput);
  EXPECT_THROW(Curve({{0.0F, 0.0F}, {0.0F, 1.0F}}), InvalidInput);
  EXPECT_THROW(Curve({{1.0F, 0.0F}, {0.0F, 1.0F}}), InvalidInput);
  EXPECT_THROW(Curve({{0.0F, nan}}), InvalidInput);
}

TEST(Curve, TakesNanAsBeforeItsFirstPoint) {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(bump.value(nan), 0.0F);
  EXPECT_EQ(bump.derivative(nan), 0.0F);
}

}  // namespace
}  // namespace normalshop
