#include <cmath>
#include <limits>

#include "support/slope_fields.h"
#include <gtest/gtest.h>

#include "normalshop/core/error.h"
#include "normalshop/core/parallel.h"
#include "normalshop/core/random.h"
#include "normalshop/core/slope.h"
#include "normalshop/rgbn/sharpen.h"
#include "normalshop/rgbn/smooth.h"

namespace normalshop::test {
namespace {

class GaussianKernel : public testing::TestWithParam<float> {};

TEST_P(GaussianKernel, DeviatesLittleFromTheTrueGaussian) {
  const float sigma = GetParam();
  const int half = static_cast<int>(std::ceil(6.0F * sigma)) + 2;
  MaskImage line(2 * half + 1, 1, 0.0F);
  line(half, 0) = 1.0F;
  MaskImage out(line.width(), 1);
  smooth(line, {}, out, line.rect(), {.sigma = sigma});
  double norm = 0.0;
  for (int k = -half; k <= half; ++k) norm += std::exp(-0.5 * k * k / (sigma * sigma));
  double worst = 0.0;
  double sum = 0.0;
  for (int k = -half; k <= half; ++k) {
    const double truth = std::exp(-0.5 * k * k / (sigma * sigma));
    worst = std::max(worst, std::abs(static_cast<double>(out(half + k, 0)) * norm - truth));
    sum += static_cast<double>(out(half + k, 0));
  }
  RecordProperty("worst", std::to_string(worst));
  EXPECT_LT(worst, 3e-4);
  EXPECT_NEAR(sum, 1.0, 1e-4);  // the tails beyond the line are not in it
}

TEST_P(GaussianKernel, DeviatesLittleInThePlaneWhereverThePixelLies) {
  const double sigma = static_cast<double>(GetParam());
  if (sigma > 40.0) return;
  const int half = static_cast<int>(std::ceil(5.0 * sigma)) + 2;
  double norm = 0.0;
  for (int k = -2 * half; k <= 2 * half; ++k) norm += std::exp(-0.5 * k * k / (sigma * sigma));
  for (int place = 0; place < 8; ++place) {
    MaskImage dot(2 * half + 9, 2 * half + 9, 0.0F);
    const int x0 = half + place;
    const int y0 = half + 3 * place % 8;
    dot(x0, y0) = 1.0F;
    MaskImage out(dot.width(), dot.height());
    smooth(dot, {}, out, dot.rect(), {.sigma = GetParam()});
    double worst = 0.0;
    for (int y = 0; y < dot.height(); ++y) {
      for (int x = 0; x < dot.width(); ++x) {
        const double square = (x - x0) * (x - x0) + (y - y0) * (y - y0);
        const double truth = std::exp(-0.5 * square / (sigma * sigma));
        worst = std::max(worst, std::abs(static_cast<double>(out(x, y)) * norm * norm - truth));
      }
    }
    EXPECT_LT(worst, 3e-4) << place;
  }
}

INSTANTIATE_TEST_SUITE_P(Sigmas, GaussianKernel,
                         testing::Values(0.3F, 1.0F, 3.0F, 4.1F, 5.0F, 8.0F, 10.0F, 30.0F, 100.0F,
                                         500.0F));

TEST(Smooth, KeepsConstantSlopesToTheLastBit) {
  const Vec2f value(0.123456F, -7.654321F);
  const SlopeImage image(150, 90, value);
  const MaskImage valid(150, 90, 1.0F);
  for (const float sigma : {0.5F, 3.0F, 20.0F, 300.0F}) {
    SlopeImage out(150, 90);
    smooth(image, {}, out, image.rect(), {.sigma = sigma});
    EXPECT_TRUE(same(image, out)) << sigma;
  }
}

TEST(Smooth, SigmaZeroLeavesTheInput) {
  const SlopeImage image = noise_image(33, 17);
  SlopeImage out(33, 17);
  EXPECT_EQ(smooth(image, {}, out, {-5, 0, 100, 100}, {.sigma = 0.0F}), image.rect());
  EXPECT_TRUE(same(image, out));
}

// The smoothed slopes are the slopes of the smoothed height (thesis 2.2).
TEST(Smooth, CommutesWithTheGradient) {
  constexpr int size = 200;
  MaskImage height(size, size);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) height(x, y) = noise(x, y, 3);
  }
  const auto slopes = [&](const MaskImage& h) {
    SlopeImage s(size, size, Vec2f::Zero());
    for (int y = 1; y < size - 1; ++y) {
      for (int x = 1; x < size - 1; ++x) {
        s(x, y) = {0.5F * (h(x + 1, y) - h(x - 1, y)), 0.5F * (h(x, y - 1) - h(x, y + 1))};
      }
    }
    return s;
  };
  for (const float sigma : {2.0F, 9.0F}) {
    MaskImage low(size, size);
    smooth(height, {}, low, height.rect(), {.sigma = sigma});
    const SlopeImage expected = slopes(low);
    SlopeImage filtered(size, size);
    smooth(slopes(height), {}, filtered, height.rect(), {.sigma = sigma});
    double worst = 0.0;
    for (int y = 60; y < size - 60; ++y) {
      for (int x = 60; x < size - 60; ++x) {
        worst = std::max(worst, angle_degrees(normal_from_slope(expected(x, y)),
                                              normal_from_slope(filtered(x, y))));
      }
    }
    EXPECT_LT(worst, 1e-3) << sigma;  // degrees
  }
}

TEST(Smooth, InvalidPixelsDoNotCount) {
  constexpr int size = 120;
  SlopeImage image(size, size, Vec2f(0.25F, -0.5F));
  MaskImage valid(size, size, 1.0F);
  for (int y = 0; y < size; ++y) {
    for (int x = 50; x < size; ++x) {
      valid(x, y) = 0.0F;
      image(x, y) = Vec2f::Constant(std::numeric_limits<float>::quiet_NaN());
    }
  }
  for (const float sigma : {2.0F, 9.0F}) {
    SlopeImage out(size, size);
    smooth(image, valid, out, image.rect(), {.sigma = sigma});
    for (int x = 0; x < 50; ++x) {
      EXPECT_NEAR(out(x, 60).x(), 0.25F, 1e-6F);
      EXPECT_NEAR(out(x, 60).y(), -0.5F, 1e-6F);
    }
    EXPECT_TRUE(std::isnan(out(size - 1, 60).x()));  // nothing valid in reach: the source
  }
}

TEST(Smooth, ARegionGivesThePixelsOfTheWhole) {
  const SlopeImage image = noise_image(300, 260);
  const Rect region = {111, 97, 170, 143};
  for (const float sigma : {3.0F, 12.0F, 100.0F}) {
    SlopeImage whole(300, 260);
    SlopeImage part(300, 260, Vec2f::Constant(9.0F));
    smooth(image, {}, whole, image.rect(), {.sigma = sigma});
    EXPECT_EQ(smooth(image, {}, part, region, {.sigma = sigma}), region);
    for (int y = 0; y < 260; ++y) {
      for (int x = 0; x < 300; ++x) {
        if (region.contains(x, y)) {
          EXPECT_EQ(whole(x, y), part(x, y));
        } else {
          EXPECT_EQ(part(x, y), Vec2f(Vec2f::Constant(9.0F)));
        }
      }
    }
  }
}

TEST(Smooth, TheNumberOfThreadsChangesNothing) {
  const SlopeImage image = noise_image(301, 203);
  for (const float sigma : {4.0F, 25.0F}) {
    SlopeImage many(301, 203);
    smooth(image, {}, many, image.rect(), {.sigma = sigma});
    SlopeImage one = image;
    const ThreadLimit limit(1);
    smooth(one, {}, one, image.rect(), {.sigma = sigma});  // in place, too
    EXPECT_TRUE(same(many, one));
  }
}

TEST(Smooth, RejectsASigmaThatIsNoLength) {
  SlopeImage image(4, 4, Vec2f::Zero());
  EXPECT_THROW(smooth(image, {}, image, image.rect(), {.sigma = -1.0F}), InvalidInput);
  EXPECT_THROW(
      smooth(image, {}, image, image.rect(), {.sigma = std::numeric_limits<float>::quiet_NaN()}),
      InvalidInput);
}

TEST(Smooth, TinyImages) {
  for (const float sigma : {3.0F, 50.0F}) {
    SlopeImage image(1, 1, Vec2f(1.0F, 2.0F));
    smooth(image, {}, image, image.rect(), {.sigma = sigma});
    EXPECT_EQ(image(0, 0), Vec2f(1.0F, 2.0F));
    SlopeImage none;
    EXPECT_TRUE(smooth(none, {}, none, {0, 0, 5, 5}, {.sigma = sigma}).empty());
  }
}

/// Slope of a wave of this length after sharpening, as a factor.
double response(double wavelength, const SharpenOptions& options) {
  SlopeImage image(400, 8);
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 400; ++x) {
      const double phase = 2.0 * 3.14159265358979 * (x - 200) / wavelength;
      image(x, y) = {static_cast<float>(std::cos(phase)), 0.0F};
    }
  }
  SlopeImage out(400, 8);
  sharpen(image, {}, out, image.rect(), options);
  return static_cast<double>(out(200, 4).x());
}

TEST(Sharpen, HasTheResponseOfUnsharpMasking) {
  const auto gauss = [](double sigma, double wavelength) {
    const double w = 2.0 * 3.14159265358979 / wavelength;
    return std::exp(-0.5 * sigma * sigma * w * w);
  };
  for (const double wavelength : {6.0, 20.0, 50.0}) {
    EXPECT_NEAR(response(wavelength, {.sigma = 4.0F, .amount = 1.5F}),
                1.0 + 1.5 * (1.0 - gauss(4.0, wavelength)), 2e-3);
    EXPECT_NEAR(response(wavelength, {.sigma = 4.0F, .amount = 1.5F, .noise_sigma = 1.0F}),
                1.0 + 1.5 * (gauss(1.0, wavelength) - gauss(4.0, wavelength)), 2e-3);
  }
}

TEST(Sharpen, LimitingCases) {
  const SlopeImage image = noise_image(40, 30);
  SlopeImage out(40, 30);
  sharpen(image, {}, out, image.rect(), {.sigma = 3.0F, .amount = 0.0F});
  EXPECT_TRUE(same(image, out));
  sharpen(image, {}, out, image.rect(), {.sigma = 0.0F});
  EXPECT_TRUE(same(image, out));
  EXPECT_THROW(sharpen(image, {}, out, image.rect(), {.sigma = 1.0F, .noise_sigma = 1.0F}),
               InvalidInput);
}

}  // namespace
}  // namespace normalshop::test
