#include <cmath>
#include <cstring>
#include <limits>

#include "rgbn/filter_fixtures.h"
#include "support/relief.h"
#include <gtest/gtest.h>

#include "normalshop/core/error.h"
#include "normalshop/core/parallel.h"
#include "normalshop/rgbn/domain_transform.h"

namespace normalshop::test {
namespace {

SlopeImage transform_filtered(const SlopeImage& slopes, const DomainTransformOptions& options) {
  SlopeImage out(slopes.width(), slopes.height());
  domain_transform({slopes, {}, {}}, {out, {}}, out.rect(), options);
  return out;
}

// 1.2 was the aim.
TEST(DomainTransform, TakesNoiseOffAndLeavesEdges) {
  const auto left = [](int rolls) {
    return error_left(5.0F, [&](const SlopeImage& noisy, SlopeImage& out) {
      out = transform_filtered(noisy, {.rolls = rolls});
    });
  };
  const double error = left(1);
  RecordProperty("degrees", std::to_string(error));
  EXPECT_LE(error, 1.2);
  EXPECT_LT(error, left(0) - 0.2);  // one roll pays
}

class DomainTransformSigma : public testing::TestWithParam<float> {};

// Where nothing differs, a dot becomes a spot of this standard deviation along both axes.
TEST_P(DomainTransformSigma, IsTheStandardDeviation) {
  const float sigma = GetParam();
  const int half = static_cast<int>(10.0F * sigma);
  const int size = 2 * half + 1;
  SlopeImage dot(size, size, Vec2f::Zero());
  dot(half, half).x() = 1.0F;
  const SlopeImage out =
      transform_filtered(dot, {.sigma_space = sigma, .sigma_normal = 0.0F, .guide_sigma = 0.0F});
  double sum = 0.0;
  double across = 0.0;
  double down = 0.0;
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const auto weight = static_cast<double>(out(x, y).x());
      sum += weight;
      across += weight * (x - half) * (x - half);
      down += weight * (y - half) * (y - half);
    }
  }
  EXPECT_NEAR(sum, 1.0, 1e-3);
  EXPECT_NEAR(std::sqrt(across / sum), sigma, 0.002F * sigma);
  EXPECT_NEAR(std::sqrt(down / sum), sigma, 0.002F * sigma);
}

INSTANTIATE_TEST_SUITE_P(Sigmas, DomainTransformSigma, testing::Values(1.0F, 3.0F, 6.0F, 15.0F));

TEST(DomainTransform, EdgesOfNormalsAndColoursStopIt) {
  SlopeImage slopes(60, 60, Vec2f(0.5F, 0.0F));
  ColorImage colors(60, 60, Vec3f(0.2F, 0.2F, 0.2F));
  for (int y = 0; y < 60; ++y) {
    for (int x = 0; x < 60; ++x) {
      if (x >= 30) slopes(x, y) = {-0.5F, 0.0F};
      if (y >= 20) colors(x, y) = {0.2F, 4000.0F, 0.2F};
    }
  }
  const auto error = [&](const DomainTransformOptions& options) {
    SlopeImage out(60, 60);
    ColorImage out_colors(60, 60);
    domain_transform({slopes, colors, {}}, {out, out_colors}, out.rect(), options);
    return Vec2f(largest_difference(slopes, out), (out_colors(10, 19) - colors(10, 19)).norm());
  };
  const Vec2f kept = error({.sigma_normal = 0.05F, .guide_sigma = 0.0F});
  EXPECT_LT(kept.x(), 1e-3F);
  EXPECT_LT(kept.y(), 1e-3F);
  const Vec2f mixed = error({.sigma_color = 0.0F, .sigma_normal = 0.0F, .guide_sigma = 0.0F});
  EXPECT_GT(mixed.x(), 0.3F);
  EXPECT_GT(mixed.y(), 1000.0F);
}

TEST(DomainTransform, KeepsConstantsToTheLastBit) {
  for (const Vec2f& value : {Vec2f(0.123456F, -7.654321F), Vec2f(31.0F, 2.0F)}) {
    const SlopeImage slopes(70, 43, value);
    const ColorImage colors(70, 43, Vec3f(0.1F, 0.7F, 12.3F));
    SlopeImage out(70, 43);
    ColorImage out_colors(70, 43);
    domain_transform({slopes, colors, {}}, {out, out_colors}, out.rect());
    EXPECT_TRUE(same_bits(slopes, out));
    EXPECT_TRUE(same_bits(colors, out_colors));
  }
}

TEST(DomainTransform, SigmaZeroLeavesTheInput) {
  SlopeImage slopes = noise_image(33, 17);
  slopes(3, 4).x() = nan;
  SlopeImage out(33, 17);
  EXPECT_EQ(domain_transform({slopes, {}, {}}, {out, {}}, {-5, 0, 100, 100}, {.sigma_space = 0.0F}),
            slopes.rect());
  EXPECT_TRUE(same_bits(slopes, out));
}

TEST(DomainTransform, NothingPassesThroughPixelsThatDoNotCount) {
  SlopeImage slopes(40, 40, Vec2f(0.25F, -0.5F));
  MaskImage valid(40, 40, 0.5F);
  for (int y = 0; y < 40; ++y) {
    for (int x = 20; x < 40; ++x) slopes(x, y) = {1.0F, 1.0F};
    slopes(20, y) = {nan, 1.0F};
    valid(19, y) = 0.0F;
    slopes(19, y) = {7.0F, 7.0F};
  }
  SlopeImage out(40, 40);
  domain_transform({slopes, {}, valid}, {out, {}}, out.rect(), {.sigma_normal = 0.0F});
  for (int x = 0; x < 40; ++x) {
    if (x == 19 || x == 20) {
      EXPECT_EQ(std::memcmp(&out(x, 7), &slopes(x, 7), sizeof(Vec2f)), 0);
    } else {
      EXPECT_LT((out(x, 7) - slopes(x, 7)).norm(), 1e-6F) << x;
    }
  }
}

TEST(DomainTransform, PixelsWeighByTheirValidity) {
  SlopeImage slopes(30, 30, Vec2f::Zero());
  MaskImage valid(30, 30, 1.0F);
  for (int y = 0; y < 30; ++y) {
    for (int x = 15; x < 30; ++x) {
      slopes(x, y) = {0.5F, 0.0F};
      valid(x, y) = 0.1F;
    }
  }
  SlopeImage all(30, 30);
  SlopeImage weighed(30, 30);
  const DomainTransformOptions options{.sigma_normal = 0.0F};
  domain_transform({slopes, {}, {}}, {all, {}}, all.rect(), options);
  domain_transform({slopes, {}, valid}, {weighed, {}}, all.rect(), options);
  EXPECT_LT(weighed(14, 15).x(), 0.3F * all(14, 15).x());
  EXPECT_GT(weighed(14, 15).x(), 0.0F);
}

TEST(DomainTransform, WhatTilesKeepsTiling) {
  const SlopeImage slopes = noise_image(50, 37);
  const DomainTransformOptions options{.sigma_normal = 3.0F, .border = Border::Wrap};
  EXPECT_LT(largest_difference(rolled(transform_filtered(slopes, options), 23, 11),
                               transform_filtered(rolled(slopes, 23, 11), options)),
            2e-4F);
  EXPECT_GT(largest_difference(transform_filtered(slopes, options),
                               transform_filtered(slopes, {.sigma_normal = 3.0F})),
            1e-2F);
}

TEST(DomainTransform, AMirroredBorderIsAMirrorImage) {
  const SlopeImage slopes = noise_image(41, 30);
  const DomainTransformOptions options{.sigma_normal = 3.0F, .border = Border::Mirror};
  const SlopeImage mirrored = transform_filtered(slopes, options);
  const SlopeImage expected = transform_filtered(surrounded(slopes, 1, Border::Mirror), options);
  for (int y = 0; y < 30; ++y) {
    for (int x = 0; x < 41; ++x)
      EXPECT_LT((mirrored(x, y) - expected(41 + x, 30 + y)).norm(), 2e-4F);
  }
}

TEST(DomainTransform, ARegionGivesThePixelsOfTheWhole) {
  const SlopeImage slopes = noise_image(300, 260);
  const Rect region = {111, 97, 170, 143};
  for (const float sigma_normal : {0.0F, 3.0F}) {
    const DomainTransformOptions options{.sigma_normal = sigma_normal};
    const SlopeImage whole = transform_filtered(slopes, options);
    SlopeImage part(300, 260, Vec2f::Constant(9.0F));
    EXPECT_EQ(domain_transform({slopes, {}, {}}, {part, {}}, region, options), region);
    for (int y = 0; y < 260; ++y) {
      for (int x = 0; x < 300; ++x) {
        if (region.contains(x, y)) {
          EXPECT_LT((whole(x, y) - part(x, y)).norm(), 2e-4F);
        } else {
          EXPECT_EQ(part(x, y), Vec2f(9.0F, 9.0F));
        }
      }
    }
  }
  SlopeImage out(300, 260);
  EXPECT_TRUE(domain_transform({slopes, {}, {}}, {out, {}}, {5, 5, 5, 9}).empty());
}

TEST(DomainTransform, TheNumberOfThreadsChangesNothing) {
  const SlopeImage slopes = noise_image(301, 203);
  for (const float guide_sigma : {0.0F, 1.0F}) {
    const DomainTransformOptions options{.guide_sigma = guide_sigma};
    const SlopeImage many = transform_filtered(slopes, options);
    SlopeImage one = slopes;
    const ThreadLimit limit(1);
    domain_transform({one, {}, {}}, {one, {}}, one.rect(), options);  // in place, too
    EXPECT_TRUE(same_bits(many, one));
  }
}

TEST(DomainTransform, RejectsOptionsOutsideTheirRanges) {
  const SlopeImage slopes(4, 4, Vec2f::Zero());
  EXPECT_THROW(transform_filtered(slopes, {.sigma_space = nan}), InvalidInput);
  EXPECT_THROW(transform_filtered(slopes, {.sigma_color = -1.0F}), InvalidInput);
  EXPECT_THROW(transform_filtered(slopes, {.sigma_normal = nan}), InvalidInput);
  EXPECT_THROW(transform_filtered(slopes, {.guide_sigma = std::numeric_limits<float>::infinity()}),
               InvalidInput);
  EXPECT_THROW(transform_filtered(slopes, {.iterations = 0}), InvalidInput);
  EXPECT_THROW(transform_filtered(slopes, {.rolls = -1}), InvalidInput);
  EXPECT_THROW(transform_filtered(slopes, {.rolls = 11}), InvalidInput);
}

TEST(DomainTransform, TinyImagesAndExtremeSigmas) {
  for (const Border border : {Border::Clamp, Border::Mirror, Border::Wrap}) {
    for (const float sigma : {1e-9F, 1e6F}) {
      const DomainTransformOptions options{
          .sigma_space = sigma, .sigma_normal = 0.0F, .border = border};
      SlopeImage one(1, 1, Vec2f(0.0F, 0.0F));
      EXPECT_EQ(transform_filtered(one, options)(0, 0), Vec2f(0.0F, 0.0F));
      const SlopeImage slopes = noise_image(7, 5);
      const SlopeImage out = transform_filtered(slopes, options);
      EXPECT_TRUE(out(3, 3).allFinite());
      if (sigma < 1.0F) {
        EXPECT_LT(largest_difference(slopes, out), 1e-6F);
      }
    }
  }
  SlopeImage none;
  EXPECT_TRUE(domain_transform({none, {}, {}}, {none, {}}, {0, 0, 5, 5}).empty());
}

}  // namespace
}  // namespace normalshop::test
