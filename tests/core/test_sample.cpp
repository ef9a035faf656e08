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
