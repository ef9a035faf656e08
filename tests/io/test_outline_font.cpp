#include <algorithm>
#include <cmath>

#include "io/temp_folder.h"
#include <gtest/gtest.h>

#include "normalshop/core/error.h"
#include "normalshop/io/atomic_file.h"
#include "normalshop/io/outline_font.h"

namespace normalshop {
namespace {

using Outlines = std::vector<std::vector<Vec2f>>;

struct Box {
  Vec2f low{1e9F, 1e9F};
  Vec2f high{-1e9F, -1e9F};
};

Box box_of(const Outlines& outlines) {
  Box box;
  for (const auto& outline : outlines) {
    for (const Vec2f& p : outline) {
      box.low = box.low.cwiseMin(p);
      box.high = box.high.cwiseMax(p);
    }
  }
  return box;
}

double area(const std::vector<Vec2f>& outline) {
  double sum = 0.0;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Vec2d a = outline[i].cast<double>();
    const Vec2d b = outline[(i + 1) % outline.size()].cast<double>();
    sum += 0.5 * cross(a, b);
  }
  return sum;
}

class Text : public ::testing::Test {
 protected:
  void SetUp() override {
    try {
      text_outlines("H");
    } catch (const IoError& error) {
      GTEST_SKIP() << error.what();
    }
  }
};

TEST_F(Text, CapitalsAreCentred) {
  const Box box = box_of(text_outlines("HH"));
  EXPECT_NEAR(box.low.y(), -box.high.y(), 1e-4F);
  EXPECT_NEAR(box.high.y() - box.low.y(), 0.729F, 0.01F);
  EXPECT_NEAR(box.low.x(), -box.high.x(), 0.02F);
}

TEST_F(Text, HolesRunTheOtherWay) {
  const Outlines o = text_outlines("O");
  ASSERT_EQ(o.size(), 2U);
  EXPECT_LT(area(o[0]) * area(o[1]), 0.0);
  EXPECT_EQ(text_outlines("8").size(), 3U);
  EXPECT_EQ(text_outlines("i").size(), 2U);
}

TEST_F(Text, CurvesAreSmooth) {
  for (const auto& outline : text_outlines("O")) {
    for (std::size_t i = 0; i < outline.size(); ++i) {
      const Vec2f a = outline[i];
      const Vec2f b = outline[(i + 1) % outline.size()];
      const Vec2f c = outline[(i + 2) % outline.size()];
      const float turn =
          std::acos(std::clamp((b - a).normalized().dot((c - b).normalized()), -1.0F, 1.0F));
      EXPECT_LT(turn, 0.35F);
      EXPECT_GT((b - a).norm(), 0.0F);
    }
  }
}

TEST_F(Text, KerningAndLines) {
  // On one line of three, A advances by what "AA" is wider than "A", and so does V; without kerning
  // "AVA" would be as wide as "AA" and one V's advance.
  const auto width = [](const char* text) {
    const Box box = box_of(text_outlines(text));
    return (box.high - box.low).x();
  };
  const float v_advance = width("VV") - width("V");
  EXPECT_LT(width("AVA"), width("AA") + v_advance - 0.05F);
  const Box two = box_of(text_outlines("H\nH"));
  EXPECT_NEAR(two.low.y(), -two.high.y(), 1e-4F);
  EXPECT_GT((two.high - two.low).y(), 1.7F);
  EXPECT_TRUE(text_outlines("").empty());
  EXPECT_TRUE(text_outlines(" \n\n ").empty());
  EXPECT_EQ(text_outlines("\xC3\xA9").size(), 3U);  // e with acute accent
}

TEST_F(Text, BadInputIsNamed) {
  EXPECT_THROW(text_outlines("\xFF"), InvalidInput);
  EXPECT_THROW(text_outlines("\xC3"), InvalidInput);
  EXPECT_THROW(text_outlines("\xC0\x80"), InvalidInput);
  EXPECT_THROW(text_outlines("H", "no such font"), IoError);
  EXPECT_THROW(text_outlines("H", "/none/font.ttf"), IoError);
  const test::TempFolder folder;
  write_file(folder / "font.ttf", std::string_view("not a font"));
  EXPECT_THROW(text_outlines("H", folder / "font.ttf"), InvalidInput);
  EXPECT_FALSE(text_outlines("H", "DejaVuSans").empty());
}

}  // namespace
}  // namespace normalshop
