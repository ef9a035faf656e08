#include <cmath>
#include <limits>
#include <vector>

#include "rgbn/filter_fixtures.h"
#include "support/sanitized.h"
#include <gtest/gtest.h>

#include "normalshop/core/error.h"
#include "normalshop/core/parallel.h"
#include "normalshop/rgbn/curl.h"
#include "normalshop/rgbn/filter.h"
#include "normalshop/rgbn/sharpen.h"
#include "normalshop/rgbn/smooth.h"

namespace normalshop::test {
namespace {

constexpr std::array kinds = {FilterKind::Gaussian, FilterKind::HighPass,
                              FilterKind::BandPass, FilterKind::LaplacianOfGaussian,
                              FilterKind::Unsharp,  FilterKind::EdgeEnhance,
                              FilterKind::Scale};

SlopeImage filtered(const SlopeImage& image, const FilterOptions& options, MaskView valid = {}) {
  SlopeImage out(image.width(), image.height());
  filter(image, valid, out, image.rect(), options);
  return out;
}

FilterOptions options_of(FilterKind kind, float sigma, Border border = Border::Clamp) {
  return {.kind = kind, .sigma = sigma, .noise_sigma = 1.0F, .border = border};
}

/// From the table in filter.h.
double exact_response(const FilterOptions& o, double kx, double ky) {
  const auto gauss = [&](float sigma) {
    if (sigma == 0.0F) return 1.0;
    const auto s = static_cast<double>(sigma);
    return gauss_response(s, kx) * gauss_response(s, ky);
  };
  const auto amount = static_cast<double>(o.amount);
  const auto sigma = static_cast<double>(o.sigma);
  switch (o.kind) {
    case FilterKind::Gaussian:
      return gauss(o.sigma);
    case FilterKind::HighPass:
      return amount * (1.0 - gauss(o.sigma));
    case FilterKind::BandPass:
      return amount * (gauss(o.noise_sigma) - gauss(o.sigma));
    case FilterKind::LaplacianOfGaussian: {
      if (sigma < 1.0) {
        return amount * -sigma * sigma *
               (bend_response(sigma, kx) * gauss_response(sigma, ky) +
                gauss_response(sigma, kx) * bend_response(sigma, ky));
      }
      const double square = sigma * sigma * (kx * kx + ky * ky);
      return amount * square * std::exp(-0.5 * square);
    }
    case FilterKind::Unsharp:
      return 1.0 + amount * (1.0 - gauss(o.sigma));
    case FilterKind::EdgeEnhance:
      return 1.0 + amount * (gauss(o.noise_sigma) - gauss(o.sigma));
    case FilterKind::Scale:
      return amount;
  }
  return 0.0;
}

class FilterSigma : public testing::TestWithParam<float> {};

// The filtered slopes are the slopes of the filtered height (thesis 2.2), also across the borders
// of a texture that tiles.
TEST_P(FilterSigma, FiltersTheHeightOfATilingTexture) {
  constexpr int width = 256;
  constexpr int height = 200;
  const SlopeImage image = wave_slopes(width, height, [](double, double) { return 1.0; });
  const float range = slope_range(image);
  for (const FilterKind kind : kinds) {
    const FilterOptions options{.kind = kind,
                                .sigma = GetParam(),
                                .noise_sigma = 0.4F * GetParam(),
                                .amount = kind == FilterKind::Gaussian ? 1.0F : 0.75F,
                                .border = Border::Wrap};
    const SlopeImage expected = wave_slopes(
        width, height, [&](double kx, double ky) { return exact_response(options, kx, ky); });
    const SlopeImage out = filtered(image, options);
    EXPECT_LT(largest_difference(out, expected), 1e-4F * range)
        << name_of(kind) << " sigma " << GetParam();
    if (slope_range(expected) > 1e-2F * range) {
      EXPECT_LT(wave_curl_share(out), 1e-6) << name_of(kind) << " sigma " << GetParam();
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Sigmas, FilterSigma,
                         testing::ValuesIn(sanitized ? std::vector{0.5F, 2.5F, 8.0F, 70.0F}
                                                     : std::vector{0.5F, 1.0F, 1.7F, 2.5F, 4.0F,
                                                                   5.0F, 6.0F, 8.0F, 16.0F, 32.0F,
                                                                   64.0F, 70.0F, 100.0F}));

// A Gaussian bump on a plain: the filtered height is known, and the border sees none of it.
TEST_P(FilterSigma, FiltersTheHeightOfABump) {
  constexpr int size = 400;
  constexpr double bump = 15.0;
  const double sigma = static_cast<double>(GetParam());
  if (sigma < 1.0) return;
  const auto slopes = [&](double variance) {
    SlopeImage image(size, size);
    for (int y = 0; y < size; ++y) {
      for (int x = 0; x < size; ++x) {
        const double dx = x - 200.3;
        const double dy = y - 199.6;
        const double z =
            30.0 * bump * bump / variance * std::exp(-0.5 * (dx * dx + dy * dy) / variance);
        image(x, y) = {static_cast<float>(-z * dx / variance),
                       static_cast<float>(z * dy / variance)};
      }
    }
    return image;
  };
  const SlopeImage image = slopes(bump * bump);
  const SlopeImage low = slopes(bump * bump + sigma * sigma);
  const float range = slope_range(image);
  EXPECT_LT(largest_difference(filtered(image, {.sigma = GetParam()}), low), 1e-4F * range);
  SlopeImage high(size, size);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) high(x, y) = image(x, y) - low(x, y);
  }
  EXPECT_LT(largest_difference(filtered(image, {.kind = FilterKind::HighPass, .sigma = GetParam()}),
                               high),
            1e-4F * range);
}

/// Slopes of random heights at the corners of pixels that repeat: all frequencies, no curl.
SlopeImage rough_surface(int size) {
  const auto height = [&](int x, int y) {
    return static_cast<double>(noise(x % size, y % size, 9));
  };
  SlopeImage image(size, size);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const double a = height(x, y);
      const double b = height(x + 1, y);
      const double c = height(x, y + 1);
      const double d = height(x + 1, y + 1);
      image(x, y) = {static_cast<float>(0.5 * (b - a + d - c)),
                     static_cast<float>(0.5 * (a - c + b - d))};
    }
  }
  return image;
}

// Wide Gaussians see few points: what they let through of the finest frequencies would show here as
// curl. The period is so long that sigma 100 leaves more of it than rounding.
TEST_P(FilterSigma, KeepsARoughSurfaceASurface) {
  const SlopeImage image = rough_surface(256);
  const CurlOptions wrap{.border = Border::Wrap};
  ASSERT_LT(curl_share(image, {}, wrap), 1e-12);
  for (const FilterKind kind : kinds) {
    FilterOptions options = options_of(kind, GetParam(), Border::Wrap);
    options.noise_sigma = 0.4F * GetParam();
    EXPECT_LT(curl_share(filtered(image, options), {}, wrap), 1e-6)
        << name_of(kind) << " sigma " << GetParam();
  }
}

TEST(Filter, AmountsOfTheLaplacianMeanTheSameAtEveryScale) {
  for (const float sigma : {1.0F, 2.0F, 4.0F, 12.0F, 30.0F}) {
    double peak = 0.0;
    for (int waves = 1; waves < 128; ++waves) {
      const double k = 6.283185307179586 * waves / 256.0;
      SlopeImage line(256, 1);
      for (int x = 0; x < 256; ++x) line(x, 0) = {static_cast<float>(std::cos(k * x)), 0.0F};
      const SlopeImage out =
          filtered(line, options_of(FilterKind::LaplacianOfGaussian, sigma, Border::Wrap));
      peak = std::max(peak, static_cast<double>(out(0, 0).x()));
    }
    EXPECT_NEAR(peak, 2.0 / std::exp(1.0), 0.02) << sigma;
  }
}

TEST(Filter, IsSmoothAndSharpenWhereThoseSuffice) {
  const SlopeImage image = noise_image(90, 70);
  SlopeImage expected(90, 70);
  smooth(image, {}, expected, image.rect(), {.sigma = 3.0F}, Border::Mirror);
  EXPECT_TRUE(same_bits(filtered(image, {.sigma = 3.0F, .border = Border::Mirror}), expected));
  sharpen(image, {}, expected, image.rect(), {.sigma = 3.0F, .amount = 2.0F});
  EXPECT_TRUE(same_bits(
      filtered(image, {.kind = FilterKind::Unsharp, .sigma = 3.0F, .amount = 2.0F}), expected));
  sharpen(image, {}, expected, image.rect(), {.sigma = 3.0F, .noise_sigma = 1.0F});
  EXPECT_TRUE(same_bits(filtered(image, options_of(FilterKind::EdgeEnhance, 3.0F)), expected));
}

TEST(Filter, NeutralOptionsLeaveTheInput) {
  SlopeImage image = noise_image(50, 40);
  image(3, 4) = {-0.0F, 0.0F};
  const auto keeps = [&](const FilterOptions& options) {
    const SlopeImage out = filtered(image, options);
    return same_bits(out, image) && std::signbit(out(3, 4).x());
  };
  EXPECT_TRUE(keeps({}));
  EXPECT_TRUE(keeps({.kind = FilterKind::Unsharp, .sigma = 2.0F, .amount = 0.0F}));
  EXPECT_TRUE(keeps({.kind = FilterKind::Unsharp}));
  EXPECT_TRUE(keeps({.kind = FilterKind::EdgeEnhance, .sigma = 2.0F, .amount = 0.0F}));
  EXPECT_TRUE(keeps({.kind = FilterKind::Scale}));
  EXPECT_FALSE(keeps({.kind = FilterKind::Scale, .amount = 0.5F}));
}

TEST(Filter, ExtractingFiltersTakeTheShapeAway) {
  const SlopeImage ramp(120, 80, Vec2f(0.3F, -1.7F));
  const SlopeImage flat(120, 80, Vec2f::Zero());
  for (const FilterKind kind :
       {FilterKind::HighPass, FilterKind::BandPass, FilterKind::LaplacianOfGaussian}) {
    for (const float sigma : {1.5F, 3.0F, 20.0F}) {
      EXPECT_TRUE(same_bits(filtered(ramp, options_of(kind, sigma)), flat)) << name_of(kind);
    }
    const FilterOptions none{.kind = kind};
    EXPECT_TRUE(same_bits(filtered(noise_image(120, 80), none), flat)) << name_of(kind);
  }
}

TEST(Filter, WhatTilesKeepsTiling) {
  const SlopeImage image = noise_image(61, 47);
  const MaskImage valid = noise_mask(61, 47);
  for (const FilterKind kind : kinds) {
    for (const float sigma : {1.6F, 4.0F, 12.0F}) {
      const FilterOptions options = options_of(kind, sigma, Border::Wrap);
      for (const bool masked : {false, true}) {
        const MaskImage moved = rolled(valid, 17, 29);
        const SlopeImage a =
            filtered(rolled(image, 17, 29), options, masked ? moved.view() : MaskView{});
        const SlopeImage b =
            rolled(filtered(image, options, masked ? valid.view() : MaskView{}), 17, 29);
        // Of the slope range, 2; see SmoothBorders.
        EXPECT_LE(largest_difference(a, b), sigma <= 4.0F ? 0.0F : 1e-4F * 2.0F)
            << name_of(kind) << sigma;
      }
    }
  }
}

TEST(Filter, ARegionGivesThePixelsOfTheWholeAndReadsOnlyItsReach) {
  const SlopeImage image = noise_image(170, 150);
  for (const Border border : {Border::Clamp, Border::Mirror, Border::Wrap}) {
    for (const FilterKind kind : kinds) {
      for (const float sigma : {1.7F, 4.0F, 6.0F}) {
        const FilterOptions options = options_of(kind, sigma, border);
        const SlopeImage whole = filtered(image, options);
        for (const Rect& region : {Rect{60, 50, 90, 70}, Rect{0, 140, 30, 150}}) {
          SlopeImage part(170, 150, Vec2f::Constant(9.0F));
          EXPECT_EQ(filter(image, {}, part, region, options), region);
          EXPECT_TRUE(same_bits(cut(whole, region), cut(part, region)))
              << name_of(kind) << sigma << name_of(border);
        }
        // Other values beyond the reach change nothing.
        const Rect region = {80, 70, 84, 74};
        const Rect read = grow(region, reach(options));
        SlopeImage other = image;
        for (int y = 0; y < 150; ++y) {
          for (int x = 0; x < 170; ++x) {
            if (!read.contains(x, y)) other(x, y) = Vec2f::Constant(1e30F);
          }
        }
        SlopeImage a(170, 150);
        SlopeImage b(170, 150);
        filter(image, {}, a, region, options);
        filter(other, {}, b, region, options);
        EXPECT_TRUE(same_bits(cut(a, region), cut(b, region))) << name_of(kind) << sigma;
      }
    }
  }
}

TEST(Filter, InvalidPixelsDoNotCountAndKeepTheirSlopes) {
  constexpr int size = 100;
  SlopeImage image(size, size, Vec2f(0.25F, -0.5F));
  MaskImage valid(size, size, 1.0F);
  for (int y = 0; y < size; ++y) {
    for (int x = 60; x < size; ++x) {
      valid(x, y) = 0.0F;
      image(x, y) = Vec2f::Constant(std::numeric_limits<float>::quiet_NaN());
    }
  }
  for (const FilterKind kind : kinds) {
    for (const float sigma : {1.5F, 3.0F, 10.0F}) {
      const SlopeImage out = filtered(image, options_of(kind, sigma), valid);
      const double gain = exact_response(options_of(kind, sigma), 0.0, 0.0);
      for (int x = 0; x < 60; ++x) {
        EXPECT_NEAR(out(x, 50).x(), 0.25 * gain, 1e-5) << name_of(kind) << sigma << " " << x;
      }
      if (kind != FilterKind::Gaussian) {
        EXPECT_TRUE(std::isnan(out(60, 50).x()));
      }
    }
  }
}

TEST(Filter, TheNumberOfThreadsChangesNothingNorDoesWorkingInPlace) {
  const SlopeImage image = noise_image(201, 133);
  for (const FilterKind kind : kinds) {
    for (const float sigma : {2.0F, 3.0F, 11.0F}) {
      const FilterOptions options = options_of(kind, sigma);
      const SlopeImage many = filtered(image, options);
      const ThreadLimit limit(1);
      SlopeImage one = image;
      filter(one, {}, one, one.rect(), options);
      EXPECT_TRUE(same_bits(many, one)) << name_of(kind) << sigma;
    }
  }
}

TEST(Filter, HardlyAnySigmaDoesHardlyAnything) {
  const SlopeImage image = noise_image(30, 20);
  const SlopeImage flat(30, 20, Vec2f::Zero());
  for (const float sigma : {1e-30F, 1e-3F}) {
    EXPECT_LT(largest_difference(filtered(image, {.sigma = sigma}), image), 1e-5F);
    EXPECT_LT(largest_difference(
                  filtered(image, {.kind = FilterKind::LaplacianOfGaussian, .sigma = sigma}), flat),
              1e-4F);
  }
}

TEST(Filter, TinyImages) {
  for (const FilterKind kind : kinds) {
    for (const Border border : {Border::Clamp, Border::Mirror, Border::Wrap}) {
      for (const float sigma : {1.5F, 500.0F}) {
        const FilterOptions options = options_of(kind, sigma, border);
        EXPECT_TRUE(filtered(SlopeImage(1, 1, Vec2f(1.0F, 2.0F)), options)(0, 0).allFinite());
        SlopeImage none;
        EXPECT_TRUE(filter(none, {}, none, {0, 0, 3, 3}, options).empty());
      }
    }
  }
}

TEST(Filter, RejectsWhatIsOutOfRange) {
  SlopeImage image(4, 4, Vec2f::Zero());
  for (const FilterOptions& bad :
       {FilterOptions{.sigma = nan}, FilterOptions{.sigma = -1.0F},
        FilterOptions{.noise_sigma = nan}, FilterOptions{.amount = nan},
        FilterOptions{.amount = 101.0F},
        FilterOptions{.kind = FilterKind::BandPass, .sigma = 1.0F, .noise_sigma = 1.0F},
        options_of(FilterKind::EdgeEnhance, 0.5F)}) {
    EXPECT_THROW(filter(image, {}, image, image.rect(), bad), InvalidInput);
  }
  EXPECT_NO_THROW(filter(image, {}, image, image.rect(), options_of(FilterKind::Unsharp, 0.5F)));
}

}  // namespace
}  // namespace normalshop::test
