#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "normalshop/core/sample.h"

namespace normalshop {
namespace {

float quadratic(float x, float y) {
  return 0.3F * x * x - 0.2F * x * y + 0.1F * y * y + x - 2.0F * y + 1.0F;
}

Image<float> sampled(float (*f)(float, float)) {
  Image<float> image(9, 7);
  for (int y = 0; y < 7; ++y) {
    for (int x = 0; x < 9; ++x) image(x, y) = f(static_cast<float>(x), static_cast<float>(y));
  }
  return image;
}

TEST(SampleBilinear, IsExactForPlanes) {
  const Image<float> image = sampled([](float x, float y) { return 2.0F * x - 3.0F * y + 1.0F; });
  EXPECT_NEAR(sample_bilinear(image.view(), 3.25F, 4.75F), 2 * 3.25F - 3 * 4.75F + 1, 1e-5F);
  EXPECT_EQ(sample_bilinear(image.view(), 8.0F, 6.0F), image(8, 6));
}

TEST(SampleBilinear, ContinuesTheBorder) {
  const Image<float> image = sampled(quadratic);
  EXPECT_EQ(sample_bilinear(image.view(), -5.0F, 3.0F), image(0, 3));
  EXPECT_EQ(sample_bilinear(image.view(), 4.0F, 99.0F), image(4, 6));
}

TEST(SampleClamped, ReadsTheFirstPixelAtPlacesThatAreNoNumbers) {
  const Image<float> image = sampled(quadratic);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  EXPECT_EQ(sample_bilinear(image.view(), nan, 3.0F), image(0, 3));
  EXPECT_EQ(sample_bilinear(image.view(), 4.0F, nan), image(4, 0));
  EXPECT_EQ(sample_bicubic(image.view(), nan, nan), image(0, 0));
  EXPECT_EQ(sample_bilinear(image.view(), infinity, -infinity), image(8, 0));
}

TEST(SampleBicubic, IsExactForQuadraticsInside) {
  const Image<float> image = sampled(quadratic);
  for (const float x : {1.0F, 2.3F, 4.5F, 6.9F}) {
    for (const float y : {1.0F, 2.5F, 4.8F}) {
      EXPECT_NEAR(sample_bicubic(image.view(), x, y), quadratic(x, y), 1e-4F);
    }
  }
}

TEST(SampleBicubic, WorksOnOnePixel) {
  const SlopeImage one(1, 1, Vec2f(0.5F, -2.0F));
  EXPECT_NEAR((sample_bicubic(one.view(), 0.4F, 3.0F) - Vec2f(0.5F, -2.0F)).norm(), 0.0F, 1e-6F);
}

/// Sines with a period of the image's size, so that there is no border.
float waves(float x, float y) {
  return std::sin(6.2831853F * x / 9.0F) + std::cos(6.2831853F * y / 7.0F);
}

TEST(SampleRepeated, ReadsTheSameOnePeriodFurther) {
  const Image<float> image = sampled(quadratic);
  const auto linear = [&](float x, float y) {
    return sample_bilinear<float, Border::Wrap>(image, x, y);
  };
  const auto cubic = [&](float x, float y) {
    return sample_bicubic<float, Border::Wrap>(image, x, y);
  };
  for (const float x : {0.0F, 0.25F, 4.5F, 8.0F, 8.75F}) {
    for (const float y : {0.0F, 3.5F, 6.0F, 6.5F}) {
      EXPECT_EQ(linear(x, y), linear(x + 9.0F, y - 14.0F));
      EXPECT_EQ(cubic(x, y), cubic(x - 27.0F, y + 7.0F));
    }
  }
  EXPECT_EQ(linear(3.0F, 2.0F), image(3, 2));
  EXPECT_EQ(cubic(-6.0F, 9.0F), image(3, 2));
  EXPECT_EQ(linear(8.5F, 0.0F), 0.5F * (image(8, 0) + image(0, 0)));
}

TEST(SampleRepeated, HasNoBorder) {
  const Image<float> image = sampled(waves);
  double inside = 0.0;
  double across = 0.0;
  for (int k = 0; k < 100; ++k) {
    const float t = static_cast<float>(k) / 100.0F;
    const auto error = [&](float x, float y) {
      return static_cast<double>(
          std::abs(sample_bicubic<float, Border::Wrap>(image, x, y) - waves(x, y)));
    };
    inside = std::max(inside, error(2.0F + 4.0F * t, 3.0F));
    across = std::max(across, error(7.0F + 3.0F * t, 3.0F));
  }
  EXPECT_LT(inside, 0.02);
  EXPECT_LT(across, 0.02);
}

TEST(SampleRepeated, SurvivesPlacesThatAreNone) {
  const Image<float> image = sampled(quadratic);
  for (const float x : {1e30F, -1e30F, std::numeric_limits<float>::quiet_NaN(), -1e-30F}) {
    EXPECT_TRUE(std::isfinite(sample_bilinear<float, Border::Wrap>(image, x, x)));
    EXPECT_TRUE(std::isfinite(sample_bicubic<float, Border::Wrap>(image, x, x)));
  }
}

TEST(CubicWeights, SumToOne) {
  for (int i = 0; i < 100; ++i) {
    const auto w = cubic_weights(static_cast<float>(i) / 100.0F);
    EXPECT_NEAR(w[0] + w[1] + w[2] + w[3], 1.0F, 1e-6F);
  }
}

TEST(Smoothstep, RisesFromZeroToOne) {
  EXPECT_EQ(smoothstep(1.0F, 3.0F, 0.5F), 0.0F);
  EXPECT_EQ(smoothstep(1.0F, 3.0F, 2.0F), 0.5F);
  EXPECT_EQ(smoothstep(1.0F, 3.0F, 9.0F), 1.0F);
}

}  // namespace
}  // namespace normalshop
