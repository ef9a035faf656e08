#include <cmath>
#include <limits>

#include "rgbn/filter_fixtures.h"
#include "support/relief.h"
#include <gtest/gtest.h>

#include "normalshop/core/error.h"
#include "normalshop/core/parallel.h"
#include "normalshop/rgbn/bilateral.h"
#include "normalshop/rgbn/smooth.h"

namespace normalshop::test {
namespace {

/// Colours that follow the normals, so that both have the same edges.
ColorImage colors_of(const SlopeImage& slopes) {
  ColorImage colors(slopes.width(), slopes.height());
  const ColorImage noise = random_colors(slopes.width(), slopes.height());
  for (int y = 0; y < slopes.height(); ++y) {
    for (int x = 0; x < slopes.width(); ++x) {
      colors(x, y) = 0.3F * normal_from_slope(slopes(x, y)) + 0.05F * noise(x, y);
    }
  }
  return colors;
}

SlopeImage bilateral_filtered(const SlopeImage& slopes, const BilateralOptions& options) {
  SlopeImage out(slopes.width(), slopes.height());
  bilateral({slopes, {}, {}}, {out, {}}, out.rect(), options);
  return out;
}

// Two pixels, continued: from the left one, itself and three neighbours are 0 and the right is 1.
TEST(Bilateral, ExactIsTheFormula) {
  SlopeImage slopes(2, 1, Vec2f::Zero());
  slopes(1, 0) = {1.0F, 0.0F};
  ColorImage colors(2, 1, Vec3f::Zero());
  colors(1, 0) = {0.3F, 0.0F, 0.4F};
  SlopeImage out(2, 1);
  ColorImage out_colors(2, 1);
  const BilateralOptions options{
      .sigma_space = 1.0F, .sigma_color = 0.5F, .sigma_normal = 0.7F, .guide_sigma = 0.0F};
  bilateral_exact({slopes, colors, {}}, {}, {out, out_colors}, out.rect(), options);
  const double normals = (normal_from_slope(slopes(1, 0)) - Vec3f::UnitZ()).norm();
  const double space = std::exp(-0.5);
  const double across = space * std::exp(-0.5 * normals * normals / 0.49) * std::exp(-0.5);
  const double expected = across / (1.0 + 3.0 * space + across);
  EXPECT_NEAR(out(0, 0).x(), expected, 1e-6);
  EXPECT_NEAR(out(1, 0).x(), 1.0 - expected, 1e-6);
  EXPECT_NEAR(out_colors(0, 0).x(), 0.3 * expected, 1e-6);
  EXPECT_NEAR(out_colors(0, 0).z(), 0.4 * expected, 1e-6);
}

struct Case {
  float sigma_space;
  float sigma_color;
  float sigma_normal;
  float guide_sigma;
};

class BilateralCase : public testing::TestWithParam<Case> {};

TEST_P(BilateralCase, IsCloseToTheExactFilter) {
  constexpr int size = 48;
  const SlopeImage slopes = with_noise(relief(size), 5.0F, 3);
  const ColorImage colors = colors_of(slopes);
  MaskImage valid(size, size, 1.0F);
  for (int y = 10; y < 20; ++y) {
    for (int x = 0; x < size; ++x) valid(x, y) = y < 14 ? 0.0F : 0.3F;
  }
  const Case c = GetParam();
  const BilateralOptions options{.sigma_space = c.sigma_space,
                                 .sigma_color = c.sigma_color,
                                 .sigma_normal = c.sigma_normal,
                                 .guide_sigma = c.guide_sigma};
  SlopeImage exact(size, size);
  SlopeImage fast(size, size);
  ColorImage exact_colors(size, size);
  ColorImage fast_colors(size, size);
  for (const MaskView& validity : {MaskView(), MaskView(valid)}) {
    const RgbnView source = {slopes, colors, validity};
    bilateral_exact(source, {}, {exact, exact_colors}, exact.rect(), options);
    bilateral(source, {fast, fast_colors}, fast.rect(), options);
    const double error = mean_error(exact, fast);
    RecordProperty("degrees", std::to_string(error));
    EXPECT_LT(error, 0.1);
    EXPECT_GT(mean_error(slopes, fast), 1.0);  // it did something
    float worst = 0.0F;
    for (int y = 0; y < size; ++y) {
      for (int x = 0; x < size; ++x) {
        worst = std::max(worst, (exact_colors(x, y) - fast_colors(x, y)).norm());
      }
    }
    EXPECT_LT(worst, 0.03F);
  }
}

INSTANTIATE_TEST_SUITE_P(Options, BilateralCase,
                         testing::Values(Case{3.0F, 0.1F, 0.2F, 1.0F}, Case{3.0F, 0.1F, 0.3F, 0.0F},
                                         Case{5.0F, 0.0F, 0.2F, 1.0F}, Case{5.0F, 0.2F, 0.0F, 0.7F},
                                         Case{8.0F, 0.1F, 0.3F, 0.0F},
                                         Case{2.0F, 0.0F, 0.0F, 0.0F}));

// The scene that filters are judged by: its creases are as hard for the Gaussian as they were when
// it was frozen.
TEST(Relief, TheGaussianLeaves265) {
  const auto left = [](float sigma) {
    return error_left(5.0F, [&](const SlopeImage& noisy, SlopeImage& out) {
      smooth(noisy, {}, out, out.rect(), {.sigma = sigma});
    });
  };
  const double least = left(1.2F);
  EXPECT_NEAR(least, 2.65, 0.02);
  EXPECT_GT(left(1.0F), least);
  EXPECT_GT(left(1.4F), least);
}

TEST(Bilateral, TakesNoiseOffAndLeavesEdges) {
  const double error = error_left(
      5.0F, [](const SlopeImage& noisy, SlopeImage& out) { out = bilateral_filtered(noisy, {}); });
  RecordProperty("degrees", std::to_string(error));
  EXPECT_LE(error, 1.25);
}

TEST(Bilateral, KeepsConstantsToTheLastBit) {
  const MaskImage half(70, 40, 0.5F);
  for (const Vec2f& value : {Vec2f(0.123456F, -7.654321F), Vec2f(31.0F, 2.0F)}) {
    const SlopeImage slopes(70, 40, value);
    const ColorImage colors(70, 40, Vec3f(0.1F, 0.7F, 12.3F));
    SlopeImage out(70, 40);
    ColorImage out_colors(70, 40);
    for (const MaskView& validity : {MaskView(), MaskView(half)}) {
      bilateral({slopes, colors, validity}, {out, out_colors}, out.rect());
      EXPECT_TRUE(same_bits(slopes, out));
      EXPECT_TRUE(same_bits(colors, out_colors));
    }
  }
}

TEST(Bilateral, SigmaZeroLeavesTheInput) {
  SlopeImage slopes = noise_image(33, 17);
  slopes(3, 4).x() = nan;
  for (const float sigma : {0.0F, 0.5F}) {
    SlopeImage out(33, 17);
    EXPECT_EQ(bilateral({slopes, {}, {}}, {out, {}}, {-5, 0, 100, 100}, {.sigma_space = sigma}),
              slopes.rect());
    EXPECT_TRUE(same_bits(slopes, out));
    bilateral_exact({slopes, {}, {}}, {}, {out, {}}, out.rect(), {.sigma_space = sigma});
    EXPECT_TRUE(same_bits(slopes, out));
  }
}

TEST(Bilateral, AGuideSaysWhereTheEdgesAre) {
  SlopeImage step(40, 9, Vec2f(0.5F, 0.0F));
  for (int y = 0; y < 9; ++y) {
    for (int x = 20; x < 40; ++x) step(x, y) = {-0.5F, 0.0F};
  }
  const SlopeImage flat(40, 9, Vec2f::Zero());
  const BilateralOptions options{.sigma_normal = 0.1F, .guide_sigma = 0.0F};
  SlopeImage out(40, 9);
  bilateral({step, {}, {}}, {step, {}, {}}, {out, {}}, out.rect(), options);
  EXPECT_NEAR(out(19, 4).x(), 0.5F, 1e-6F);
  bilateral({step, {}, {}}, {flat, {}, {}}, {out, {}}, out.rect(), options);
  EXPECT_LT(out(19, 4).x(), 0.2F);
  EXPECT_GT(out(19, 4).x(), 0.0F);
  EXPECT_NEAR(out(19, 4).x(), -out(20, 4).x(), 1e-6F);
}

TEST(Bilateral, ColoursStopIt) {
  SlopeImage step(40, 9, Vec2f(0.5F, 0.0F));
  ColorImage colors(40, 9, Vec3f(0.2F, 0.2F, 0.2F));
  for (int y = 0; y < 9; ++y) {
    for (int x = 20; x < 40; ++x) {
      step(x, y) = {-0.5F, 0.0F};
      colors(x, y) = {0.2F, 5000.0F, 0.2F};
    }
  }
  const BilateralOptions options{.sigma_normal = 0.0F, .guide_sigma = 0.0F};
  SlopeImage out(40, 9);
  ColorImage out_colors(40, 9);
  bilateral({step, colors, {}}, {out, out_colors}, out.rect(), options);
  EXPECT_TRUE(same_bits(step, out));
  EXPECT_TRUE(same_bits(colors, out_colors));
  bilateral({step, {}, {}}, {out, {}}, out.rect(), options);  // no colour, nothing that stops
  EXPECT_LT(out(19, 4).x(), 0.2F);
  ColorImage alone(40, 9);
  bilateral({step, colors, {}}, {{}, alone}, alone.rect(), options);
  EXPECT_TRUE(same_bits(out_colors, alone));
}

TEST(Bilateral, PixelsThatDoNotCount) {
  constexpr int size = 60;
  SlopeImage slopes(size, size, Vec2f(0.25F, -0.5F));
  MaskImage valid(size, size, 1.0F);
  for (int y = 0; y < size; ++y) {
    slopes(20, y) = {nan, 1.0F};   // not finite
    slopes(40, y) = {3.0F, 3.0F};  // invalid
    valid(40, y) = 0.0F;
  }
  for (const float guide_sigma : {0.0F, 1.0F}) {
    const BilateralOptions options{.sigma_normal = 0.0F, .guide_sigma = guide_sigma};
    SlopeImage fast(size, size);
    SlopeImage exact(size, size);
    bilateral({slopes, {}, valid}, {fast, {}}, fast.rect(), options);
    bilateral_exact({slopes, {}, valid}, {}, {exact, {}}, exact.rect(), options);
    EXPECT_TRUE(same_bits(slopes, fast));
    EXPECT_TRUE(same_bits(slopes, exact));
  }
}

TEST(Bilateral, AGrazingPixelCountsAsSlope20) {
  SlopeImage slopes(9, 9, Vec2f::Zero());
  slopes(4, 4) = {50.0F, 0.0F};
  const SlopeImage out =
      bilateral_filtered(slopes, {.sigma_space = 1.0F, .sigma_normal = 0.0F, .guide_sigma = 0.0F});
  const double space = std::exp(-0.5);
  EXPECT_NEAR(out(4, 4).x(), 20.0 / (1.0 + 4.0 * space), 1e-4);
  EXPECT_NEAR(out(5, 4).x(), 20.0 * space / (1.0 + 4.0 * space), 1e-4);
}

TEST(Bilateral, WhatTilesKeepsTiling) {
  const SlopeImage slopes = noise_image(50, 37);
  const BilateralOptions options{.sigma_space = 8.0F, .sigma_normal = 0.5F, .border = Border::Wrap};
  const SlopeImage out = bilateral_filtered(slopes, options);
  EXPECT_TRUE(same_bits(rolled(out, 23, 11), bilateral_filtered(rolled(slopes, 23, 11), options)));
  // Clamped, it would not.
  EXPECT_FALSE(same_bits(
      rolled(out, 23, 11),
      bilateral_filtered(rolled(slopes, 23, 11), {.sigma_space = 8.0F, .sigma_normal = 0.5F})));
}

TEST(Bilateral, AMirroredBorderIsAMirrorImage) {
  const SlopeImage slopes = noise_image(41, 30);
  const SlopeImage wide = surrounded(slopes, 1, Border::Mirror);
  const BilateralOptions options{.sigma_normal = 0.5F, .border = Border::Mirror};
  const SlopeImage mirrored = bilateral_filtered(slopes, options);
  const SlopeImage expected = bilateral_filtered(wide, options);
  for (int y = 0; y < 30; ++y) {
    for (int x = 0; x < 41; ++x) EXPECT_EQ(mirrored(x, y), expected(41 + x, 30 + y));
  }
}

TEST(Bilateral, ARegionGivesThePixelsOfTheWhole) {
  const SlopeImage slopes = noise_image(300, 160);
  const Rect region = {111, 37, 170, 143};
  const BilateralOptions options{.sigma_normal = 0.5F};
  const SlopeImage whole = bilateral_filtered(slopes, options);
  SlopeImage part(300, 160, Vec2f::Constant(9.0F));
  EXPECT_EQ(bilateral({slopes, {}, {}}, {part, {}}, region, options), region);
  for (int y = 0; y < 160; ++y) {
    for (int x = 0; x < 300; ++x) {
      EXPECT_EQ(part(x, y), region.contains(x, y) ? whole(x, y) : Vec2f(9.0F, 9.0F));
    }
  }
  EXPECT_TRUE(bilateral({slopes, {}, {}}, {part, {}}, {5, 5, 5, 9}, options).empty());
}

TEST(Bilateral, TheNumberOfThreadsChangesNothing) {
  const SlopeImage slopes = noise_image(301, 203);
  const ColorImage colors = random_colors(301, 203);
  const BilateralOptions options{.sigma_color = 0.5F, .sigma_normal = 0.5F};
  SlopeImage many(301, 203);
  ColorImage many_colors(301, 203);
  bilateral({slopes, colors, {}}, {many, many_colors}, many.rect(), options);
  SlopeImage one = slopes;
  ColorImage one_colors = colors;
  const ThreadLimit limit(1);
  bilateral({one, one_colors, {}}, {one, one_colors}, one.rect(), options);  // in place, too
  EXPECT_TRUE(same_bits(many, one));
  EXPECT_TRUE(same_bits(many_colors, one_colors));
}

TEST(Bilateral, ExtremeOptionsGiveNumbers) {
  const SlopeImage slopes = noise_image(20, 20);
  const ColorImage colors = random_colors(20, 20);
  SlopeImage out(20, 20);
  for (const float sigma : {1e-30F, 1e6F}) {
    bilateral({slopes, colors, {}}, {out, {}}, out.rect(),
              {.sigma_color = sigma, .sigma_normal = sigma, .guide_sigma = 0.0F});
    for (int i = 0; i < 20; ++i) EXPECT_TRUE(out(i, i).allFinite());
    if (sigma < 1.0F) {
      EXPECT_TRUE(same_bits(slopes, out));
    }
  }
}

TEST(Bilateral, RejectsOptionsOutsideTheirRanges) {
  SlopeImage slopes(4, 4, Vec2f::Zero());
  const auto run = [&](const BilateralOptions& options) {
    bilateral({slopes, {}, {}}, {slopes, {}}, slopes.rect(), options);
  };
  EXPECT_THROW(run({.sigma_space = -1.0F}), InvalidInput);
  EXPECT_THROW(run({.sigma_space = 101.0F}), InvalidInput);
  EXPECT_THROW(run({.sigma_space = nan}), InvalidInput);
  EXPECT_THROW(run({.sigma_color = nan}), InvalidInput);
  EXPECT_THROW(run({.sigma_normal = std::numeric_limits<float>::infinity()}), InvalidInput);
  EXPECT_THROW(run({.guide_sigma = nan}), InvalidInput);
}

TEST(Bilateral, TinyImages) {
  for (const Border border : {Border::Clamp, Border::Mirror, Border::Wrap}) {
    const BilateralOptions options{.sigma_space = 20.0F, .border = border};
    SlopeImage one(1, 1, Vec2f(0.0F, 0.0F));
    bilateral({one, {}, {}}, {one, {}}, one.rect(), options);
    EXPECT_EQ(one(0, 0), Vec2f(0.0F, 0.0F));
    SlopeImage none;
    EXPECT_TRUE(bilateral({none, {}, {}}, {none, {}}, {0, 0, 5, 5}, options).empty());
  }
}

}  // namespace
}  // namespace normalshop::test
