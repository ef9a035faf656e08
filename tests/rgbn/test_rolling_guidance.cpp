#include <cmath>

#include "rgbn/filter_fixtures.h"
#include "support/relief.h"
#include <gtest/gtest.h>

#include "normalshop/core/error.h"
#include "normalshop/core/parallel.h"
#include "normalshop/rgbn/bilateral.h"
#include "normalshop/rgbn/rolling_guidance.h"

namespace normalshop::test {
namespace {

SlopeImage rolling_filtered(const SlopeImage& slopes, const RollingGuidanceOptions& options) {
  SlopeImage out(slopes.width(), slopes.height());
  rolling_guidance({slopes, {}, {}}, {out, {}}, out.rect(), options);
  return out;
}

// 1.1 was the aim.
TEST(RollingGuidance, TakesNoiseOffAndLeavesEdges) {
  const double error = error_left(
      5.0F, [](const SlopeImage& noisy, SlopeImage& out) { out = rolling_filtered(noisy, {}); });
  RecordProperty("degrees", std::to_string(error));
  EXPECT_LE(error, 1.1);
}

TEST(RollingGuidance, TakesFineWavesOffAStepAndKeepsTheStep) {
  SlopeImage slopes(80, 9);
  for (int y = 0; y < 9; ++y) {
    for (int x = 0; x < 80; ++x) {
      slopes(x, y) = {(x < 40 ? 0.5F : -0.5F) + (x % 2 == 0 ? 0.1F : -0.1F), 0.0F};
    }
  }
  const SlopeImage out = rolling_filtered(slopes, {});
  for (int x = 10; x < 70; ++x) {
    EXPECT_NEAR(out(x, 4).x(), x < 40 ? 0.5F : -0.5F, 0.02F) << x;
  }
}

TEST(RollingGuidance, IsTheBilateralFilterGuidedByItsLastResult) {
  const SlopeImage slopes = noise_image(40, 30);
  const ColorImage colors = random_colors(40, 30);
  const RollingGuidanceOptions options{
      .sigma_space = 3.0F, .sigma_color = 0.4F, .sigma_normal = 0.5F, .iterations = 2};
  SlopeImage out(40, 30);
  ColorImage out_colors(40, 30);
  rolling_guidance({slopes, colors, {}}, {out, out_colors}, out.rect(), options);
  SlopeImage guide(40, 30);
  ColorImage guide_colors(40, 30);
  bilateral({slopes, colors, {}}, {guide, guide_colors}, guide.rect(),
            {.sigma_space = 3.0F, .sigma_color = 0.4F, .sigma_normal = 0.5F, .guide_sigma = 0.5F});
  SlopeImage expected(40, 30);
  bilateral({slopes, colors, {}}, {guide, guide_colors, {}}, {expected, {}}, expected.rect(),
            {.sigma_space = 3.0F, .sigma_color = 0.4F, .sigma_normal = 0.5F, .guide_sigma = 0.0F});
  for (int y = 8; y < 22; ++y) {
    for (int x = 8; x < 32; ++x) EXPECT_EQ(out(x, y), expected(x, y));
  }
}

TEST(RollingGuidance, NeutralOptionsAndConstantsKeepTheirBits) {
  const SlopeImage slopes = noise_image(33, 17);
  EXPECT_TRUE(same_bits(slopes, rolling_filtered(slopes, {.sigma_space = 0.0F})));
  EXPECT_TRUE(same_bits(slopes, rolling_filtered(slopes, {.iterations = 0})));
  const SlopeImage constant(33, 17, Vec2f(0.123456F, -7.654321F));
  EXPECT_TRUE(same_bits(constant, rolling_filtered(constant, {})));
}

TEST(RollingGuidance, PixelsThatDoNotCount) {
  SlopeImage slopes(40, 40, Vec2f(0.25F, -0.5F));
  MaskImage valid(40, 40, 1.0F);
  for (int y = 0; y < 40; ++y) {
    slopes(10, y) = {nan, 1.0F};
    slopes(30, y) = {3.0F, 3.0F};
    valid(30, y) = 0.0F;
  }
  SlopeImage out(40, 40);
  rolling_guidance({slopes, {}, valid}, {out, {}}, out.rect(), {.sigma_normal = 0.0F});
  EXPECT_TRUE(same_bits(slopes, out));
}

TEST(RollingGuidance, WhatTilesKeepsTiling) {
  const SlopeImage slopes = noise_image(30, 21);
  const RollingGuidanceOptions options{.sigma_normal = 0.5F, .border = Border::Wrap};
  EXPECT_TRUE(same_bits(rolled(rolling_filtered(slopes, options), 13, 8),
                        rolling_filtered(rolled(slopes, 13, 8), options)));
}

TEST(RollingGuidance, ARegionGivesThePixelsOfTheWhole) {
  const SlopeImage slopes = noise_image(90, 80);
  const Rect region = {31, 30, 57, 43};
  const RollingGuidanceOptions options{.sigma_normal = 0.5F};
  const SlopeImage whole = rolling_filtered(slopes, options);
  SlopeImage part(90, 80, Vec2f::Constant(9.0F));
  EXPECT_EQ(rolling_guidance({slopes, {}, {}}, {part, {}}, region, options), region);
  for (int y = 0; y < 80; ++y) {
    for (int x = 0; x < 90; ++x) {
      EXPECT_EQ(part(x, y), region.contains(x, y) ? whole(x, y) : Vec2f(9.0F, 9.0F));
    }
  }
  EXPECT_TRUE(rolling_guidance({slopes, {}, {}}, {part, {}}, {}, options).empty());
}

TEST(RollingGuidance, TheNumberOfThreadsChangesNothing) {
  const SlopeImage slopes = noise_image(150, 101);
  const SlopeImage many = rolling_filtered(slopes, {.sigma_normal = 0.5F});
  SlopeImage one = slopes;
  const ThreadLimit limit(1);
  rolling_guidance({one, {}, {}}, {one, {}}, one.rect(), {.sigma_normal = 0.5F});
  EXPECT_TRUE(same_bits(many, one));
}

TEST(RollingGuidance, RejectsOptionsOutsideTheirRanges) {
  SlopeImage slopes(4, 4, Vec2f::Zero());
  EXPECT_THROW(rolling_filtered(slopes, {.sigma_space = nan}), InvalidInput);
  EXPECT_THROW(rolling_filtered(slopes, {.sigma_color = -1.0F}), InvalidInput);
  EXPECT_THROW(rolling_filtered(slopes, {.sigma_normal = nan}), InvalidInput);
  EXPECT_THROW(rolling_filtered(slopes, {.guide_sigma = nan}), InvalidInput);
  EXPECT_THROW(rolling_filtered(slopes, {.iterations = -1}), InvalidInput);
  EXPECT_THROW(rolling_filtered(slopes, {.iterations = 21}), InvalidInput);
}

TEST(RollingGuidance, TinyImages) {
  SlopeImage one(1, 1, Vec2f(1.0F, 2.0F));
  EXPECT_EQ(rolling_filtered(one, {})(0, 0), Vec2f(1.0F, 2.0F));
  SlopeImage none;
  EXPECT_TRUE(rolling_guidance({none, {}, {}}, {none, {}}, {0, 0, 5, 5}).empty());
}

}  // namespace
}  // namespace normalshop::test
