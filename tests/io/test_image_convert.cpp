#include <cmath>

#include "io/temp_folder.h"
#include "support/same_codes.h"
#include <gtest/gtest.h>

#include "normalshop/core/error.h"
#include "normalshop/core/normal_levels.h"
#include "normalshop/core/slope.h"
#include "normalshop/io/image_convert.h"
#include "normalshop/io/image_file.h"

namespace normalshop::test {
namespace {

constexpr int size = 32;

/// Waves in 16 bits with alpha, green up; in the upper half as vectors of length 0.8, with one
/// pixel of no direction.
RawImage uneven_codes() {
  RawImage codes(size, size, 4, CodeType::U16);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const Vec2f slope(0.5F * std::sin(0.4F * static_cast<float>(x)),
                        0.4F * std::cos(0.3F * static_cast<float>(y)));
      const Vec3f n = (y < size / 2 ? 0.8F : 1.0F) * normal_from_slope(slope);
      std::uint16_t* code = codes.row<std::uint16_t>(y) + 4 * x;
      for (int c = 0; c < 3; ++c) {
        code[c] = static_cast<std::uint16_t>(std::lround((n[c] + 1.0F) * 32767.5F));
      }
      code[3] = static_cast<std::uint16_t>(100 * x);
    }
  }
  for (int c = 0; c < 3; ++c) codes.row<std::uint16_t>(3)[4 * 5 + c] = 32768;
  return codes;
}

class ImageConvert : public testing::Test {
 protected:
  ImageConvert() {
    input_.normals = folder_ / "in.png";
    input_.green_down = false;
    write_image(input_.normals, uneven_codes());
  }
  ConvertReport convert(ImageExport target, bool normalize = false) {
    target.normals = folder_ / target.normals;
    return convert_image(input_, open_image(input_), target, normalize);
  }
  NormalMap written(const std::string& file, bool green_down = false) const {
    return {read_image(folder_ / file), NormalConvention{.green_down = green_down}};
  }

  TempFolder folder_;
  OpenImageOptions input_;
};

TEST_F(ImageConvert, NothingAskedChangesNothing) {
  const ConvertReport report = convert({"out.png"});
  EXPECT_EQ(report.pixels, std::size_t{size} * size);
  EXPECT_EQ(report.not_unit, std::size_t{size} * size / 2 - 1);
  EXPECT_EQ(report.without_direction, 1U);
  EXPECT_TRUE(same_codes(read_image(folder_ / "out.png"), uneven_codes()));
}

TEST_F(ImageConvert, OneMipLevelIsWritten) {
  const OpenedImage opened = open_image(input_);
  const NormalLevels levels(opened.document.normals());
  convert_level(input_, opened, {.normals = folder_ / "l.png", .green_down = true}, 2, {});
  const NormalMap level = written("l.png", true);
  ASSERT_EQ(level.width(), size / 4);
  EXPECT_LT(angle_degrees(level.normal(1, 2), levels.normal(2, 1, 2)), 0.01);
  convert_level(input_, opened, {folder_ / "r.png"}, 1, 0.3F);
  EXPECT_EQ(read_image(folder_ / "r.png").channels(), 1);
  EXPECT_THROW(convert_level(input_, opened, {folder_ / "x.png"}, 12, {}), InvalidInput);
  EXPECT_THROW(convert_level(input_, opened, {input_.normals}, 1, {}), InvalidInput);
}

TEST_F(ImageConvert, GreenIsTurned) {
  convert({.normals = "down.png", .green_down = true});
  const NormalMap before = open_image(input_).document.normals();
  const NormalMap down = written("down.png", true);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      EXPECT_LT((down.normal(x, y) - before.normal(x, y)).norm(), 1e-4F);
      EXPECT_EQ(down.codes().code(x, y, 3), 100.0F * static_cast<float>(x));
    }
  }
  EXPECT_GT(std::abs(down.codes().code(3, 0, 1) - before.codes().code(3, 0, 1)), 1000.0F);
}

TEST_F(ImageConvert, NormalizingGivesLengthsOfOne) {
  convert({"unit.png"}, true);
  const NormalMap before = open_image(input_).document.normals();
  const NormalMap after = written("unit.png");
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      if (x == 5 && y == 3) continue;
      EXPECT_NEAR(after.vector(x, y).norm(), 1.0F, 5e-5F) << x << " " << y;
      EXPECT_LT((after.normal(x, y) - before.normal(x, y)).norm(), 1e-4F);
    }
  }
  EXPECT_TRUE(after.normal(5, 3).isZero());
  input_.normals = folder_ / "unit.png";
  EXPECT_EQ(convert({"again.png"}, true).not_unit, 0U);
}

TEST_F(ImageConvert, MoreBitsHoldLengthsOfOneBetter) {
  convert({.normals = "8.png", .type = CodeType::U8});
  input_.normals = folder_ / "8.png";
  convert({.normals = "16.png", .type = CodeType::U16}, true);
  const NormalMap after = written("16.png");
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      if (x == 5 && y == 3) continue;
      EXPECT_NEAR(after.vector(x, y).norm(), 1.0F, 5e-5F) << x << " " << y;
    }
  }
  input_.normals = folder_ / "16.png";
  EXPECT_EQ(convert({"again.png"}, true).not_unit, 0U);
}

TEST_F(ImageConvert, HalfFloatsThatAreUnitStay) {
  convert({"unit.png"}, true);
  const RawImage codes =
      NormalMap(read_image(folder_ / "unit.png"), {}).encode(CodeType::F32, NormalConvention{});
  write_image(folder_ / "half.exr", codes, {.half_float = true});
  input_.normals = folder_ / "half.exr";
  EXPECT_EQ(convert({"again.exr"}, true).not_unit, 0U);
  EXPECT_TRUE(same_codes(read_image(folder_ / "again.exr"), read_image(folder_ / "half.exr")));
}

TEST_F(ImageConvert, DoesNotOverwriteItsInput) {
  EXPECT_THROW(convert({.normals = "in.png", .green_down = true}), InvalidInput);
}

}  // namespace
}  // namespace normalshop::test
