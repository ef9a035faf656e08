#include <cmath>
#include <numbers>

#include "support/slope_fields.h"
#include <gtest/gtest.h>

#include "normalshop/core/error.h"
#include "normalshop/core/parallel.h"
#include "normalshop/core/random.h"
#include "normalshop/core/sample.h"
#include "normalshop/rgbn/mask.h"

namespace normalshop::test {
namespace {

using std::numbers::pi;

MaskImage blobs(int width, int height) {
  MaskImage mask(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const auto fx = static_cast<float>(x);
      const auto fy = static_cast<float>(y);
      mask(x, y) = 0.5F + 0.5F * std::sin(0.23F * fx) * std::cos(0.17F * fy + 0.05F * fx);
    }
  }
  return mask;
}

MaskImage disc_of_radius(int size, double radius) {
  MaskImage mask(size, size);
  const double centre = 0.5 * (size - 1);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      mask(x, y) = std::hypot(x - centre, y - centre) <= radius ? 1.0F : 0.0F;
    }
  }
  return mask;
}

TEST(Mask, CombinesAsSetsDo) {
  const float values[4][2] = {{0.0F, 0.0F}, {0.0F, 1.0F}, {1.0F, 0.0F}, {1.0F, 1.0F}};
  const auto of = [](float m, float other, MaskOperation operation) {
    MaskImage a(1, 1, m);
    combine_masks(a, MaskImage(1, 1, other), a, a.rect(), operation);
    return a(0, 0);
  };
  for (const auto& [m, other] : values) {
    EXPECT_EQ(of(m, other, MaskOperation::Add), std::max(m, other));
    EXPECT_EQ(of(m, other, MaskOperation::Subtract), m == 1.0F && other == 0.0F ? 1.0F : 0.0F);
    EXPECT_EQ(of(m, other, MaskOperation::Intersect), m * other);
  }
  EXPECT_EQ(of(0.3F, 0.6F, MaskOperation::Add), 0.6F);
  EXPECT_EQ(of(0.7F, 0.6F, MaskOperation::Subtract), 1.0F - 0.6F);
  EXPECT_EQ(of(0.7F, 0.6F, MaskOperation::Intersect), 0.6F);
}

TEST(Mask, AnEmptyMaskIsOneEverywhere) {
  MaskImage out(3, 2);
  combine_masks({}, MaskImage(3, 2, 0.25F), out, out.rect(), MaskOperation::Subtract);
  EXPECT_EQ(out(2, 1), 0.75F);
  invert_mask({}, out, out.rect());
  EXPECT_EQ(area(out), 0.0);
  feather_mask({}, out, out.rect(), {.width = 4.0F});
  EXPECT_EQ(area(out), 6.0);
}

TEST(Mask, InvertingTwiceGivesTheMask) {
  const MaskImage mask = disc_of_radius(20, 7.0);
  MaskImage out(20, 20);
  invert_mask(mask, out, out.rect());
  EXPECT_EQ(area(out) + area(mask), 400.0);
  invert_mask(out, out, out.rect());
  EXPECT_TRUE(same(mask, out));
}

TEST(Mask, FeatherFallsOffWithTheDistanceFromAStraightBorder) {
  MaskImage half_plane(60, 9, 0.0F);
  for (int y = 0; y < 9; ++y) {
    for (int x = 0; x < 30; ++x) half_plane(x, y) = 1.0F;
  }
  for (const float width : {1.0F, 6.0F, 13.0F, 40.0F}) {
    MaskImage out(60, 9);
    feather_mask(half_plane, out, out.rect(), {.width = width});
    for (int x = 0; x < 60; ++x) {
      const float inside = 29.5F - static_cast<float>(x);
      EXPECT_NEAR(out(x, 4), smoothstep(-0.5F * width, 0.5F * width, inside), 1e-6F);
      EXPECT_NEAR(out(x, 4) + out(59 - x, 4), 1.0F, 1e-6F);
    }
    EXPECT_NEAR(0.5F * (out(29, 4) + out(30, 4)), 0.5F, 1e-6F);  // at the border
  }
}

TEST(Mask, FeatherOfADiscIsRound) {
  const MaskImage mask = disc_of_radius(121, 40.0);
  MaskImage out(121, 121);
  feather_mask(mask, out, out.rect(), {.width = 20.0F});
  for (int y = 0; y < 121; ++y) {
    for (int x = 0; x < 121; ++x) {
      const auto inside = static_cast<float>(40.0 - std::hypot(x - 60.0, y - 60.0));
      EXPECT_NEAR(out(x, y), smoothstep(-10.0F, 10.0F, inside), 0.06F);  // 0.075 a pixel
    }
  }
}

TEST(Mask, FeatherOfTheInverseIsTheInverse) {
  const MaskImage mask = disc_of_radius(60, 17.3);
  MaskImage inverse(60, 60);
  invert_mask(mask, inverse, mask.rect());
  MaskImage a(60, 60);
  MaskImage b(60, 60);
  feather_mask(mask, a, mask.rect(), {.width = 9.0F});
  feather_mask(inverse, b, mask.rect(), {.width = 9.0F});
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a.data()[i] + b.data()[i], 1.0F, 1e-6F);
}

TEST(Mask, GrowMovesTheBorder) {
  const MaskImage mask = disc_of_radius(161, 40.0);
  for (const float distance : {-25.0F, -3.5F, -1.0F, 1.0F, 4.3F, 30.0F}) {
    MaskImage out(161, 161);
    grow_mask(mask, out, out.rect(), {.distance = distance});
    const double radius = 40.0 + static_cast<double>(distance);
    EXPECT_NEAR(std::sqrt(area(out) / pi), radius, 0.4)
        << distance;  // borders aslant are steps of pixels
    for (int x = 0; x < 161; ++x) {
      const double inside = radius - std::abs(x - 80.0);
      if (inside > 1.5) {
        EXPECT_EQ(out(x, 80), 1.0F) << distance << " " << x;
      }
      if (inside < -1.5) {
        EXPECT_EQ(out(x, 80), 0.0F) << distance << " " << x;
      }
    }
  }
}

TEST(Mask, GrowIsExactAtStraightBorders) {
  MaskImage half_plane(30, 1, 0.0F);
  for (int x = 0; x < 10; ++x) half_plane(x, 0) = 1.0F;
  for (const float distance : {-4.0F, -2.25F, -0.5F, 0.75F, 3.0F, 7.4F}) {
    MaskImage out(30, 1);
    grow_mask(half_plane, out, out.rect(), {.distance = distance});
    EXPECT_NEAR(area(out), 10.0 + static_cast<double>(distance), 1e-5) << distance;
  }
}

TEST(Mask, GrowKeepsTheOrderOfSoftMasks) {
  const MaskImage mask = blobs(80, 50);
  MaskImage larger(80, 50);
  MaskImage smaller(80, 50);
  grow_mask(mask, larger, mask.rect(), {.distance = 2.0F});
  grow_mask(mask, smaller, mask.rect(), {.distance = -2.0F});
  for (std::size_t i = 0; i < mask.size(); ++i) {
    EXPECT_LE(mask.data()[i], larger.data()[i]);
    EXPECT_GE(mask.data()[i], smaller.data()[i]);
  }
  EXPECT_GT(area(larger), area(mask) + 100.0);
  EXPECT_LT(area(smaller), area(mask) - 100.0);
}

TEST(Mask, NeutralValuesAndBadOnes) {
  const MaskImage mask = blobs(31, 17);
  MaskImage out(31, 17);
  EXPECT_EQ(grow_mask(mask, out, {-3, 0, 90, 90}, {.distance = 0.0F}), mask.rect());
  EXPECT_TRUE(same(mask, out));
  out.fill(0.0F);
  feather_mask(mask, out, out.rect(), {.width = 0.0F});
  EXPECT_TRUE(same(mask, out));
  EXPECT_THROW(grow_mask(mask, out, out.rect(), {.distance = nan}), InvalidInput);
  EXPECT_THROW(feather_mask(mask, out, out.rect(), {.width = nan}), InvalidInput);
  EXPECT_THROW(feather_mask(mask, out, out.rect(), {.width = -1.0F}), InvalidInput);
  MaskImage none;
  EXPECT_TRUE(feather_mask(none, none, {0, 0, 4, 4}, {.width = 3.0F}).empty());
  MaskImage one(1, 1, 1.0F);
  MaskImage pixel(1, 1);
  feather_mask(one, pixel, pixel.rect(), {.width = 30.0F});
  EXPECT_EQ(pixel(0, 0), 1.0F);  // no border anywhere
}

TEST(Mask, ARegionAndOneThreadGiveThePixelsOfTheWhole) {
  const MaskImage mask = blobs(150, 110);
  const Rect region = {31, 22, 97, 61};
  const GrowMaskOptions growing{.distance = 3.7F};
  const FeatherMaskOptions feathering{.width = 17.0F};
  MaskImage grown(150, 110);
  MaskImage feathered(150, 110);
  grow_mask(mask, grown, mask.rect(), growing);
  feather_mask(mask, feathered, mask.rect(), feathering);
  const ThreadLimit limit(1);
  MaskImage part(150, 110, 9.0F);
  const auto expect_part = [&](const MaskImage& whole) {
    for (int y = 0; y < 110; ++y) {
      for (int x = 0; x < 150; ++x) {
        ASSERT_EQ(part(x, y), region.contains(x, y) ? whole(x, y) : 9.0F);
      }
    }
  };
  EXPECT_EQ(grow_mask(mask, part, region, growing), region);
  expect_part(grown);
  feather_mask(mask, part, region, feathering);
  expect_part(feathered);
}

}  // namespace
}  // namespace normalshop::test
