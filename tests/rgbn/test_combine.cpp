#include <gtest/gtest.h>

#include "normalshop/rgbn/combine.h"

namespace normalshop {
namespace {

TEST(Combine, AddsDetailsByStrengthAndMask) {
  const SlopeImage base(7, 5, Vec2f(0.5F, -1.0F));
  const SlopeImage details(7, 5, Vec2f(0.25F, 4.0F));
  MaskImage mask(7, 5, 0.5F);
  mask(3, 2) = 0.0F;
  SlopeImage target(7, 5, Vec2f::Constant(9.0F));
  EXPECT_EQ(combine_linear(base, details, mask, 2.0F, target, {1, 1, 99, 4}), (Rect{1, 1, 7, 4}));
  EXPECT_EQ(target(1, 1), Vec2f(0.75F, 3.0F));
  EXPECT_EQ(target(3, 2), base(3, 2));
  EXPECT_EQ(target(0, 0), Vec2f(9.0F, 9.0F));
}

TEST(Combine, WorksInPlaceWithoutMask) {
  SlopeImage target(3, 3, Vec2f(1.0F, 1.0F));
  const SlopeImage details(3, 3, Vec2f(-1.0F, 1.0F));
  combine_linear(target, details, {}, 1.0F, target, target.rect());
  EXPECT_EQ(target(2, 2), Vec2f(0.0F, 2.0F));
  EXPECT_TRUE(combine_linear(target, details, {}, 1.0F, target, {5, 5, 9, 9}).empty());
}

}  // namespace
}  // namespace normalshop
