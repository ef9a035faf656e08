#include <cstring>
#include <limits>

#include "support/same_codes.h"
#include <gtest/gtest.h>

#include "normalshop/core/error.h"
#include "normalshop/core/normal_map.h"
#include "normalshop/core/parallel.h"
#include "normalshop/core/random.h"
#include "normalshop/core/sample.h"
#include "normalshop/core/slope.h"

namespace normalshop {
namespace {

using test::same_codes;

/// Any bits whatever: normals of any length, infinities and NaN among the floats.
RawImage random_codes(int width, int height, int channels, CodeType type) {
  RawImage image(width, height, channels, type);
  Random random(7);
  for (std::size_t i = 0; i < image.size_bytes(); ++i) {
    image.data()[i] = static_cast<std::uint8_t>(random.next());
  }
  return image;
}

/// Every pair of red and green, blue at its highest.
RawImage all_pairs(int channels) {
  RawImage image(256, 256, channels, CodeType::U8);
  for (int y = 0; y < 256; ++y) {
    for (int x = 0; x < 256; ++x) {
      std::uint8_t* code = image.row<std::uint8_t>(y) + x * channels;
      code[0] = static_cast<std::uint8_t>(x);
      code[1] = static_cast<std::uint8_t>(y);
      if (channels > 2) code[2] = 255;
    }
  }
  return image;
}

TEST(NormalMap, UntouchedCodesComeOutBitForBit) {
  for (const CodeType type : {CodeType::U8, CodeType::U16, CodeType::F32}) {
    for (const int channels : {3, 4}) {
      for (const bool green_down : {false, true}) {
        NormalConvention convention;
        convention.green_down = green_down;
        const RawImage image = random_codes(131, 67, channels, type);
        EXPECT_TRUE(same_codes(NormalMap(image, convention).encode(), image));
      }
    }
  }
}

TEST(NormalMap, OneEditLeavesEveryOtherCode) {
  for (const CodeType type : {CodeType::U8, CodeType::U16, CodeType::F32}) {
    const RawImage image = random_codes(131, 67, 4, type);
    NormalMap map(image, {});
    map.set_normal(130, 66, Vec3f(0.6F, 0.0F, 0.8F));
    EXPECT_TRUE(map.has_edits());
    EXPECT_EQ(map.edited_count(), 1U);
    EXPECT_TRUE(map.edited(130, 66));
    EXPECT_FALSE(map.edited(129, 66));
    RawImage out = map.encode();
    const std::size_t texel = static_cast<std::size_t>(4 * RawImage::code_size(type));
    const std::size_t before = image.size_bytes() - texel;
    EXPECT_EQ(std::memcmp(out.data(), image.data(), before), 0);
    const std::size_t alpha = static_cast<std::size_t>(3 * RawImage::code_size(type));
    EXPECT_EQ(
        std::memcmp(out.data() + before + alpha, image.data() + before + alpha, texel - alpha), 0);
    const float code = type == CodeType::U8 ? 204.0F : type == CodeType::U16 ? 52428.0F : 0.8F;
    EXPECT_NEAR(out.code(130, 66, 0), code, 1e-6F);
  }
}

class EveryPair : public testing::TestWithParam<NormalConvention> {};

TEST_P(EveryPair, DecodesAndEncodesBack) {
  const NormalConvention convention = GetParam();
  const RawImage image = all_pairs(3);
  // By way of floats, so that every code is decoded and encoded again.
  const NormalMap map(image, convention);
  const NormalMap floats(map.encode(CodeType::F32, convention), convention);
  const RawImage back = floats.encode(CodeType::U8, convention);
  for (int y = 0; y < 256; ++y) {
    for (int x = 0; x < 256; ++x) {
      // A centred code of 0 stands for less than -1, which shortens to the code of -1.
      if (convention.centred_code && (x == 0 || y == 0)) continue;
      ASSERT_EQ(back.code(x, y, 0), image.code(x, y, 0)) << x << ' ' << y;
      ASSERT_EQ(back.code(x, y, 1), image.code(x, y, 1)) << x << ' ' << y;
      ASSERT_EQ(back.code(x, y, 2), 255.0F);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Conventions, EveryPair,
                         testing::Values(NormalConvention{}, NormalConvention{.green_down = true},
                                         NormalConvention{.centred_code = true},
                                         NormalConvention{.green_down = true, .centred_code = true},
                                         NormalConvention{.signed_float = true},
                                         NormalConvention{.space = NormalSpace::Object}));

TEST(NormalMap, TwoChannelPairsDecodeAndEncodeBack) {
  const NormalConvention convention{.two_channel = true};
  const RawImage image = all_pairs(2);
  const NormalMap map(image, convention);
  const NormalMap floats(map.encode(CodeType::F32, convention), convention);
  const RawImage back = floats.encode(CodeType::U8, convention);
  for (int y = 0; y < 256; ++y) {
    for (int x = 0; x < 256; ++x) {
      const Vec3f v = map.vector(x, y);
      if (v.z() == 0.0F) continue;  // beyond the unit circle: no direction has this pair
      ASSERT_NEAR(v.norm(), 1.0F, 1e-6F);
      ASSERT_EQ(back.code(x, y, 0), image.code(x, y, 0));
      ASSERT_EQ(back.code(x, y, 1), image.code(x, y, 1));
    }
  }
}

TEST(NormalMap, TwoChannelsBecomeThree) {
  const NormalConvention two{.two_channel = true};
  RawImage image(1, 1, 2, CodeType::U16);
  image.row<std::uint16_t>(0)[0] = 52428;  // 0.6
  image.row<std::uint16_t>(0)[1] = 32768;
  const RawImage three = NormalMap(image, two).encode(CodeType::U16, {});
  ASSERT_EQ(three.channels(), 3);
  EXPECT_NEAR(three.code(0, 0, 2), (0.8F + 1.0F) * 32767.5F, 1.0F);
}

/// Two channels cannot tell a z below 0 from one above: such normals go to the horizon, where they
/// are nearest to what they were, and are not mirrored.
TEST(NormalMap, TwoChannelsHoldNoNormalBehindTheSurface) {
  const NormalConvention two{.two_channel = true};
  NormalMap map(RawImage(3, 1, 2, CodeType::F32), {.two_channel = true, .signed_float = true});
  map.set_normal(0, 0, Vec3f(0.36F, 0.48F, -0.8F));
  map.set_normal(1, 0, Vec3f(0.36F, 0.48F, 0.8F));
  map.set_normal(2, 0, Vec3f(0.0F, 0.0F, -1.0F));
  for (const CodeType type : {CodeType::U16, CodeType::F32}) {
    const NormalMap read(map.encode(type, two), two);
    EXPECT_LT(angle_degrees(read.vector(0, 0), {0.6F, 0.8F, 0.0F}), 0.5);
    EXPECT_LT(angle_degrees(read.vector(1, 0), {0.36F, 0.48F, 0.8F}), 0.01);
    EXPECT_LT(angle_degrees(read.vector(2, 0), {0.0F, 0.0F, 1.0F}), 0.01);
  }
}

TEST(NormalMap, GreenDownIsNegatedY) {
  RawImage image(1, 1, 3, CodeType::U8);
  std::memcpy(image.data(), "\x80\xD0\xE0", 3);
  const Vec3f up = NormalMap(image, {}).normal(0, 0);
  const Vec3f down = NormalMap(image, {.green_down = true}).normal(0, 0);
  EXPECT_GT(up.y(), 0.5F);
  EXPECT_EQ(down, Vec3f(up.x(), -up.y(), up.z()));
  const RawImage flipped = NormalMap(image, {}).encode(CodeType::U8, {.green_down = true});
  EXPECT_EQ(flipped.code(0, 0, 0), 128.0F);
  EXPECT_EQ(flipped.code(0, 0, 1), 255.0F - 208.0F);
}

TEST(NormalMap, AlphaSurvivesAnotherType) {
  RawImage image = random_codes(20, 10, 4, CodeType::U8);
  const RawImage wide = NormalMap(image, {}).encode(CodeType::U16, {});
  ASSERT_EQ(wide.channels(), 4);
  for (int y = 0; y < 10; ++y) {
    for (int x = 0; x < 20; ++x) ASSERT_EQ(wide.code(x, y, 3), image.code(x, y, 3) * 257.0F);
  }
}

TEST(NormalMap, EightBitCodesAreWithinHalfAStep) {
  Random random(3);
  NormalMap map = flat_normal_map(64, 64, CodeType::U8);
  for (int i = 0; i < 64 * 64; ++i) {
    const Vec3f n = normal_from_slope({random.uniform(-3.0F, 3.0F), random.uniform(-3.0F, 3.0F)});
    map.set_normal(i % 64, i / 64, n);
  }
  const NormalMap coarse(map.encode(), map.convention());
  const NormalMap fine(map.encode(CodeType::U16, map.convention()), map.convention());
  for (int i = 0; i < 64 * 64; ++i) {
    const Vec3f n = map.normal(i % 64, i / 64);
    ASSERT_LT(angle_degrees(coarse.normal(i % 64, i / 64), n), 0.4);
    ASSERT_LT(angle_degrees(fine.normal(i % 64, i / 64), n), 0.0016);
  }
}

TEST(NormalMap, CodesWithoutADirectionGiveZero) {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  constexpr float infinity = std::numeric_limits<float>::infinity();
  RawImage image(4, 1, 3, CodeType::F32);
  const std::array<float, 12> values{nan, 0, 0, infinity, 0, 0, 0.1F, 0, 0, 0, 0, 2.0F};
  std::memcpy(image.data(), values.data(), sizeof(values));
  const NormalMap map(image, {.signed_float = true});
  for (int x = 0; x < 3; ++x) EXPECT_EQ(map.normal(x, 0), Vec3f(0.0F, 0.0F, 0.0F));
  EXPECT_EQ(map.normal(3, 0), Vec3f(0.0F, 0.0F, 1.0F));
  const RawImage bytes = map.encode(CodeType::U8, {});
  EXPECT_EQ(bytes.code(0, 0, 0), 128.0F);  // no direction stays none
  EXPECT_EQ(bytes.code(1, 0, 2), 128.0F);
  EXPECT_EQ(bytes.code(3, 0, 2), 255.0F);
}

TEST(NormalMap, LongVectorsKeepTheirDirectionInIntegerCodes) {
  RawImage image(1, 1, 3, CodeType::F32);
  const std::array<float, 3> values{3.0F, 0.0F, 4.0F};
  std::memcpy(image.data(), values.data(), sizeof(values));
  const NormalMap map(image, {.signed_float = true});
  const NormalMap words(map.encode(CodeType::U16, map.convention()), map.convention());
  EXPECT_LT(angle_degrees(words.normal(0, 0), {0.6F, 0.0F, 0.8F}), 0.002);
}

TEST(NormalMap, RowsAreTheTexels) {
  NormalMap map(random_codes(131, 9, 3, CodeType::F32), {});
  map.set_normal(64, 4, Vec3f::UnitX());
  std::vector<Vec3f> row(131);
  map.read_normals(4, row.data());
  for (int x = 0; x < 131; ++x) ASSERT_EQ(row[static_cast<std::size_t>(x)], map.normal(x, 4));
}

TEST(NormalMap, SampleIsBilinearAndWraps) {
  const NormalMap map(random_codes(8, 4, 3, CodeType::U8), {});
  const auto centre = [](int x, int y) {
    return Vec2f((static_cast<float>(x) + 0.5F) / 8.0F, (static_cast<float>(y) + 0.5F) / 4.0F);
  };
  EXPECT_LT((map.sample(centre(3, 2)) - map.vector(3, 2)).norm(), 1e-6F);
  const Vec3f between = 0.5F * (map.vector(3, 2) + map.vector(4, 2));
  EXPECT_LT((map.sample({0.5F, centre(3, 2).y()}) - between).norm(), 1e-6F);
  const Vec3f across =
      0.25F * (map.vector(0, 0) + map.vector(7, 0) + map.vector(0, 3) + map.vector(7, 3));
  for (const Vec2f& corner : {Vec2f(0.0F, 0.0F), Vec2f(1.0F, 1.0F), Vec2f(-2.0F, 5.0F)}) {
    EXPECT_LT((map.sample(corner) - across).norm(), 1e-6F);
  }
  EXPECT_LT((map.sample({-0.25F, 1.3F}) - map.sample({0.75F, 0.3F})).norm(), 1e-5F);
  EXPECT_TRUE(map.sample({-1e-9F, 1.0F - 6e-8F}).allFinite());
}

/// glTF: normalize((2 c - 1) * (scale, scale, 1)).
TEST(NormalMap, AScaleMultipliesXAndYOfTheCodes) {
  for (const CodeType type : {CodeType::U8, CodeType::U16, CodeType::F32}) {
    for (const float scale : {0.25F, -0.5F, 2.0F, 4.0F}) {
      NormalConvention convention;
      convention.signed_float = true;
      const RawImage codes = NormalMap(all_pairs(3), convention).encode(type, convention);
      const NormalMap plain(codes, convention);
      convention.scale = scale;
      NormalMap map(codes, convention);
      std::vector<Vec3f> row(256);
      map.read_vectors(77, row.data());
      for (int x = 0; x < 256; ++x) {
        const Vec3f expected = plain.vector(x, 77).cwiseProduct(Vec3f(scale, scale, 1.0F));
        EXPECT_LT((map.vector(x, 77) - expected).norm(), 1e-6F);
        EXPECT_EQ(row[static_cast<std::size_t>(x)], map.vector(x, 77));
      }
      EXPECT_TRUE(same_codes(map.encode(), codes));
      const Vec2f uv(0.3F, 0.7F);
      const Vec3f sampled = plain.sample(uv).cwiseProduct(Vec3f(scale, scale, 1.0F));
      EXPECT_LT((map.sample(uv) - sampled).norm(), 1e-6F);
      std::vector<float> values(5 * (1 + sample_padding));
      float* const at = values.data();
      constexpr std::size_t step = 1 + sample_padding;
      at[0] = uv.x();
      at[step] = uv.y();
      map.sample(at, at + step, 1, at + 2 * step, at + 3 * step, at + 4 * step);
      EXPECT_LT((Vec3f(at[2 * step], at[3 * step], at[4 * step]) - sampled).norm(), 1e-5F);
    }
  }
}

/// An edit is read as the code that is written for it will be.
TEST(NormalMap, EditsAreStoredForTheScale) {
  for (const float scale : {0.25F, -0.5F, 2.0F, 4.0F}) {
    NormalConvention convention;
    convention.scale = scale;
    NormalMap map(RawImage(80, 3, 3, CodeType::U16), convention);
    for (int x = 0; x < 80; ++x) {
      map.set_normal(x, 1, normal_from_slope(Vec2f(0.05F * static_cast<float>(x) - 2.0F, 0.5F)));
    }
    const NormalMap back(map.encode(), convention);
    for (int x = 0; x < 80; ++x) {
      const Vec3f n = normal_from_slope(Vec2f(0.05F * static_cast<float>(x) - 2.0F, 0.5F));
      EXPECT_LT(angle_degrees(map.normal(x, 1), n), 1e-3);
      EXPECT_LT(angle_degrees(back.normal(x, 1), n), 0.02);
      EXPECT_LT((back.vector(x, 1) - map.vector(x, 1)).norm(), 2e-4F);
    }
  }
}

TEST(NormalMap, CopiesHaveTheirOwnEdits) {
  NormalMap map = flat_normal_map(70, 70, CodeType::U8);
  map.set_normal(1, 1, Vec3f::UnitX());
  NormalMap copy = map;
  copy.set_normal(2, 2, Vec3f::UnitX());
  EXPECT_EQ(map.edited_count(), 1U);
  EXPECT_EQ(copy.edited_count(), 2U);
  EXPECT_EQ(copy.normal(1, 1), Vec3f(1.0F, 0.0F, 0.0F));
}

TEST(NormalMap, FlatIsExactlyFlat) {
  for (const CodeType type : {CodeType::U8, CodeType::U16, CodeType::F32}) {
    EXPECT_EQ(flat_normal_map(3, 2, type).normal(2, 1), Vec3f(0.0F, 0.0F, 1.0F));
  }
}

TEST(NormalMap, AFlatEditGetsTheUsualFlatCode) {
  NormalMap map(random_codes(2, 2, 3, CodeType::U8), {});
  map.set_normal(1, 1, Vec3f::UnitZ());
  const RawImage bytes = map.encode();
  EXPECT_EQ(bytes.code(1, 1, 0), 128.0F);
  EXPECT_EQ(bytes.code(1, 1, 1), 128.0F);
  EXPECT_EQ(bytes.code(1, 1, 2), 255.0F);
}

TEST(NormalMap, NeedsEnoughChannels) {
  EXPECT_THROW(NormalMap(RawImage(2, 2, 2, CodeType::U8), {}), InvalidInput);
  EXPECT_THROW(NormalMap(RawImage(2, 2, 1, CodeType::U8), {.two_channel = true}), InvalidInput);
  EXPECT_NO_THROW(NormalMap(random_codes(2, 2, 2, CodeType::U8), {.two_channel = true}));
}

TEST(NormalMap, EncodesRowsAsTheWholeMap) {
  NormalMap map = flat_normal_map(70, 90, CodeType::U8);
  for (int y = 10; y < 80; y += 3) map.set_normal(y % 70, y, normal_from_slope({0.3F, 0.1F}));
  NormalConvention down = map.convention();
  down.green_down = true;
  for (const NormalConvention& to : {map.convention(), down}) {
    const RawImage whole = map.encode(CodeType::U16, to);
    const RawImage same = map.encode(CodeType::U8, to);
    const RawImage rows = map.encode_rows(60, 21, CodeType::U16, to);
    const RawImage same_rows = map.encode_rows(60, 21, CodeType::U8, to);
    ASSERT_EQ(rows.height(), 21);
    EXPECT_EQ(std::memcmp(rows.data(), whole.row_data(60), rows.size_bytes()), 0);
    EXPECT_EQ(std::memcmp(same_rows.data(), same.row_data(60), same_rows.size_bytes()), 0);
  }
}

TEST(NormalMap, EncodesAlikeOnOneThread) {
  const NormalMap map(random_codes(200, 150, 3, CodeType::U16), {});
  const RawImage many = map.encode(CodeType::U8, {});
  const ThreadLimit limit(1);
  EXPECT_TRUE(same_codes(many, map.encode(CodeType::U8, {})));
}

}  // namespace
}  // namespace normalshop
