#include <cmath>
#include <cstring>
#include <limits>

#include <gtest/gtest.h>

#include "normalshop/core/color_map.h"

namespace normalshop::test {

namespace {

/// Every code in every channel.
RawImage all_bytes(int channels) {
  RawImage codes(256, 1, channels, CodeType::U8);
  for (int i = 0; i < 256 * channels; ++i) {
    codes.row<std::uint8_t>(0)[i] = static_cast<std::uint8_t>(i / channels);
  }
  return codes;
}

Vec2f center(const ColorMap& map, int x, int y) {
  return {(static_cast<float>(x) + 0.5F) / static_cast<float>(map.codes().width()),
          (static_cast<float>(y) + 0.5F) / static_cast<float>(map.codes().height())};
}

bool same_bytes(const RawImage& a, const RawImage& b) {
  return a.type() == b.type() && a.channels() == b.channels() && a.size_bytes() == b.size_bytes() &&
         std::memcmp(a.data(), b.data(), a.size_bytes()) == 0;
}

}  // namespace

TEST(ColorMapEdits, KeepsEveryCodeAndWhatItShows) {
  for (const int channels : {1, 3, 4}) {
    const ColorMap before(all_bytes(channels));
    ColorMap after = before;
    after.begin_edits();
    EXPECT_FALSE(after.has_edits());
    EXPECT_TRUE(same_bytes(after.encode(), before.codes())) << channels;
    for (int x = 0; x < 256; ++x) {
      const float one = linear_to_srgb(before.sample(center(before, x, 0)).x());
      const float other = linear_to_srgb(after.sample(center(after, x, 0)).x());
      EXPECT_NEAR(one, other, 1.0F / (16 * 255)) << x;
    }
  }
}

TEST(ColorMapEdits, AddsLinearLight) {
  ColorMap map(all_bytes(4), Vec3f(1.0F, 0.5F, 1.0F));
  map.begin_edits();
  const Vec3f before = map.sample(center(map, 100, 0));
  EXPECT_TRUE(map.add(100, 0, Vec3f(0.1F, 0.2F, -0.05F)));
  EXPECT_TRUE(map.has_edits());
  const Vec3f after = map.sample(center(map, 100, 0));
  EXPECT_LT((after - before - Vec3f(0.1F, 0.2F, -0.05F)).cwiseAbs().maxCoeff(), 1e-3F);
  const RawImage codes = map.encode();
  EXPECT_EQ(codes.type(), CodeType::U8);
  EXPECT_EQ(codes.code(100, 0, 3), 100.0F) << "alpha stays";
  EXPECT_EQ(codes.code(99, 0, 0), 99.0F);
  EXPECT_EQ(codes.code(101, 0, 0), 101.0F);
}

TEST(ColorMapEdits, ManySmallEditsAddUp) {
  ColorMap map(all_bytes(3));
  map.begin_edits();
  const float before = map.sample(center(map, 200, 0)).x();
  for (int i = 0; i < 200; ++i) map.add(200, 0, Vec3f(0.0005F, 0.0F, 0.0F));
  EXPECT_NEAR(map.sample(center(map, 200, 0)).x(), before + 0.1F, 2e-3F);
}

TEST(ColorMapEdits, StopsWhereCodesEnd) {
  ColorMap map(all_bytes(3));
  map.begin_edits();
  map.add(250, 0, Vec3f(9.0F, -9.0F, 0.0F));
  EXPECT_EQ(map.encode().code(250, 0, 0), 255.0F);
  EXPECT_EQ(map.encode().code(250, 0, 1), 0.0F);
  EXPECT_EQ(map.encode().code(250, 0, 2), 250.0F);
}

TEST(ColorMapEdits, HiddenChannelsAndNoNumbersStay) {
  ColorMap map(all_bytes(3), Vec3f(0.0F, 1.0F, 1.0F));
  map.begin_edits();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(map.add(50, 0, Vec3f(0.5F, nan, 0.0F)));
  EXPECT_FALSE(map.has_edits());
  EXPECT_TRUE(same_bytes(map.encode(), all_bytes(3)));
}

TEST(ColorMapEdits, GreyTakesTheMeanAndFloatsHaveNoEnd) {
  ColorMap grey(all_bytes(1));
  grey.begin_edits();
  const float before = grey.sample(center(grey, 90, 0)).x();
  grey.add(90, 0, Vec3f(0.3F, 0.0F, 0.0F));
  EXPECT_NEAR(grey.sample(center(grey, 90, 0)).x(), before + 0.1F, 1e-3F);

  RawImage codes(1, 1, 3, CodeType::F32);
  for (int c = 0; c < 3; ++c) codes.row<float>(0)[c] = 0.25F;
  ColorMap floats(std::move(codes));
  floats.begin_edits();
  floats.add(0, 0, Vec3f(2.0F, 0.0F, -1.0F));
  EXPECT_EQ(floats.encode().code(0, 0, 0), 2.25F);
  EXPECT_EQ(floats.encode().code(0, 0, 2), -0.75F);
}

}  // namespace normalshop::test
