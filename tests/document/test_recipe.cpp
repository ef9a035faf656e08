#include "document/edit_fixture.h"
#include <gtest/gtest.h>

#include "normalshop/document/edit.h"

namespace normalshop::test {
namespace {

/// Every field of every operator, with values that are not the defaults.
const std::string full_recipe = R"({"version": 1, "comment": "all of it", "edits": [
  {"operator": "pen", "view": "back", "mode": "base", "curvature": "keep",
   "details": "ignore", "strength": 0.3,
   "effective": {"full": 50, "zero": 70.5}, "window": "view", "spray": {"full": 10.5, "zero": 88},
   "options": {"profile": "custom", "curve": [[-1, 0], [-0.1, 0.7], [1, 0]], "width": 0.1,
               "height": -0.02, "closed": true, "taper": 0.3, "pressure": "width", "smooth": false},
   "strokes": [[[0, 0], [0.1, 0.2, 0.35], [0.3, -7e-5]], [[1, 2], [3, 4], [5, 6, 0]]]},
  {"operator": "stamp", "view": {"direction": [0, 0.1, 1], "up": [1, 0, 0], "center": [1, 2, 3],
                                 "width": 0.7, "height": 0.2},
   "options": {"patch": "cone.png", "size": 0.1, "relief": -2, "rotation": 33, "scale_x": -1.5,
               "scale_y": 2, "shear": 0.2, "heights": "grow", "border": 0.3, "high_pass": 0.2},
   "strokes": [[[0.1, 0.1]]]},
  {"operator": "text", "view": {"facing": [0.1, 0.2, 0.3], "width": 2},
   "options": {"text": "two\nlines \"quoted\"", "size": 0.1, "height": -0.01, "bevel": 0.02,
               "rotation": -90, "shear": 1},
   "strokes": [[[0.1, 0.1]]]},
  {"operator": "combine", "view": "right",
   "options": {"image": "cone.png", "size": 0.4, "repeat": true, "relief": 3, "rotation": 30,
               "scale_x": -2, "scale_y": 0.5, "shear": -1, "heights": "grow", "border": 0.2,
               "model": "whiteout", "area": "inside", "brush": 0.1, "hardness": 0.3, "feather": 0.2},
   "strokes": [[[0, 0], [1, 1], [0, 1]]]},
  {"operator": "smooth", "view": {"direction": [1, 0, 0]},
   "options": {"sigma": 0.05, "area": "brush", "brush": 0.4, "hardness": 0.25},
   "strokes": [[[0, 0], [1, 1]]]},
  {"operator": "sharpen", "view": "top",
   "options": {"sigma": 0.05, "amount": 3, "noise_sigma": 0.01, "area": "inside", "feather": 0.07},
   "strokes": [[[0, 0], [1, 1], [0, 1]]]},
  {"operator": "filter", "view": "bottom",
   "options": {"kind": "band_pass", "sigma": 0.07, "noise_sigma": 0.02, "amount": -2,
               "area": "brush", "brush": 0.3, "hardness": 0.1},
   "strokes": [[[0, 0], [1, 1]]]},
  {"operator": "denoise", "view": "left",
   "options": {"method": "transform", "sigma": 0.07, "sigma_normal": 0.3, "sigma_color": 0.4,
               "guide_sigma": 0.01, "iterations": 2, "area": "brush", "brush": 0.3,
               "hardness": 0.1},
   "strokes": [[[0, 0], [1, 1]]]},
  {"operator": "equalize", "view": "front",
   "options": {"sigma": 0.01, "gains": [0, 1.5, -2], "base_gain": 0.5, "area": "inside",
               "feather": 0.07},
   "strokes": [[[0, 0], [1, 1], [0, 1]]]},
  {"operator": "convolve", "view": "front",
   "options": {"kernel": "blur.json", "normalize": true, "pixel": 0.01, "area": "brush",
               "brush": 0.4},
   "strokes": [[[0, 0], [1, 1]]]},
  {"operator": "transplant", "view": "right",
   "options": {"image": "cone.png", "size": 0.4, "repeat": true, "relief": 3, "rotation": 30,
               "scale_x": -2, "scale_y": 0.5, "shear": -1, "heights": "grow", "border": 0.2,
               "sigma": 0.03, "area": "inside", "brush": 0.1, "hardness": 0.3, "feather": 0.2},
   "strokes": [[[0, 0], [1, 1], [0, 1]]]}]})";

TEST(Recipe, WhatIsWrittenReadsBackTheSame) {
  const Recipe recipe = parse(full_recipe);
  ASSERT_EQ(recipe.edits.size(), parse_json(full_recipe, "").find("edits")->array()->size());
  const std::string once = to_json(to_value(recipe));
  EXPECT_EQ(to_json(to_value(parse(once))), once);
}

TEST(Recipe, EveryFieldComesThrough) {
  const std::string text = to_json(to_value(parse(full_recipe)));
  const Value written = parse_json(text, "");
  const Value given = parse_json(full_recipe, "");
  for (std::size_t i = 0; i < given.find("edits")->array()->size(); ++i) {
    const Value& before = given.find("edits")->array()->at(i);
    const Value& after = written.find("edits")->array()->at(i);
    for (const auto& [name, value] : *before.object()) {
      if (name == "options" || name == "view") continue;
      ASSERT_NE(after.find(name), nullptr) << name;
      EXPECT_EQ(to_json(*after.find(name)), to_json(value)) << name;
    }
    for (const auto& [name, value] : *before.find("options")->object()) {
      ASSERT_NE(after.find("options")->find(name), nullptr) << name;
      EXPECT_EQ(to_json(*after.find("options")->find(name)), to_json(value)) << name;
    }
  }
}

TEST(Recipe, DefaultsAreTheDocumentedOnes) {
  const Recipe recipe = parse(
      R"({"version": 1, "edits": [{"operator": "smooth", "view": "left", "options": {"sigma": 1}}]})");
  const Edit& edit = recipe.edits.at(0);
  EXPECT_EQ(edit.mode, EditMode::View);
  EXPECT_EQ(edit.details, DetailsRule::Keep);
  EXPECT_EQ(edit.curvature, CurvatureRule::Drop);
  EXPECT_EQ(edit.strength, 1.0F);
  EXPECT_EQ(edit.effective.full, 60.0F);
  EXPECT_EQ(edit.effective.zero, 75.0F);
  EXPECT_EQ(edit.window, ChartWindow::Strokes);
  EXPECT_FALSE(edit.spray);
  EXPECT_TRUE(edit.strokes.empty());
  EXPECT_EQ(std::get<NamedView>(edit.view), NamedView::Left);
  EXPECT_EQ(edit.path, "r.json: edits[0]");
  EXPECT_EQ(to_json(to_value(parse(to_json(to_value(recipe))))), to_json(to_value(recipe)));
}

TEST(Recipe, DescribeTellsAllOfEveryField) {
  const Value all = describe_operators();
  ASSERT_EQ(all.array()->size(), operator_types().size());
  for (const Value& one : *all.array()) {
    EXPECT_FALSE(one.find("summary")->text()->empty());
    EXPECT_FALSE(one.find("strokes")->text()->empty());
    for (const Value& field : *one.find("options")->array()) {
      const std::string name = *one.find("operator")->text() + "." + *field.find("name")->text();
      EXPECT_GE(field.find("help")->text()->size(), 15U) << name;
      EXPECT_NE(field.find("required") != nullptr, field.find("default") != nullptr) << name;
      const std::string type = *field.find("type")->text();
      if (type == "number") {
        ASSERT_NE(field.find("unit"), nullptr) << name;
        ASSERT_NE(field.find("range"), nullptr) << name;
        EXPECT_LT(*field.find("range")->array()->at(0).number(),
                  *field.find("range")->array()->at(1).number());
      } else if (type == "name") {
        EXPECT_GE(field.find("names")->array()->size(), 2U) << name;
      }
    }
  }
}

TEST(Recipe, FieldsThatDescribeCallsRequiredAreRequired) {
  for (const OperatorType& type : operator_types()) {
    for (const Value& field : type.fields()) {
      if (field.find("required") == nullptr) continue;
      // All required fields but this one.
      Value::Object options;
      for (const Value& other : type.fields()) {
        const std::string& name = *other.find("name")->text();
        if (other.find("required") == nullptr || name == *field.find("name")->text()) continue;
        const std::string& type_of = *other.find("type")->text();
        options.emplace_back(name, type_of == "text"
                                       ? Value(name == "kernel" ? "blur.json" : "cone.png")
                                   : type_of == "numbers" ? Value(Value::Array{1})
                                                          : Value(1));
      }
      const Value value(options);
      try {
        type.make(FieldReader(value, "options"));
        ADD_FAILURE() << type.name << " does without " << *field.find("name")->text();
      } catch (const InvalidInput& e) {
        EXPECT_EQ(
            std::string(e.what()).find("options." + *field.find("name")->text() + " is missing"),
            0U)
            << e.what();
      }
    }
  }
}

}  // namespace
}  // namespace normalshop::test
