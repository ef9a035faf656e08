#include <string>
#include <tuple>

#include <gtest/gtest.h>

#include "normalshop/core/curve.h"
#include "normalshop/core/options.h"

namespace normalshop {
namespace {

enum class Shape { Round, Flat, Pointed };
constexpr auto names_of(Shape) {
  return std::array<std::string_view, 3>{"round", "flat", "pointed"};
}

struct SampleOptions {
  float width = 2.0F;
  Vec2f offset{1.0F, -3.0F};
  float angle = 30.0F;
  int steps = 4;
  bool closed = true;
  Shape shape = Shape::Flat;
  std::string text = "abc";
  Curve profile;
  static constexpr auto fields() {
    return std::tuple{field("width", &SampleOptions::width, "length", 0, 1e6, "Width"),
                      field("offset", &SampleOptions::offset, "length", 0, 0, "Offset"),
                      field("angle", &SampleOptions::angle, "degrees", -360, 360, "Turn"),
                      field("steps", &SampleOptions::steps, "1", 1, 10, "Steps"),
                      field("closed", &SampleOptions::closed, "Closed"),
                      field("shape", &SampleOptions::shape, "Shape"),
                      field("text", &SampleOptions::text, "Text"),
                      field("profile", &SampleOptions::profile, "Profile")};
  }
};

TEST(Options, VisitsEveryFieldInOrder) {
  std::string names;
  for_each_field<SampleOptions>([&](const auto& f) { names += std::string(f.name) + " "; });
  EXPECT_EQ(names, "width offset angle steps closed shape text profile ");
}

TEST(Options, ScaleLengthsTouchesLengthsOnly) {
  const SampleOptions scaled = scale_lengths(SampleOptions{}, 10.0F);
  EXPECT_EQ(scaled.width, 20.0F);
  EXPECT_EQ(scaled.offset, Vec2f(10.0F, -30.0F));
  EXPECT_EQ(scaled.angle, 30.0F);
  EXPECT_EQ(scaled.steps, 4);
  EXPECT_TRUE(scaled.closed);
  EXPECT_EQ(scaled.text, "abc");
}

TEST(Options, NamesGoBothWays) {
  EXPECT_EQ(name_of(Shape::Pointed), "pointed");
  Shape shape = Shape::Round;
  EXPECT_TRUE(from_name("flat", shape));
  EXPECT_EQ(shape, Shape::Flat);
  EXPECT_FALSE(from_name("square", shape));
  EXPECT_FALSE(from_name("", shape));
  EXPECT_EQ(shape, Shape::Flat);
}

}  // namespace
}  // namespace normalshop
