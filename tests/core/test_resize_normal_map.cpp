#include <cmath>
#include <cstring>

#include <gtest/gtest.h>

#include "normalshop/core/error.h"
#include "normalshop/core/normal_map.h"
#include "normalshop/core/parallel.h"
#include "normalshop/core/slope.h"

namespace normalshop {
namespace {

constexpr float pi = 3.14159265F;

/// Slopes of waves that fit the map, at a point of the unit square.
Vec2f wave(float u, float v) {
  return {0.8F * std::sin(2.0F * pi * (2.0F * u + v)),
          0.5F * std::cos(2.0F * pi * 3.0F * v) - 0.2F};
}

NormalMap waves(int width, int height, CodeType type = CodeType::F32) {
  NormalMap map = flat_normal_map(width, height, type);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      map.set_normal(
          x, y,
          normal_from_slope(wave((static_cast<float>(x) + 0.5F) / static_cast<float>(width),
                                 (static_cast<float>(y) + 0.5F) / static_cast<float>(height))));
    }
  }
  return map;
}

double largest_error(const NormalMap& map, const NormalMap& truth, int border) {
  double largest = 0.0;
  for (int y = border; y < map.height() - border; ++y) {
    for (int x = border; x < map.width() - border; ++x) {
      largest = std::max(largest, angle_degrees(map.normal(x, y), truth.normal(x, y)));
    }
  }
  return largest;
}

TEST(ResizeNormalMap, GrowsToTheAnalyticSlopes) {
  const NormalMap grown = resize(waves(128, 96), 512, 384, CodeType::F32);
  EXPECT_LT(largest_error(grown, waves(512, 384), 8), 0.05);
}

TEST(ResizeNormalMap, ShrinksToTheAnalyticSlopes) {
  const NormalMap shrunk = resize(waves(512, 384), 128, 96, CodeType::F32);
  EXPECT_LT(largest_error(shrunk, waves(128, 96), 0), 0.3);  // the waves' mean over a texel
}

TEST(ResizeNormalMap, HandlesUnevenRatiosAndMixedDirections) {
  EXPECT_LT(largest_error(resize(waves(200, 100), 313, 77, CodeType::F32), waves(313, 77), 4), 0.6);
  EXPECT_LT(largest_error(resize(waves(300, 300), 299, 301, CodeType::F32), waves(299, 301), 4),
            0.3);
}

TEST(ResizeNormalMap, ToItsOwnSizeChangesNothing) {
  EXPECT_LT(largest_error(resize(waves(64, 64), 64, 64, CodeType::F32), waves(64, 64), 0), 2e-5);
}

TEST(ResizeNormalMap, KeepsAPlane) {
  NormalMap map = flat_normal_map(5, 3, CodeType::F32);
  const Vec3f n = normal_from_slope({0.3F, -0.7F});
  for (int i = 0; i < 15; ++i) map.set_normal(i % 5, i / 5, n);
  for (const auto& [width, height] : {std::pair{1, 1}, {2, 1}, {3, 2}, {17, 40}, {5, 3}, {4, 9}}) {
    const NormalMap resized = resize(map, width, height, CodeType::F32);
    ASSERT_EQ(resized.width(), width);
    ASSERT_EQ(resized.height(), height);
    for (int i = 0; i < width * height; ++i) {
      EXPECT_LT(angle_degrees(resized.normal(i % width, i / width), n), 2e-5);
    }
  }
}

TEST(ResizeNormalMap, OneTexelGrows) {
  const NormalMap grown = resize(flat_normal_map(1, 1, CodeType::U8), 9, 4, CodeType::U8);
  for (int i = 0; i < 36; ++i) EXPECT_EQ(grown.normal(i % 9, i / 9), Vec3f(0.0F, 0.0F, 1.0F));
}

TEST(ResizeNormalMap, ResamplesVectorsInObjectSpace) {
  RawImage image(2, 1, 3, CodeType::F32);
  const std::array<float, 6> values{1, 0, 0, 0, 0, -1};
  std::memcpy(image.data(), values.data(), sizeof(values));
  const NormalMap map(image, {.space = NormalSpace::Object, .signed_float = true});
  const NormalMap one = resize(map, 1, 1, CodeType::F32);
  EXPECT_LT(angle_degrees(one.normal(0, 0), {1.0F, 0.0F, -1.0F}), 1e-5);
}

TEST(ResizeNormalMap, KeepsAlphaOfTheNearestTexel) {
  RawImage image(2, 2, 4, CodeType::U8);
  std::memcpy(image.data(), "\x80\x80\xFF\x0A\x80\x80\xFF\x14\x80\x80\xFF\x1E\x80\x80\xFF\x28", 16);
  const NormalMap grown = resize(NormalMap(image, {}), 4, 4, CodeType::U16);
  EXPECT_EQ(grown.codes().code(1, 1, 3), 10.0F * 257.0F);
  EXPECT_EQ(grown.codes().code(2, 0, 3), 20.0F * 257.0F);
  EXPECT_EQ(grown.codes().code(0, 3, 3), 30.0F * 257.0F);
  EXPECT_EQ(grown.codes().code(3, 2, 3), 40.0F * 257.0F);
}

TEST(ResizeNormalMap, IsTheSameOnOneThread) {
  const NormalMap map = waves(100, 70);
  const NormalMap many = resize(map, 333, 300, CodeType::U16);
  const ThreadLimit limit(1);
  const NormalMap one = resize(map, 333, 300, CodeType::U16);
  EXPECT_EQ(std::memcmp(many.codes().data(), one.codes().data(), one.codes().size_bytes()), 0);
}

TEST(ResizeNormalMap, RefusesEmptySizes) {
  EXPECT_THROW(resize(waves(4, 4), 0, 4, CodeType::U8), InvalidInput);
  EXPECT_THROW(resize(waves(4, 4), 4, -1, CodeType::U8), InvalidInput);
  EXPECT_THROW(resize(NormalMap(), 4, 4, CodeType::U8), InvalidInput);
}

}  // namespace
}  // namespace normalshop
