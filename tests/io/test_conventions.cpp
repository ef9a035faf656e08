#include <cmath>
#include <cstring>

#include "support/data.h"
#include <gtest/gtest.h>

#include "normalshop/core/error.h"
#include "normalshop/io/conventions.h"
#include "normalshop/io/image_file.h"

namespace normalshop {
namespace {

RawImage green_flipped(const RawImage& codes) {
  RawImage out = codes;
  for (int y = 0; y < codes.height(); ++y) {
    for (int x = 0; x < codes.width(); ++x) {
      const int i = x * codes.channels() + 1;
      if (codes.type() == CodeType::U8) {
        out.row<std::uint8_t>(y)[i] =
            static_cast<std::uint8_t>(255 - codes.row<std::uint8_t>(y)[i]);
      } else {
        out.row<std::uint16_t>(y)[i] =
            static_cast<std::uint16_t>(65535 - codes.row<std::uint16_t>(y)[i]);
      }
    }
  }
  return out;
}

class GreenUp : public ::testing::TestWithParam<const char*> {};

TEST_P(GreenUp, IsFoundAndFlipsWithTheChannel) {
  const auto path = test::data_file(GetParam());
  if (!path) GTEST_SKIP() << "the real data is not on this machine";
  const RawImage codes = read_image(*path);
  const ConventionGuess up = guess_convention(codes);
  EXPECT_EQ(up.convention.space, NormalSpace::Tangent);
  EXPECT_FALSE(up.convention.green_down);
  EXPECT_GE(up.green_ratio, 2.0) << up.sentence;
  EXPECT_FALSE(up.convention.two_channel);
  EXPECT_NEAR(up.lengths.mean, 1.0, 0.05);
  const ConventionGuess down = guess_convention(green_flipped(codes));
  EXPECT_TRUE(down.convention.green_down);
  EXPECT_GE(down.green_ratio, 2.0);
}

INSTANTIATE_TEST_SUITE_P(Maps, GreenUp,
                         ::testing::Values("mat_ambientcg_bark/normal.jpg",
                                           "mat_ambientcg_facade/normal.jpg",
                                           "mat_ambientcg_metal/normal.jpg",
                                           "mat_ambientcg_rock/normal.jpg",
                                           "mat_ambientcg_rustymetal/normal.jpg",
                                           "mat_rosewood_veneer/rosewood_veneer1_nor_gl_1k.png",
                                           "khr_avocado/Avocado_normal.png",
                                           "khr_boombox_axes/BoomBoxWithAxes_normal.png",
                                           "khr_normal_tangent_test/NormalTangentTest_Normal.png",
                                           "lee_perry_smith/Infinite-Level_02_Tangent_SmoothUV.jpg",
                                           "polyhaven_sofa_03/textures/sofa_03_nor_gl_1k.jpg",
                                           "bell_pepper/bell_pepper_no_stem_normal.png"));

/// Bevels along the axes only: their curl tells nothing, and nothing is claimed.
TEST(Conventions, AxisAlignedBevelsStayUndecided) {
  for (const char* name :
       {"khr_waterbottle/WaterBottle_normal.png", "franka_panda/hand_normal.png"}) {
    const auto path = test::data_file(name);
    if (!path) GTEST_SKIP() << "the real data is not on this machine";
    const RawImage codes = read_image(*path);
    EXPECT_LT(guess_convention(codes).green_ratio, 2.0);
    EXPECT_FALSE(guess_convention(green_flipped(codes)).convention.green_down);
    EXPECT_TRUE(guess_convention(codes).convention.centred_code);
  }
}

/// A normal map of waves, as a given convention codes it.
RawImage waves(CodeType type, const NormalConvention& convention, int channels, bool sphere,
               float steepness = 1.0F) {
  RawImage flat(128, 128, channels, type);
  std::memset(flat.data(), 0, flat.size_bytes());
  NormalConvention full = convention;
  NormalMap map(flat, full);
  for (int y = 0; y < 128; ++y) {
    for (int x = 0; x < 128; ++x) {
      const float a = 0.2F * static_cast<float>(x) + 0.1F * static_cast<float>(y);
      const float b = 0.15F * static_cast<float>(x) - 0.25F * static_cast<float>(y);
      Vec3f n(-0.3F * std::cos(a) - 0.2F * std::cos(b), 0.15F * std::cos(a) - 0.33F * std::cos(b),
              1.0F);
      n.head<2>() *= steepness;
      if (sphere) {
        const float t = 3.1416F * static_cast<float>(y) / 127.0F;
        const float f = 6.2832F * static_cast<float>(x) / 128.0F;
        n = Vec3f(std::sin(t) * std::cos(f), std::cos(t), std::sin(t) * std::sin(f));
      }
      map.set_normal(x, y, n.normalized());
    }
  }
  return map.encode();
}

TEST(Conventions, AnalyticMapsAreRecognised) {
  for (const bool down : {false, true}) {
    for (const CodeType type : {CodeType::U8, CodeType::U16, CodeType::F32}) {
      NormalConvention convention;
      convention.green_down = down;
      const ConventionGuess guess = guess_convention(waves(type, convention, 3, false));
      EXPECT_EQ(guess.convention.green_down, down) << guess.sentence;
      EXPECT_GT(guess.green_ratio, 5.0) << guess.sentence;
      EXPECT_EQ(guess.convention.space, NormalSpace::Tangent);
      EXPECT_GT(guess.space_confidence, 0.5);
      EXPECT_FALSE(guess.convention.signed_float);
    }
  }
}

TEST(Conventions, ObjectSpaceIsTheWholeSphere) {
  NormalConvention convention;
  convention.space = NormalSpace::Object;
  const ConventionGuess guess = guess_convention(waves(CodeType::U8, convention, 3, true));
  EXPECT_EQ(guess.convention.space, NormalSpace::Object);
  EXPECT_GT(guess.space_confidence, 0.5);
}

/// Very steep tangent-space maps look like object space; who knows better still needs green.
TEST(Conventions, GreenIsGuessedInASpaceThatIsKnown) {
  for (const bool down : {false, true}) {
    NormalConvention convention;
    convention.green_down = down;
    const RawImage codes = waves(CodeType::U16, convention, 3, false, 12.0F);
    ASSERT_EQ(guess_convention(codes).convention.space, NormalSpace::Object);
    const ConventionGuess guess = guess_convention(codes, NormalSpace::Tangent);
    EXPECT_EQ(guess.convention.space, NormalSpace::Tangent);
    EXPECT_EQ(guess.convention.green_down, down) << guess.sentence;
    EXPECT_GT(guess.green_ratio, 2.0) << guess.sentence;
    EXPECT_NE(guess.sentence.find("looks like object space"), std::string::npos);
    EXPECT_EQ(guess_convention(codes, NormalSpace::World).sentence, "world space");
  }
}

TEST(Conventions, SignedFloatsAndTwoChannels) {
  NormalConvention convention;
  convention.signed_float = true;
  EXPECT_TRUE(guess_convention(waves(CodeType::F32, convention, 3, false)).convention.signed_float);
  convention.signed_float = false;
  convention.two_channel = true;
  const ConventionGuess two = guess_convention(waves(CodeType::U8, convention, 2, false));
  EXPECT_TRUE(two.convention.two_channel);
  EXPECT_FALSE(two.convention.green_down);
  EXPECT_GT(two.green_ratio, 5.0);
  // Three channels with nothing in blue.
  EXPECT_TRUE(guess_convention(waves(CodeType::U8, convention, 3, false)).convention.two_channel);
}

TEST(Conventions, FlatMapsAreUndecidedAndCentred) {
  RawImage flat(64, 64, 3, CodeType::U8);
  for (std::size_t i = 0; i < flat.size_bytes(); ++i) flat.data()[i] = i % 3 == 2 ? 255 : 128;
  const ConventionGuess guess = guess_convention(flat);
  EXPECT_TRUE(guess.convention.centred_code);
  EXPECT_FALSE(guess.convention.two_channel);
  EXPECT_FALSE(guess.convention.green_down);
  EXPECT_EQ(guess.green_ratio, 1.0);
  EXPECT_NE(guess.sentence.find("undecided"), std::string::npos) << guess.sentence;
}

TEST(Conventions, AnyImageGivesAnAnswer) {
  for (const CodeType type : {CodeType::U8, CodeType::U16, CodeType::F32}) {
    for (const auto& [w, h] : {std::pair{1, 1}, {3, 200}, {200, 3}, {17, 17}}) {
      RawImage image(w, h, 4, type);
      std::memset(image.data(), 0xFF, image.size_bytes());  // F32: not a number
      EXPECT_FALSE(guess_convention(image).sentence.empty());
    }
  }
  EXPECT_THROW(guess_convention(RawImage(4, 4, 1, CodeType::U8)), InvalidInput);
  EXPECT_THROW(guess_convention(RawImage()), InvalidInput);
}

TEST(Conventions, ColoursAndHeightsAreNoNormalMaps) {
  const auto normal = test::data_file("mat_ambientcg_rock/normal.jpg");
  const auto albedo = test::data_file("mat_ambientcg_rock/albedo.jpg");
  const auto height = test::data_file("mat_ambientcg_rock/displacement.jpg");
  if (!normal || !albedo || !height) GTEST_SKIP() << "the real data is not on this machine";
  EXPECT_TRUE(looks_like_normal_map(read_image(*normal)));
  EXPECT_FALSE(looks_like_normal_map(read_image(*albedo)));
  EXPECT_FALSE(looks_like_normal_map(read_image(*height)));
}

}  // namespace
}  // namespace normalshop
