#include "document/fake_assets.h"
#include <gtest/gtest.h>

#include "normalshop/core/error.h"
#include "normalshop/document/edit.h"

namespace normalshop {
namespace {

std::string recipe_message(const std::string& json) {
  test::FakeAssets assets;
  try {
    parse_recipe(json, "r.json", assets);
  } catch (const InvalidInput& e) {
    return e.what();
  }
  return "accepted";
}

std::string message_of_edit(const std::string& edit) {
  return recipe_message(R"({"version": 1, "edits": [)" + edit + "]}");
}

std::string pen(const std::string& options,
                const std::string& rest = R"("strokes": [[[0, 0], [1, 1]]])") {
  return message_of_edit(R"({"operator": "pen", "view": "front", "options": )" + options + ", " +
                         rest + "}");
}

std::string operator_names() {
  std::vector<std::string_view> names;
  for (const OperatorType& type : operator_types()) names.push_back(type.name);
  return join_names(names);
}

const std::string good_pen = R"({"width": 1, "height": 1})";

TEST(RecipeMessages, TheFrame) {
  EXPECT_EQ(recipe_message("[]"), "r.json: must be an object with fields, not a list of 0");
  EXPECT_EQ(recipe_message(R"({"edits": []})"), "r.json: version is missing; it must be a number");
  EXPECT_EQ(recipe_message(R"({"version": 2, "edits": []})"),
            "r.json: version must be 1, the version that this program reads, not the number 2");
  EXPECT_EQ(recipe_message(R"({"version": 1})"), "r.json: edits is missing; it must be a list");
  EXPECT_EQ(recipe_message(R"({"version": 1, "edits": {}})"),
            "r.json: edits must be a list, not an object");
  EXPECT_EQ(recipe_message(R"({"version": 1, "edits": [], "author": 1})"),
            "r.json: there is no field \"author\"; it may be version, edits or comment");
  EXPECT_EQ(recipe_message(R"({"version": 1, "edits": []})"), "accepted");
}

TEST(RecipeMessages, AnEdit) {
  EXPECT_EQ(message_of_edit("7"),
            "r.json: edits[0] must be an object with fields, not the number 7");
  EXPECT_EQ(message_of_edit(R"({"view": "front"})"),
            "r.json: edits[0].operator is missing; it must be " + operator_names());
  EXPECT_EQ(message_of_edit(R"({"operator": "carve", "view": "front"})"),
            "r.json: edits[0].operator must be " + operator_names() + ", not the text \"carve\"");
  EXPECT_EQ(message_of_edit(R"({"operator": "smooth", "options": {"sigma": 1}})"),
            "r.json: edits[0].view is missing; it must be front, back, left, right, top, bottom or "
            "surface, "
            "or an object with \"direction\", \"facing\" or \"surface\"");
  EXPECT_EQ(pen(good_pen, R"("strength": 2)"),
            "r.json: edits[0].strength must be a number from 0 to 1, not the number 2");
  EXPECT_EQ(pen(good_pen, R"("mode": "normal")"),
            "r.json: edits[0].mode must be view or base, not the text \"normal\"");
  EXPECT_EQ(pen(good_pen, R"("curvature": "keep")"),
            "r.json: edits[0].curvature must be drop where the mode is not base, not the text "
            "\"keep\"");
  EXPECT_EQ(pen(good_pen, R"("details": false)"),
            "r.json: edits[0].details must be keep or ignore, not false");
  EXPECT_EQ(pen(good_pen, R"("effective": {"full": 80})"),
            "r.json: edits[0].effective.full must be below zero, which is 75 degrees");
  EXPECT_EQ(pen(good_pen, R"("spray": {"zero": 91})"),
            "r.json: edits[0].spray.zero must be a number from 1 to 90, not the number 91");
  EXPECT_EQ(
      pen(good_pen, R"("colour": 1)"),
      "r.json: edits[0]: there is no field \"colour\"; it may be operator, view, mode, "
      "curvature, details, strength, effective, spray, window, options, strokes, mirror, part or "
      "comment");
}

TEST(RecipeMessages, Options) {
  EXPECT_EQ(pen(R"({"width": "wide", "height": 1})"),
            "r.json: edits[0].options.width must be a number from 0 to 1000000, not the text "
            "\"wide\"");
  EXPECT_EQ(pen(R"({"width": -1, "height": 1})"),
            "r.json: edits[0].options.width must be a number from 0 to 1000000, not the number -1");
  EXPECT_EQ(pen(R"({"height": 1})"),
            "r.json: edits[0].options.width is missing; it must be a number from 0 to 1000000");
  EXPECT_EQ(pen(R"({"width": null, "height": 1})"),
            "r.json: edits[0].options.width must be a number from 0 to 1000000, not null");
  EXPECT_EQ(
      pen(R"({"width": 1, "height": 1, "depth": 1})"),
      "r.json: edits[0].options: there is no field \"depth\"; it may be profile, curve, width, "
      "height, closed, taper, pressure or smooth");
  EXPECT_EQ(pen("3"), "r.json: edits[0].options must be an object with fields, not the number 3");
  EXPECT_EQ(message_of_edit(R"({"operator": "smooth", "view": "front"})"),
            "r.json: edits[0].options.sigma is missing; it must be a number from 0 to 1000000");
  EXPECT_EQ(pen(R"({"width": 1, "height": 1, "closed": 1})"),
            "r.json: edits[0].options.closed must be true or false, not the number 1");
  EXPECT_EQ(pen(R"({"width": NaN, "height": 1})").substr(0, 38),
            "r.json: line 1: not valid JSON: invali");
}

TEST(RecipeMessages, OptionsOfEachOperator) {
  EXPECT_EQ(pen(R"({"width": 1, "height": 1, "profile": "step"})"),
            "r.json: edits[0].options.closed must be true for the profile \"step\"");
  EXPECT_EQ(pen(R"({"width": 1, "height": 1, "profile": "custom"})"),
            "r.json: edits[0].options.curve is missing; it must be a list");
  EXPECT_EQ(
      pen(R"({"width": 1, "height": 1, "profile": "custom", "curve": [[0, 1], [2, 1]]})"),
      "r.json: edits[0].options.curve[1] must be [u, height] with u from -1 to 1, not a list of "
      "2");
  EXPECT_EQ(
      pen(R"({"width": 1, "height": 1, "profile": "custom", "curve": [[0, 1], [0, 2]]})"),
      "r.json: edits[0].options.curve must be points [u, height] with increasing u, not a list "
      "of 2");
  const auto other = [](const std::string& name, const std::string& options) {
    return message_of_edit(R"({"operator": ")" + name + R"(", "view": "front", "options": )" +
                           options + R"(, "strokes": [[[0, 0]]]})");
  };
  EXPECT_EQ(other("stamp", R"({"size": 1})"),
            "r.json: edits[0].options.patch is missing; it must be a text");
  EXPECT_EQ(other("stamp", R"({"patch": "cone.png"})"),
            "r.json: edits[0].options.size is missing; it must be a number from 0 to 1000000");
  EXPECT_EQ(other("stamp", R"({"patch": "cone.png", "size": 0})"),
            "r.json: edits[0].options.size must be a number above 0, not the number 0");
  EXPECT_EQ(other("stamp", R"({"patch": "x.png", "size": 1})"),
            "r.json: edits[0].options.patch: x.png: cannot be read: there is no such file");
  EXPECT_EQ(other("stamp", R"({"patch": "cone.png", "size": 1, "scale_x": 0})"),
            "r.json: edits[0].options.scale_x must be a scale that is not 0, not the number 0");
  EXPECT_EQ(other("stamp", R"({"patch": "cone.png", "size": 1, "high_pass": 1.5})"),
            "r.json: edits[0].options.high_pass must be a number from 0 to 1, not the number 1.5");
  EXPECT_EQ(other("combine", "{}"), "r.json: edits[0].options.image is missing; it must be a text");
  EXPECT_EQ(other("combine", R"({"image": ""})"),
            "r.json: edits[0].options.image must be the name of a file, not the text \"\"");
  EXPECT_EQ(other("combine", R"({"image": "cone.png", "scale_y": 0})"),
            "r.json: edits[0].options.scale_y must be a scale that is not 0, not the number 0");
  EXPECT_EQ(other("combine", R"({"image": "cone.png", "area": "brush"})"),
            "r.json: edits[0].options.brush is missing; it must be a number above 0 for the area "
            "\"brush\"");
  EXPECT_EQ(other("combine", R"({"image": "cone.png"})"),
            "r.json: edits[0].strokes must be left out for the area \"view\"; all other areas "
            "take strokes");
  EXPECT_EQ(other("transplant", R"({"sigma": 1})"),
            "r.json: edits[0].options.image is missing; it must be a text");
  EXPECT_EQ(other("transplant", R"({"image": "cone.png"})"),
            "r.json: edits[0].options.sigma is missing; it must be a number from 0 to 1000000");
  EXPECT_EQ(other("transplant", R"({"image": "", "sigma": 1})"),
            "r.json: edits[0].options.image must be the name of a file, not the text \"\"");
  EXPECT_EQ(other("transplant", R"({"image": "x.png", "sigma": 1})"),
            "r.json: edits[0].options.image: x.png: cannot be read: there is no such file");
  EXPECT_EQ(other("text", R"({"text": "", "size": 1, "height": 1, "bevel": 1})"),
            "r.json: edits[0].options.text must be a text that is not empty, not the text \"\"");
  EXPECT_EQ(other("smooth", R"({"sigma": 1, "area": "brush"})"),
            "r.json: edits[0].options.brush is missing; it must be a number above 0 for the area "
            "\"brush\"");
  EXPECT_EQ(other("sharpen", R"({"sigma": 1, "noise_sigma": 1})"),
            "r.json: edits[0].options.noise_sigma must be a number below sigma, not the number 1");
  EXPECT_EQ(other("filter", R"({"kind": "high_pass"})"),
            "r.json: edits[0].options.sigma is missing; it must be a number from 0 to 1000000 for "
            "all kinds but \"scale\"");
  EXPECT_EQ(other("filter", R"({"kind": "edge_enhance", "sigma": 1, "noise_sigma": 1})"),
            "r.json: edits[0].options.noise_sigma must be a number below sigma, not the number 1");
  EXPECT_EQ(other("denoise", "{}"),
            "r.json: edits[0].options.sigma is missing; it must be a number from 0 to 1000000");
  EXPECT_EQ(other("denoise", R"({"sigma": 1, "method": "median"})"),
            "r.json: edits[0].options.method must be bilateral, rolling or transform, not the text "
            "\"median\"");
  EXPECT_EQ(other("filter", R"({"kind": "median", "sigma": 1})"),
            "r.json: edits[0].options.kind must be gaussian, high_pass, band_pass, "
            "laplacian_of_gaussian, unsharp, edge_enhance or scale, not the text \"median\"");
  EXPECT_EQ(other("equalize", R"({"gains": [1]})"),
            "r.json: edits[0].options.sigma is missing; it must be a number from 0 to 1000000");
  EXPECT_EQ(other("equalize", R"({"sigma": 0, "gains": [1]})"),
            "r.json: edits[0].options.sigma must be a number above 0, not the number 0");
  EXPECT_EQ(other("equalize", R"({"sigma": 1})"),
            "r.json: edits[0].options.gains is missing; it must be a list");
  EXPECT_EQ(other("equalize", R"({"sigma": 1, "gains": "1,2"})"),
            "r.json: edits[0].options.gains must be a list, not the text \"1,2\"");
  EXPECT_EQ(other("equalize", R"({"sigma": 1, "gains": []})"),
            "r.json: edits[0].options.gains must be a list of 1 to 16 numbers, not a list of 0");
  EXPECT_EQ(other("equalize", R"({"sigma": 1, "gains": [1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1]})"),
            "r.json: edits[0].options.gains must be a list of 1 to 16 numbers, not a list of 17");
  EXPECT_EQ(other("equalize", R"({"sigma": 1, "gains": [0, 101]})"),
            "r.json: edits[0].options.gains[1] must be a number from -100 to 100, not the number "
            "101");
}

TEST(RecipeMessages, Strokes) {
  const auto strokes = [](const std::string& text) {
    return pen(good_pen, R"("strokes": )" + text);
  };
  EXPECT_EQ(strokes("[[[1]]]"),
            "r.json: edits[0].strokes[0][0] must be [x, y] or [x, y, pressure], not a list of 1");
  EXPECT_EQ(strokes("[[[0, 0], [1, 2, 1, 4]]]"),
            "r.json: edits[0].strokes[0][1] must be [x, y] or [x, y, pressure], not a list of 4");
  EXPECT_EQ(strokes("[[0, 0]]"),
            "r.json: edits[0].strokes[0][0] must be [x, y] or [x, y, pressure], not the number 0");
  EXPECT_EQ(strokes("[[[0, 0, 2]]]"),
            "r.json: edits[0].strokes[0][0][2] must be a number from 0 to 1, not the number 2");
  EXPECT_EQ(
      strokes("[[[0, null]]]"),
      "r.json: edits[0].strokes[0][0][1] must be a number from -1000000000 to 1000000000, not "
      "null");
  EXPECT_EQ(
      strokes("[[[0, 1e300]]]"),
      "r.json: edits[0].strokes[0][0][1] must be a number from -1000000000 to 1000000000, not "
      "the number 1e+300");
  EXPECT_EQ(strokes("[[]]"),
            "r.json: edits[0].strokes[0] must be a list of at least one point, not a list of 0");
  EXPECT_EQ(strokes("[]"),
            "r.json: edits[0].strokes must have at least one list of points [x, y] for the pen");
  EXPECT_EQ(pen(R"({"width": 1, "height": 1, "closed": true})"),
            "r.json: edits[0].strokes[0] must have at least 3 points, because the pen's stroke is "
            "closed");
  const auto smooth = [](const std::string& area, const std::string& text) {
    return message_of_edit(
        R"({"operator": "smooth", "view": "front", "options": {"sigma": 1, "area": ")" + area +
        R"(", "brush": 1}, "strokes": )" + text + "}");
  };
  EXPECT_EQ(smooth("view", "[[[0, 0]]]"),
            "r.json: edits[0].strokes must be left out for the area \"view\"; all other areas "
            "take strokes");
  EXPECT_EQ(smooth("inside", "[]"),
            "r.json: edits[0].strokes must have at least one list of points [x, y] for the area "
            "\"inside\"");
  EXPECT_EQ(smooth("inside", "[[[0, 0], [1, 1]]]"),
            "r.json: edits[0].strokes[0] must have at least 3 points to enclose an area");
}

TEST(RecipeMessages, Views) {
  const auto view = [](const std::string& text) {
    return message_of_edit(R"({"operator": "smooth", "options": {"sigma": 1}, "view": )" + text +
                           "}");
  };
  EXPECT_EQ(view("\"up\""),
            "r.json: edits[0].view must be front, back, left, right, top, bottom or surface, not "
            "the text "
            "\"up\"");
  EXPECT_EQ(view("{}"),
            "r.json: edits[0].view.direction is missing; it must be three numbers [x, y, z]");
  EXPECT_EQ(view(R"({"direction": [0, 0, 0]})"),
            "r.json: edits[0].view.direction must be a direction [x, y, z] of a length of at least "
            "1e-6, not a list of 3");
  EXPECT_EQ(view(R"({"direction": [0, 1]})"),
            "r.json: edits[0].view.direction must be three numbers [x, y, z], not a list of 2");
  EXPECT_EQ(view(R"({"direction": [0, 0, 1], "center": [0, 0, 0]})"),
            "r.json: edits[0].view.width is missing; it must be a number from 1e-09 to 1000000000");
  EXPECT_EQ(view(R"({"facing": [0, 0, 1], "width": 0})"),
            "r.json: edits[0].view.width must be a number from 1e-09 to 1000000000, not the number "
            "0");
  EXPECT_EQ(view(R"({"facing": [0, 0, 1], "width": 1, "up": [0, 1, 0]})"),
            "r.json: edits[0].view: there is no field \"up\"; it may be facing, width or height");
}

}  // namespace
}  // namespace normalshop
