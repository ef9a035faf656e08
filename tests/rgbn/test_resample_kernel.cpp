#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "normalshop/core/error.h"
#include "normalshop/core/random.h"
#include "normalshop/rgbn/resample_kernel.h"

namespace normalshop::test {
namespace {

Image<float> random_kernel(int width, int height) {
  Image<float> kernel(width, height);
  Random random(5);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      kernel(x, y) = static_cast<float>(random.next() % 2001U) / 1000.0F - 1.0F;
    }
  }
  return kernel;
}

/// Sum over the kernel of weight * (x^i y^j), from the middle.
double moment(KernelView kernel, int i, int j) {
  double sum = 0.0;
  for (int y = 0; y < kernel.height(); ++y) {
    for (int x = 0; x < kernel.width(); ++x) {
      sum += static_cast<double>(kernel(x, y)) * std::pow(x - kernel.width() / 2, i) *
             std::pow(y - kernel.height() / 2, j);
    }
  }
  return sum;
}

TEST(ResampleKernel, ScaleOneIsTheKernel) {
  const Image<float> kernel = random_kernel(5, 9);
  const Image<float> same = resample_kernel(kernel, 1.0F);
  ASSERT_EQ(same.rect(), kernel.rect());
  for (int y = 0; y < 9; ++y) {
    for (int x = 0; x < 5; ++x) EXPECT_EQ(same(x, y), kernel(x, y));
  }
}

TEST(ResampleKernel, ScaleNothingIsTheSum) {
  const Image<float> kernel = random_kernel(5, 9);
  for (const float scale : {0.0F, 1e-30F}) {
    const Image<float> sum = resample_kernel(kernel, scale);
    ASSERT_EQ(sum.rect(), (Rect{0, 0, 1, 1}));
    EXPECT_NEAR(static_cast<double>(sum(0, 0)), moment(kernel, 0, 0), 1e-6);
  }
}

TEST(ResampleKernel, OneWeightBecomesATent) {
  const Image<float> tent = resample_kernel(Image<float>(1, 1, 9.0F), 3.0F);
  ASSERT_EQ(tent.width(), 5);
  ASSERT_EQ(tent.height(), 5);
  for (int y = 0; y < 5; ++y) {
    for (int x = 0; x < 5; ++x) {
      const float expected = static_cast<float>((3 - std::abs(x - 2)) * (3 - std::abs(y - 2)));
      EXPECT_NEAR(tent(x, y), expected / 9.0F, 1e-6F);
    }
  }
}

TEST(ResampleKernel, KeepsTheSum) {
  Image<float> without_sum = random_kernel(7, 3);
  without_sum(3, 1) -= static_cast<float>(moment(without_sum, 0, 0));
  const Image<float> any = random_kernel(7, 3);
  for (const float scale : {0.1F, 0.3F, 0.77F, 1.5F, 2.25F, 10.0F, 61.3F}) {
    const Image<float> scaled = resample_kernel(any, scale);
    EXPECT_EQ(scaled.width() % 2, 1);
    EXPECT_EQ(scaled.height() % 2, 1);
    EXPECT_NEAR(moment(scaled, 0, 0), moment(any, 0, 0), 2e-6) << scale;
    EXPECT_NEAR(moment(resample_kernel(without_sum, scale), 0, 0), 0.0, 2e-6) << scale;
  }
}

/// Places grow with the scale; a tent as long as a pixel on each side adds a sixth of its square.
TEST(ResampleKernel, KeepsPlaceAndShape) {
  Image<float> kernel(21, 21);
  for (int y = 0; y < 21; ++y) {
    for (int x = 0; x < 21; ++x) {
      const auto square = static_cast<float>((x - 12) * (x - 12) + (y - 9) * (y - 9));
      kernel(x, y) = std::exp(-0.5F * square / 4.0F);
    }
  }
  const double sum = moment(kernel, 0, 0);
  const double variance = moment(kernel, 2, 0) / sum - std::pow(moment(kernel, 1, 0) / sum, 2);
  for (const float scale : {1.5F, 2.5F, 7.0F}) {
    const Image<float> scaled = resample_kernel(kernel, scale);
    const double s = static_cast<double>(scale);
    const double x = moment(scaled, 1, 0) / sum;
    EXPECT_NEAR(x, 2.0 * s, 0.02 * s);
    EXPECT_NEAR(moment(scaled, 0, 1) / sum, -s, 0.02 * s);
    const double expected = s * s * (variance + 1.0 / 6.0);
    EXPECT_NEAR(moment(scaled, 2, 0) / sum - x * x, expected, 0.03 * expected) << scale;
  }
}

TEST(ResampleKernel, SymmetryStays) {
  Image<float> kernel(3, 1);
  kernel(0, 0) = -1.0F;
  kernel(1, 0) = 0.0F;
  kernel(2, 0) = 1.0F;
  for (const float scale : {0.4F, 1.3F, 6.7F}) {
    const Image<float> scaled = resample_kernel(kernel, scale);
    for (int y = 0; y < scaled.height(); ++y) {
      for (int x = 0; x < scaled.width(); ++x) {
        EXPECT_EQ(scaled(x, y), -scaled(scaled.width() - 1 - x, y)) << scale;
        EXPECT_EQ(scaled(x, y), scaled(x, scaled.height() - 1 - y)) << scale;
      }
    }
  }
}

TEST(ResampleKernel, RefusesWhatIsNoKernelAndNoLength) {
  const Image<float> kernel(3, 3, 1.0F);
  EXPECT_THROW(resample_kernel(Image<float>(2, 3), 1.0F), InvalidInput);
  EXPECT_THROW(resample_kernel(Image<float>(3, 4), 1.0F), InvalidInput);
  EXPECT_THROW(resample_kernel(Image<float>(), 1.0F), InvalidInput);
  EXPECT_THROW(resample_kernel(kernel, -1.0F), InvalidInput);
  EXPECT_THROW(resample_kernel(kernel, std::numeric_limits<float>::quiet_NaN()), InvalidInput);
  EXPECT_THROW(resample_kernel(kernel, std::numeric_limits<float>::infinity()), InvalidInput);
  EXPECT_THROW(resample_kernel(kernel, 1e6F), InvalidInput);
  EXPECT_EQ(resample_kernel(kernel, 128.0F).width(), longest_resampled_kernel);
  EXPECT_THROW(resample_kernel(kernel, 128.1F), InvalidInput);
}

}  // namespace
}  // namespace normalshop::test
