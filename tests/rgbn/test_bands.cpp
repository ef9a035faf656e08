#include <cmath>
#include <limits>

#include "rgbn/filter_fixtures.h"
#include <gtest/gtest.h>

#include "normalshop/core/error.h"
#include "normalshop/core/parallel.h"
#include "normalshop/rgbn/bands.h"
#include "normalshop/rgbn/smooth.h"

namespace normalshop::test {
namespace {

SlopeImage low_pass(const SlopeImage& image, float sigma, Border border) {
  SlopeImage out(image.width(), image.height());
  smooth(image, {}, out, image.rect(), {.sigma = sigma}, border);
  return out;
}

SlopeImage equalized(const SlopeImage& image, std::vector<float> gains,
                     const EqualizeOptions& options = {}, MaskView valid = {}) {
  SlopeImage out(image.width(), image.height());
  equalize(image, valid, gains, out, image.rect(), options);
  return out;
}

TEST(Split, BaseAndDetailsAreTheSource) {
  const SlopeImage image = noise_image(120, 90);
  for (const float sigma : {0.5F, 3.0F, 20.0F}) {
    SlopeImage base(120, 90);
    SlopeImage details(120, 90);
    EXPECT_EQ(split(image, {}, base, details, {-3, 0, 200, 90}, {.sigma = sigma}), image.rect());
    EXPECT_TRUE(same_bits(base, low_pass(image, sigma, Border::Clamp)));
    for (int y = 0; y < 90; ++y) {
      for (int x = 0; x < 120; ++x) {
        for (int c = 0; c < 2; ++c) {
          const float sum = base(x, y)[c] + details(x, y)[c];
          EXPECT_LE(std::abs(sum - image(x, y)[c]),
                    6e-8F * (std::abs(base(x, y)[c]) + std::abs(details(x, y)[c])));
        }
      }
    }
  }
}

TEST(Split, SigmaZeroHasNoDetails) {
  const SlopeImage image = noise_image(20, 10);
  SlopeImage base(20, 10);
  SlopeImage details(20, 10);
  split(image, {}, base, details, image.rect(), {.sigma = 0.0F});
  EXPECT_TRUE(same_bits(base, image));
  EXPECT_TRUE(same_bits(details, SlopeImage(20, 10, Vec2f::Zero())));
}

TEST(Split, WhatIsNotValidIsBase) {
  SlopeImage image(40, 30, Vec2f(0.5F, 0.25F));
  MaskImage valid(40, 30, 1.0F);
  valid(20, 15) = 0.0F;
  image(20, 15) = Vec2f::Constant(7.0F);
  SlopeImage details(40, 30);
  split(image, valid, image, details, image.rect(), {.sigma = 2.0F});  // the base in place
  EXPECT_EQ(image(20, 15), Vec2f(Vec2f::Constant(7.0F)));
  EXPECT_EQ(details(20, 15), Vec2f(Vec2f::Zero()));
  EXPECT_LT(details(21, 15).norm(), 1e-6F);
}

TEST(Split, RejectsBadSigma) {
  SlopeImage image(4, 4, Vec2f::Zero());
  SlopeImage details(4, 4);
  for (const float sigma : {nan, -1.0F, std::numeric_limits<float>::infinity()}) {
    EXPECT_THROW(split(image, {}, image, details, image.rect(), {.sigma = sigma}), InvalidInput);
  }
}

TEST(Split, ARegionGivesThePixelsOfTheWhole) {
  const SlopeImage image = noise_image(80, 60);
  SlopeImage base(80, 60);
  SlopeImage details(80, 60);
  const SplitOptions options{.sigma = 3.0F, .border = Border::Wrap};
  split(image, {}, base, details, image.rect(), options);
  SlopeImage part_base(80, 60, Vec2f::Constant(9.0F));
  SlopeImage part(80, 60, Vec2f::Constant(9.0F));
  const Rect region = {0, 40, 30, 60};
  EXPECT_EQ(split(image, {}, part_base, part, region, options), region);
  EXPECT_TRUE(same_bits(cut(details, region), cut(part, region)));
  EXPECT_TRUE(same_bits(cut(base, region), cut(part_base, region)));
  EXPECT_EQ(part(40, 50), Vec2f(Vec2f::Constant(9.0F)));
  EXPECT_EQ(reach(options), 12);
}

TEST(Bands, NeutralValuesLeaveTheSource) {
  SlopeImage image = noise_image(50, 40);
  image(5, 5) = {-0.0F, 0.0F};
  const SlopeImage base = low_pass(image, 3.0F, Border::Clamp);
  SlopeImage other(50, 40, Vec2f::Constant(nan));
  const MaskImage zero(50, 40, 0.0F);
  SlopeImage out(50, 40);
  const auto kept = [&] { return same_bits(out, image) && std::signbit(out(5, 5).x()); };
  scale_band(image, {image, base}, {}, 1.0F, out, image.rect());
  EXPECT_TRUE(kept());
  scale_band(image, {image, base}, zero, 3.0F, out, image.rect());
  EXPECT_TRUE(kept());
  transplant_band(image, {image, base}, {other, other}, {}, 0.0F, out, image.rect());
  EXPECT_TRUE(kept());
  transplant_band(image, {image, base}, {other, other}, zero, 1.0F, out, image.rect());
  EXPECT_TRUE(kept());
}

TEST(Bands, GainZeroTakesTheBandAway) {
  const SlopeImage image = noise_image(50, 40);
  const SlopeImage base = low_pass(image, 3.0F, Border::Clamp);
  SlopeImage out(50, 40);
  scale_band(image, {image, base}, {}, 0.0F, out, image.rect());
  EXPECT_LT(largest_difference(out, base), 3e-7F);
  scale_band(image, {base, {}}, {}, 0.0F, out, image.rect());
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 50; ++x) EXPECT_EQ(out(x, y), Vec2f(image(x, y) - base(x, y)));
  }
}

// Details of one texture on the shape of another, by any base.
TEST(Bands, TransplantsDetails) {
  const SlopeImage shape = wave_slopes(
      128, 128, [](double kx, double ky) { return std::hypot(kx, ky) < 0.3 ? 1.0 : 0.0; });
  const SlopeImage details = wave_slopes(
      128, 128, [](double kx, double ky) { return std::hypot(kx, ky) < 0.3 ? 0.0 : 1.0; });
  SlopeImage donor(128, 128);
  SlopeImage donor_base(128, 128, Vec2f(0.5F, -2.0F));
  for (int y = 0; y < 128; ++y) {
    for (int x = 0; x < 128; ++x) donor(x, y) = details(x, y) + donor_base(x, y);
  }
  MaskImage half(128, 128, 1.0F);
  for (int y = 0; y < 128; ++y) {
    for (int x = 0; x < 64; ++x) half(x, y) = 0.0F;
  }
  SlopeImage out(128, 128);
  const Rect region = {10, 0, 128, 128};
  EXPECT_EQ(transplant_band(shape, {shape, shape}, {donor, donor_base}, half, 0.5F, out, region),
            region);
  for (int x = 10; x < 128; ++x) {
    const Vec2f added = x < 64 ? Vec2f(Vec2f::Zero()) : Vec2f(0.5F * details(x, 77));
    EXPECT_LT((out(x, 77) - shape(x, 77) - added).norm(), 2e-6F);
  }
}

TEST(Bands, RejectBadNumbers) {
  SlopeImage image(4, 4, Vec2f::Zero());
  EXPECT_THROW(scale_band(image, {image, {}}, {}, nan, image, image.rect()), InvalidInput);
  EXPECT_THROW(transplant_band(image, {image, {}}, {image, {}}, {}, nan, image, image.rect()),
               InvalidInput);
  SlopeImage none;
  EXPECT_TRUE(scale_band(none, {none, {}}, {}, 2.0F, none, {0, 0, 9, 9}).empty());
}

TEST(Equalize, GainsOfOneLeaveTheInput) {
  SlopeImage image = noise_image(60, 50);
  image(5, 5) = {-0.0F, 0.0F};
  for (const std::size_t count : {0U, 1U, 5U, 16U}) {
    const SlopeImage out = equalized(image, std::vector<float>(count, 1.0F));
    EXPECT_TRUE(same_bits(out, image)) << count;
    EXPECT_TRUE(std::signbit(out(5, 5).x()));
  }
}

TEST(Equalize, HasTheResponseOfItsFormula) {
  constexpr int width = 256;
  constexpr int height = 200;
  const SlopeImage image = wave_slopes(width, height, [](double, double) { return 1.0; });
  const std::vector<float> gains = {0.0F, 1.5F, 1.5F, 0.25F, -1.0F};
  const EqualizeOptions options{.sigma = 1.0F, .base_gain = 0.5F, .border = Border::Wrap};
  const auto response = [&](double kx, double ky) {
    const auto level = [&](std::size_t i) {
      if (i == 0) return 1.0;
      const double sigma = std::ldexp(1.0, static_cast<int>(i) - 1);
      return gauss_response(sigma, kx) * gauss_response(sigma, ky);
    };
    double sum = 0.5 * level(5);
    for (std::size_t i = 0; i < 5; ++i) {
      sum += static_cast<double>(gains[i]) * (level(i) - level(i + 1));
    }
    return sum;
  };
  const SlopeImage out = equalized(image, gains, options);
  EXPECT_LT(largest_difference(out, wave_slopes(width, height, response)),
            1e-4F * slope_range(image));
  EXPECT_LT(wave_curl_share(out), 1e-6);
  EXPECT_EQ(reach(options, 5), reach(SmoothOptions{.sigma = 16.0F}));
}

TEST(Equalize, ScalesByEqualGains) {
  const SlopeImage image = noise_image(40, 30);
  const SlopeImage out = equalized(image, {2.0F, 2.0F, 2.0F}, {.base_gain = 2.0F});
  for (int x = 0; x < 40; ++x) EXPECT_EQ(out(x, 7), Vec2f(2.0F * image(x, 7)));
}

TEST(Equalize, TilesAndTakesRegionsAndThreads) {
  const SlopeImage image = noise_image(61, 47);
  const MaskImage valid = noise_mask(61, 47);
  const std::vector<float> gains = {2.0F, 0.5F, 1.0F};  // up to sigma 4: direct filters
  const EqualizeOptions options{.border = Border::Wrap};
  const SlopeImage whole = equalized(image, gains, options, valid);
  const MaskImage moved = rolled(valid, 17, 29);
  EXPECT_TRUE(
      same_bits(equalized(rolled(image, 17, 29), gains, options, moved), rolled(whole, 17, 29)));
  const ThreadLimit limit(1);
  SlopeImage part = image;
  const Rect region = {30, 0, 61, 20};
  EXPECT_EQ(equalize(part, valid, gains, part, region, options), region);
  EXPECT_TRUE(same_bits(cut(part, region), cut(whole, region)));
  EXPECT_TRUE(same_bits(cut(part, {0, 0, 30, 47}), cut(image, {0, 0, 30, 47})));
  for (int y = 0; y < 47; ++y) {
    for (int x = 0; x < 61; ++x) {
      if (valid(x, y) == 0.0F) {
        EXPECT_EQ(whole(x, y), image(x, y));
      }
    }
  }
}

TEST(Equalize, RejectsWhatIsOutOfRange) {
  const SlopeImage image(4, 4, Vec2f::Zero());
  EXPECT_THROW(equalized(image, {nan}), InvalidInput);
  EXPECT_THROW(equalized(image, {101.0F}), InvalidInput);
  EXPECT_THROW(equalized(image, std::vector<float>(17, 1.0F)), InvalidInput);
  EXPECT_THROW(equalized(image, {1.0F}, {.sigma = 0.0F}), InvalidInput);
  EXPECT_THROW(equalized(image, {1.0F}, {.sigma = nan}), InvalidInput);
  EXPECT_THROW(equalized(image, {1.0F}, {.base_gain = nan}), InvalidInput);
  const SlopeImage dot(1, 1, Vec2f(1.0F, 2.0F));
  EXPECT_EQ(equalized(dot, {3.0F, 1.0F})(0, 0), dot(0, 0));  // one pixel has no details
  SlopeImage none;
  const std::vector<float> gains = {0.0F};
  EXPECT_TRUE(equalize(none, {}, gains, none, {0, 0, 9, 9}).empty());
}

}  // namespace
}  // namespace normalshop::test
