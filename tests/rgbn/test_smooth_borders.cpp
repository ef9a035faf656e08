#include <cmath>

#include "rgbn/filter_fixtures.h"
#include "support/sanitized.h"
#include <gtest/gtest.h>

#include "normalshop/core/parallel.h"
#include "normalshop/rgbn/sharpen.h"
#include "normalshop/rgbn/smooth.h"

namespace normalshop::test {
namespace {

SlopeImage smoothed(const SlopeImage& image, float sigma, Border border, MaskView valid = {}) {
  SlopeImage out(image.width(), image.height());
  smooth(image, valid, out, image.rect(), {.sigma = sigma}, border);
  return out;
}

/// The direct filter as its header says, in plain loops: columns, then rows, from the smallest
/// weights.
SlopeImage plain_gaussian(const SlopeImage& image, double sigma) {
  const int radius = static_cast<int>(std::ceil(4.0 * sigma));
  std::vector<double> exact;
  double sum = 1.0;
  for (int k = 1; k <= radius; ++k) {
    exact.push_back(std::exp(-0.5 * k * k / (sigma * sigma)));
    sum += 2.0 * exact.back();
  }
  const auto pass = [&](const SlopeImage& from, int dx, int dy) {
    SlopeImage to(from.width(), from.height());
    const auto at = [&](int x, int y) {
      return from(std::clamp(x, 0, from.width() - 1), std::clamp(y, 0, from.height() - 1));
    };
    for (int y = 0; y < from.height(); ++y) {
      for (int x = 0; x < from.width(); ++x) {
        const Vec2f center = from(x, y);
        Vec2f change = Vec2f::Zero();
        for (int k = radius; k >= 1; --k) {
          const auto w = static_cast<float>(exact[static_cast<std::size_t>(k - 1)] / sum);
          const Vec2f pair = at(x - k * dx, y - k * dy) + at(x + k * dx, y + k * dy);
          const Vec2f step = w * (pair - (center + center));
          change += step;
        }
        to(x, y) = center + change;
      }
    }
    return to;
  };
  return pass(pass(image, 0, 1), 1, 0);
}

TEST(SmoothBorders, ClampedDirectFilterHasTheBitsOfItsFormula) {
  NORMALSHOP_SKIP_FIGURES();
  const SlopeImage image = noise_image(301, 97);
  for (const float sigma : {0.3F, 1.0F, 2.0F, 4.0F}) {
    EXPECT_TRUE(same_bits(smoothed(image, sigma, Border::Clamp),
                          plain_gaussian(image, static_cast<double>(sigma))))
        << sigma;
  }
}

// Wide Gaussians see the image through points at absolute places, so moving it changes them a
// little: by less than the 1e-4 of the slope range (2 here) that every filter keeps to.
TEST(SmoothBorders, WhatTilesKeepsTiling) {
  const SlopeImage image = noise_image(61, 47);
  const MaskImage valid = noise_mask(61, 47);
  const SlopeImage moved = rolled(image, 17, 29);
  const MaskImage moved_valid = rolled(valid, 17, 29);
  for (const float sigma : {0.5F, 2.0F, 4.0F, 5.5F, 9.0F, 40.0F, 300.0F}) {
    const float most = sigma <= 4.0F ? 0.0F : 1e-4F * 2.0F;
    EXPECT_LE(largest_difference(smoothed(moved, sigma, Border::Wrap),
                                 rolled(smoothed(image, sigma, Border::Wrap), 17, 29)),
              most)
        << sigma;
    EXPECT_LE(largest_difference(smoothed(moved, sigma, Border::Wrap, moved_valid),
                                 rolled(smoothed(image, sigma, Border::Wrap, valid), 17, 29)),
              most)
        << sigma;
  }
}

TEST(SmoothBorders, WrapAndMirrorGoOnAsTheImageDoes) {
  const SlopeImage image = noise_image(45, 38);
  for (const Border border : {Border::Wrap, Border::Mirror}) {
    const SlopeImage wide = surrounded(image, 2, border);
    const Rect middle = {90, 76, 135, 114};
    for (const float sigma : {0.5F, 3.0F}) {
      EXPECT_TRUE(same_bits(smoothed(image, sigma, border),
                            cut(smoothed(wide, sigma, Border::Clamp), middle)))
          << name_of(border) << sigma;
    }
    for (const float sigma : {6.0F, 15.0F}) {
      EXPECT_LT(largest_difference(smoothed(image, sigma, border),
                                   cut(smoothed(wide, sigma, Border::Clamp), middle)),
                1e-4F)
          << name_of(border) << sigma;
    }
  }
}

TEST(SmoothBorders, MirrorDoesNotTurnMasks) {
  const MaskImage mask(40, 30, 0.7F);
  for (const float sigma : {2.0F, 12.0F}) {
    MaskImage out(40, 30);
    smooth(mask, {}, out, mask.rect(), {.sigma = sigma}, Border::Mirror);
    EXPECT_TRUE(same_bits(out, mask));
  }
}

// A ramp that goes up to the border goes down beyond it: across the border the slope is 0 on
// average, along it nothing changes.
TEST(SmoothBorders, MirrorTurnsTheSlopeAcrossTheBorder) {
  const SlopeImage image(200, 160, Vec2f(1.0F, 0.5F));
  for (const float sigma : {3.0F, 10.0F}) {
    const SlopeImage out = smoothed(image, sigma, Border::Mirror);
    const auto expected =
        static_cast<float>(std::erf(0.5 / std::sqrt(2.0) / static_cast<double>(sigma)));
    EXPECT_NEAR(out(0, 80).x(), expected, 2e-3F);
    EXPECT_NEAR(out(199, 80).x(), expected, 2e-3F);
    EXPECT_NEAR(out(0, 80).y(), 0.5F, 1e-4F);
    EXPECT_NEAR(out(100, 159).y(), 0.5F * expected, 1e-3F);
    EXPECT_NEAR(out(100, 80).x(), 1.0F, 1e-4F);
  }
}

TEST(SmoothBorders, WrapKeepsConstantsAndMeans) {
  const SlopeImage constant(70, 50, Vec2f(0.123456F, -7.654321F));
  const SlopeImage image = noise_image(64, 32);
  Vec2d mean = Vec2d::Zero();
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 64; ++x) mean += image(x, y).cast<double>() / (64.0 * 32.0);
  }
  for (const float sigma : {2.0F, 20.0F, 1e6F}) {
    EXPECT_TRUE(same_bits(smoothed(constant, sigma, Border::Wrap), constant)) << sigma;
  }
  const SlopeImage flat = smoothed(image, 1e6F, Border::Wrap);
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 64; ++x) EXPECT_LT((flat(x, y).cast<double>() - mean).norm(), 1e-6);
  }
}

TEST(SmoothBorders, ARegionGivesThePixelsOfTheWhole) {
  const SlopeImage image = noise_image(160, 130);
  const MaskImage valid = noise_mask(160, 130);
  for (const Border border : borders) {
    for (const Rect& region : {Rect{0, 0, 20, 15}, Rect{140, 100, 160, 130}, Rect{50, 40, 90, 60},
                               Rect{0, 30, 160, 40}, Rect{30, 0, 40, 130}}) {
      for (const float sigma : {2.0F, 9.0F, 60.0F}) {
        for (const MaskView mask : {MaskView{}, valid.view()}) {
          const SlopeImage whole = smoothed(image, sigma, border, mask);
          SlopeImage part(160, 130, Vec2f::Constant(9.0F));
          EXPECT_EQ(smooth(image, mask, part, region, {.sigma = sigma}, border), region);
          EXPECT_TRUE(same_bits(cut(whole, region), cut(part, region))) << name_of(border) << sigma;
          EXPECT_EQ(part(region.x0 == 0 ? 159 : 0, 70), Vec2f(Vec2f::Constant(9.0F)))
              << (region.y0 <= 70 && region.width() == 160);
        }
      }
    }
  }
}

TEST(SmoothBorders, TheNumberOfThreadsChangesNothing) {
  const SlopeImage image = noise_image(301, 203);
  const MaskImage valid = noise_mask(301, 203);
  for (const Border border : borders) {
    for (const float sigma : {3.0F, 25.0F, 100.0F}) {
      const SlopeImage many = smoothed(image, sigma, border);
      const SlopeImage many_masked = smoothed(image, sigma, border, valid);
      const ThreadLimit limit(1);
      SlopeImage one = image;
      smooth(one, {}, one, one.rect(), {.sigma = sigma}, border);  // in place, too
      EXPECT_TRUE(same_bits(many, one)) << name_of(border) << sigma;
      EXPECT_TRUE(same_bits(many_masked, smoothed(image, sigma, border, valid)));
    }
  }
}

TEST(SmoothBorders, TinyImagesAndWideGaussians) {
  for (const Border border : borders) {
    for (const float sigma : {0.3F, 3.0F, 50.0F, 1e6F}) {
      const SlopeImage dot(1, 1, Vec2f(1.0F, 2.0F));
      const SlopeImage out = smoothed(dot, sigma, border);
      if (border != Border::Mirror) {
        EXPECT_EQ(out(0, 0), dot(0, 0));
      }
      if (border == Border::Mirror) {
        EXPECT_LE(out(0, 0).norm(), dot(0, 0).norm());
      }
      const SlopeImage line = smoothed(noise_image(3, 50), sigma, border);
      EXPECT_LT(largest_difference(line, SlopeImage(3, 50, Vec2f::Zero())), 1.5F)
          << name_of(border) << sigma;
      SlopeImage none;
      EXPECT_TRUE(smooth(none, {}, none, {0, 0, 5, 5}, {.sigma = sigma}, border).empty());
    }
  }
}

TEST(SmoothBorders, SharpeningTilesToo) {
  const SlopeImage image = noise_image(61, 47);
  const auto sharpened = [](const SlopeImage& from, const SharpenOptions& options) {
    SlopeImage out(from.width(), from.height());
    sharpen(from, {}, out, from.rect(), options, Border::Wrap);
    return out;
  };
  const SharpenOptions direct{.sigma = 3.0F, .noise_sigma = 1.0F};
  EXPECT_TRUE(same_bits(sharpened(rolled(image, 17, 29), direct),
                        rolled(sharpened(image, direct), 17, 29)));
  const SharpenOptions recursive{.sigma = 30.0F, .noise_sigma = 8.0F};
  EXPECT_LT(largest_difference(sharpened(rolled(image, 17, 29), recursive),
                               rolled(sharpened(image, recursive), 17, 29)),
            1e-5F);
}

}  // namespace
}  // namespace normalshop::test
