#include <cmath>
#include <limits>

#include "rgbn/filter_fixtures.h"
#include <gtest/gtest.h>

#include "normalshop/core/error.h"
#include "normalshop/core/parallel.h"
#include "normalshop/rgbn/convolve.h"

namespace normalshop::test {
namespace {

Image<float> noise_kernel(int width, int height, std::uint32_t seed) {
  Image<float> kernel(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) kernel(x, y) = noise(x, y, seed);
  }
  return kernel;
}

/// A column times a row, neither of them symmetric.
Image<float> product_kernel(int width, int height) {
  Image<float> kernel(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      kernel(x, y) = noise(x, 0, 7) * noise(0, y, 8);
    }
  }
  return kernel;
}

SlopeImage convolved(const SlopeImage& image, const Image<float>& kernel,
                     const ConvolveOptions& options = {}, MaskView valid = {}) {
  SlopeImage out(image.width(), image.height());
  convolve(image, valid, kernel, out, image.rect(), options);
  return out;
}

/// By the header's formulas, in double.
SlopeImage plain(const SlopeImage& image, const Image<float>& kernel, Border border,
                 MaskView valid) {
  SlopeImage out(image.width(), image.height());
  const int rx = kernel.width() / 2;
  const int ry = kernel.height() / 2;
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      Vec2d sum = Vec2d::Zero();
      Vec2d mean = Vec2d::Zero();
      double missing = 0.0;
      double size = 0.0;
      for (int j = -ry; j <= ry; ++j) {
        for (int i = -rx; i <= rx; ++i) {
          const BorderPixel px = border_pixel(x - i, image.width(), border);
          const BorderPixel py = border_pixel(y - j, image.height(), border);
          Vec2d value = image(px.index, py.index).cast<double>();
          if (px.flipped) value.x() = -value.x();
          if (py.flipped) value.y() = -value.y();
          const auto w = static_cast<double>(kernel(i + rx, j + ry));
          const double v = valid.empty() ? 1.0 : static_cast<double>(valid(px.index, py.index));
          if (v > 0.0) sum += w * v * value;
          if (v > 0.0) mean += std::abs(w) * v * value;
          size += std::abs(w) * v;
          missing += w * (1.0 - v);
        }
      }
      if (!valid.empty()) sum += missing * mean / size;
      if (size == 0.0) sum = image(x, y).cast<double>();  // nothing valid in reach
      out(x, y) = sum.cast<float>();
    }
  }
  return out;
}

TEST(Convolve, HasTheFormulaOfItsHeader) {
  const SlopeImage image = noise_image(43, 38);
  const MaskImage valid = noise_mask(43, 38);
  for (const Border border : borders) {
    for (const auto& kernel :
         {noise_kernel(5, 3, 1), noise_kernel(1, 9, 2), noise_kernel(11, 11, 3),
          product_kernel(9, 7), product_kernel(51, 3)}) {
      EXPECT_LT(largest_difference(convolved(image, kernel, {.border = border}),
                                   plain(image, kernel, border, {})),
                2e-5F)
          << kernel.width() << name_of(border);
      EXPECT_LT(largest_difference(convolved(image, kernel, {.border = border}, valid),
                                   plain(image, kernel, border, valid)),
                5e-5F)
          << kernel.width() << name_of(border);
    }
  }
}

TEST(Convolve, APixelBecomesTheKernel) {
  for (const auto& kernel : {noise_kernel(5, 7, 4), product_kernel(5, 7)}) {
    SlopeImage image(20, 20, Vec2f::Zero());
    image(10, 9) = {1.0F, -2.0F};
    const SlopeImage out = convolved(image, kernel);
    for (int y = 0; y < 7; ++y) {
      for (int x = 0; x < 5; ++x) {
        EXPECT_NEAR(out(8 + x, 6 + y).x(), kernel(x, y), 1e-6F);
        EXPECT_NEAR(out(8 + x, 6 + y).y(), -2.0F * kernel(x, y), 1e-6F);
      }
    }
    EXPECT_EQ(out(7, 9), Vec2f(Vec2f::Zero()));
  }
}

TEST(Convolve, TheMiddleWeightAloneLeavesTheInput) {
  const SlopeImage image = noise_image(30, 21);
  const Image<float> one(1, 1, 1.0F);
  Image<float> middle(5, 3, 0.0F);
  middle(2, 1) = 1.0F;
  const MaskImage valid(30, 21, 1.0F);
  for (const Border border : borders) {
    EXPECT_TRUE(same_bits(convolved(image, one, {.border = border}), image));
    EXPECT_TRUE(same_bits(convolved(image, middle, {.border = border}), image));
    EXPECT_TRUE(same_bits(convolved(image, middle, {.border = border}, valid), image));
  }
}

// The response of the kernel to a wave, whatever its phase, and no curl.
TEST(Convolve, FiltersTheHeightOfATilingTexture) {
  constexpr int width = 256;
  constexpr int height = 200;
  const SlopeImage image = wave_slopes(width, height, [](double, double) { return 1.0; });
  for (const auto& kernel : {noise_kernel(7, 5, 5), product_kernel(9, 9)}) {
    const auto response = [&](double kx, double ky) {
      std::complex<double> sum = 0.0;
      for (int y = 0; y < kernel.height(); ++y) {
        for (int x = 0; x < kernel.width(); ++x) {
          const double phase = kx * (x - kernel.width() / 2) + ky * (y - kernel.height() / 2);
          sum += static_cast<double>(kernel(x, y)) * std::polar(1.0, -phase);
        }
      }
      return sum;
    };
    const SlopeImage out = convolved(image, kernel, {.border = Border::Wrap});
    const SlopeImage expected = wave_slopes(width, height, response);
    EXPECT_LT(largest_difference(out, expected), 1e-5F * slope_range(expected));
    EXPECT_LT(wave_curl_share(out), 1e-10);
  }
}

TEST(Convolve, Normalises) {
  const Image<float> box(5, 3, 4.0F);
  const SlopeImage image(20, 14, Vec2f(0.3F, -0.7F));
  EXPECT_LT(largest_difference(convolved(image, box, {.normalize = true}), image), 1e-6F);
  Image<float> edges(3, 1, 1.0F);
  edges(1, 0) = -2.0F;
  SlopeImage out(20, 14);
  EXPECT_THROW(convolve(image, {}, edges, out, image.rect(), {.normalize = true}), InvalidInput);
  EXPECT_LT(largest_difference(convolved(image, edges), SlopeImage(20, 14, Vec2f::Zero())), 1e-6F);
}

TEST(Convolve, InvalidPixelsDoNotCount) {
  SlopeImage image(60, 40, Vec2f(0.25F, -0.5F));
  MaskImage valid(60, 40, 1.0F);
  for (int y = 0; y < 40; ++y) {
    for (int x = 30; x < 60; ++x) {
      valid(x, y) = 0.0F;
      image(x, y) = Vec2f::Constant(std::numeric_limits<float>::quiet_NaN());
    }
  }
  Image<float> edges(3, 3, -1.0F);
  edges(1, 1) = 8.0F;
  const SlopeImage none = convolved(image, edges, {}, valid);
  const SlopeImage blurred = convolved(image, Image<float>(7, 7, 1.0F), {.normalize = true}, valid);
  for (int x = 0; x < 30; ++x) {
    EXPECT_LT(none(x, 20).norm(), 1e-5F) << x;
    EXPECT_LT((blurred(x, 20) - Vec2f(0.25F, -0.5F)).norm(), 1e-6F) << x;
  }
  EXPECT_LT((blurred(32, 20) - Vec2f(0.25F, -0.5F)).norm(), 1e-6F);
  EXPECT_TRUE(std::isnan(blurred(33, 20).x()));  // nothing valid in reach: the source
}

TEST(Convolve, WhatTilesKeepsTiling) {
  const SlopeImage image = noise_image(61, 47);
  const MaskImage valid = noise_mask(61, 47);
  const MaskImage moved_valid = rolled(valid, 17, 29);
  for (const auto& kernel : {noise_kernel(7, 5, 5), product_kernel(65, 3)}) {
    const ConvolveOptions options{.border = Border::Wrap};
    EXPECT_TRUE(same_bits(convolved(rolled(image, 17, 29), kernel, options),
                          rolled(convolved(image, kernel, options), 17, 29)));
    EXPECT_TRUE(same_bits(convolved(rolled(image, 17, 29), kernel, options, moved_valid),
                          rolled(convolved(image, kernel, options, valid), 17, 29)));
  }
}

TEST(Convolve, ARegionGivesTheBitsOfTheWholeForAnyNumberOfThreads) {
  const SlopeImage image = noise_image(700, 150);
  const MaskImage valid = noise_mask(700, 150);
  for (const auto& kernel : {noise_kernel(7, 5, 5), product_kernel(21, 9)}) {
    const int side = reach(kernel);
    EXPECT_EQ(side, kernel.width() / 2);
    for (const Border border : borders) {
      for (const MaskView mask : {MaskView{}, valid.view()}) {
        const SlopeImage whole = convolved(image, kernel, {.border = border}, mask);
        for (const Rect& region : {Rect{0, 100, 33, 150}, Rect{510, 60, 530, 90}}) {
          SlopeImage part(700, 150, Vec2f::Constant(9.0F));
          const ThreadLimit limit(1);
          EXPECT_EQ(convolve(image, mask, kernel, part, region, {.border = border}), region);
          EXPECT_TRUE(same_bits(cut(whole, region), cut(part, region)));
          EXPECT_EQ(part(300, 20), Vec2f(Vec2f::Constant(9.0F)));
        }
        SlopeImage same = image;
        convolve(same, mask, kernel, same, same.rect(), {.border = border});
        EXPECT_TRUE(same_bits(same, whole));
      }
    }
  }
}

TEST(Convolve, Masks) {
  MaskImage mask(9, 9, 0.0F);
  mask(4, 4) = 1.0F;
  const Image<float> kernel = noise_kernel(3, 3, 6);
  convolve(mask, {}, kernel, mask, mask.rect());
  for (int y = 0; y < 3; ++y) {
    for (int x = 0; x < 3; ++x) EXPECT_EQ(mask(3 + x, 3 + y), kernel(x, y));
  }
}

TEST(Convolve, RejectsWhatIsNoKernel) {
  SlopeImage image(4, 4, Vec2f::Zero());
  const auto run = [&](const Image<float>& kernel) {
    convolve(image, {}, kernel, image, image.rect());
  };
  EXPECT_THROW(run(Image<float>(2, 3, 1.0F)), InvalidInput);
  EXPECT_THROW(run(Image<float>(3, 4, 1.0F)), InvalidInput);
  EXPECT_THROW(run(Image<float>()), InvalidInput);
  EXPECT_THROW(run(Image<float>(3, 3, std::numeric_limits<float>::infinity())), InvalidInput);
  run(Image<float>(1, 1, 0.0F));
  EXPECT_EQ(image(2, 2), Vec2f(Vec2f::Zero()));
}

TEST(Convolve, TinyImages) {
  for (const Border border : borders) {
    SlopeImage dot(1, 1, Vec2f(1.0F, 2.0F));
    convolve(dot, {}, Image<float>(5, 5, 1.0F), dot, dot.rect(),
             {.normalize = true, .border = border});
    // Mirrored, a pixel's slope goes up and down in turn.
    const Vec2f expected = border == Border::Mirror ? Vec2f(0.2F, 0.4F) : Vec2f(1.0F, 2.0F);
    EXPECT_LT((dot(0, 0) - expected).norm(), 1e-6F) << name_of(border);
    SlopeImage none;
    EXPECT_TRUE(convolve(none, {}, Image<float>(3, 3, 1.0F), none, {0, 0, 4, 4}).empty());
  }
}

}  // namespace
}  // namespace normalshop::test
