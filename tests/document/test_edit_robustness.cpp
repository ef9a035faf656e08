#include <chrono>

#include "document/edit_fixture.h"

namespace normalshop::test {
namespace {

std::string failure(Document& d, const std::string& fields) {
  try {
    d.apply(edit(fields));
  } catch (const InvalidInput& e) {
    return e.what();
  }
  return "applied";
}

const std::string off_plane =
    " lies off the surface that the view shows; points are in object units (in a picture: pixels) "
    "from the view's centre, "
    "x "
    "right and y up, and the surface spans x -0.5 to 0.5, y -0.5 to 0.5";

TEST(EditFailures, StrokesOffTheSurfaceAreNamed) {
  Document d = flat_plane(64);
  const std::string pen =
      R"("operator": "pen", "view": "front", "options": {"width": 0.1, "height": 1},)";
  EXPECT_EQ(failure(d, pen + R"("strokes": [[[0, 0]], [[3, 3], [4, 3]]])"),
            "r.json: edits[0].strokes[1]" + off_plane);
  EXPECT_EQ(failure(d, pen + R"("strokes": [[[3, 3], [4, 3]]])"),
            "r.json: edits[0].strokes" + off_plane);
  EXPECT_EQ(failure(d, pen + R"("strokes": [[[-2, 0], [2, 0]]])"), "applied");
  EXPECT_EQ(failure(d, R"("operator": "stamp", "view": "front", "strokes": [[[0, 0], [2, 0]]],
                          "options": {"patch": "cone.png", "size": 0.2})"),
            "r.json: edits[0].strokes[0][1]" + off_plane);
}

TEST(EditFailures, PointsBeyondAllReasonAreNamed) {
  Document d = flat_plane(64);
  EXPECT_EQ(
      failure(d, R"("operator": "pen", "view": "front", "options": {"width": 0.1, "height": 1},
                          "strokes": [[[0, 0], [1e6, 0]]])"),
      "r.json: edits[0].strokes[0][1] must lie within 104 object units of the centre of the "
      "view, which is 1.04 wide and 1.04 high");
}

TEST(EditFailures, AViewThatShowsNothingIsNamed) {
  Document d = flat_plane(64);
  const std::string smooth = R"("operator": "smooth", "options": {"sigma": 0.1}, "view": )";
  EXPECT_EQ(
      failure(d, smooth + R"("back")"),
      "r.json: edits[0].view must show surface that faces the viewer; \"direction\" points from "
      "the surface to the viewer");
  EXPECT_EQ(failure(d, smooth + R"({"direction": [0, 0, 1], "center": [9, 0, 0], "width": 1})")
                .substr(0, 35),
            "r.json: edits[0].view lies off the ");
  EXPECT_EQ(failure(d, smooth + R"({"direction": [0, 0, 1], "center": [1e9, 0, 0], "width": 1})")
                .substr(0, 21),
            "r.json: edits[0].view");
}

TEST(EditFailures, ChangeNothing) {
  const NormalMap original = noise_map(64, CodeType::U8);
  Document d = document(plane_grid(2), original);
  EXPECT_NE(
      failure(d, R"("operator": "pen", "view": "front", "options": {"width": 0.1, "height": 1},
                          "strokes": [[[0, 0], [0.1, 0]], [[3, 3]]])"),
      "applied");
  EXPECT_NE(failure(d, R"("operator": "smooth", "view": "back", "options": {"sigma": 0.1})"),
            "applied");
  EXPECT_TRUE(d.log().empty());
  EXPECT_FALSE(map_of(d).has_edits());
}

TEST(EditFailures, MapsMustBeAsManyAsTextureSets) {
  try {
    Document(plane_grid(1), {});
    ADD_FAILURE();
  } catch (const InvalidInput& e) {
    EXPECT_STREQ(e.what(), "the model has 1 texture sets but maps were given for 0");
  }
}

class Extremes : public testing::TestWithParam<const char*> {};

/// Whatever the numbers: done before the test times out, and what is left are unit normals.
TEST_P(Extremes, AreSurvived) {
  Document d = document(plane_grid(2), noise_map(256, CodeType::U8));
  const auto start = std::chrono::steady_clock::now();
  const EditReport report = d.apply(edit(GetParam()));
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  RecordProperty("seconds", std::to_string(seconds.count()));
  EXPECT_LE(report.chart_width, 300);
  EXPECT_LE(report.chart_height, 300);
  expect_unit_normals(map_of(d));
}

INSTANTIATE_TEST_SUITE_P(
    Edits, Extremes,
    testing::Values(
        R"("operator": "smooth", "view": "front", "options": {"sigma": 1e6})",
        R"("operator": "smooth", "view": "front", "options": {"sigma": 1e-30})",
        R"("operator": "sharpen", "view": "front", "options": {"sigma": 1e6, "noise_sigma": 1e5})",
        R"("operator": "sharpen", "view": "front", "options": {"sigma": 0.1, "amount": 100})",
        R"("operator": "filter", "view": "front",
           "options": {"kind": "laplacian_of_gaussian", "sigma": 1e6, "amount": 100})",
        R"("operator": "filter", "view": "front",
           "options": {"kind": "laplacian_of_gaussian", "sigma": 1e-30, "amount": -100})",
        R"("operator": "filter", "view": "front",
           "options": {"kind": "band_pass", "sigma": 1e6, "noise_sigma": 9e5})",
        R"("operator": "filter", "view": "front", "options": {"kind": "scale", "amount": -100})",
        R"("operator": "denoise", "view": "front",
           "options": {"method": "transform", "sigma": 1e6, "sigma_normal": 0})",
        R"("operator": "denoise", "view": "front", "options": {"sigma": 1e-30})",
        R"("operator": "equalize", "view": "front",
           "options": {"sigma": 1e6, "gains": [100, -100, 0, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 100],
           "base_gain": -100})",
        R"("operator": "equalize", "view": "front",
           "options": {"sigma": 1e-30, "gains": [-100, 100, -100]})",
        R"("operator": "smooth", "view": "front", "options": {"sigma": 0.1, "feather": 1e6})",
        R"("operator": "smooth", "view": {"direction": [0, 0, 1], "center": [0.5, 0.5, 0],
           "width": 0.1}, "options": {"sigma": 0.1, "feather": 1e6})",
        R"("operator": "smooth", "view": "front", "strokes": [[[0, 0]]],
           "options": {"sigma": 0.1, "area": "brush", "brush": 1e6, "hardness": 0})",
        R"("operator": "smooth", "view": "front", "strokes": [[[-9, -9], [9, -9], [9, 9], [-9, 9]]],
           "options": {"sigma": 0.1, "area": "inside"})",
        R"("operator": "pen", "view": "front", "strokes": [[[0, 0], [0.1, 0]]],
           "options": {"width": 1e6, "height": 1})",
        R"("operator": "pen", "view": "front", "strokes": [[[0, 0], [0.1, 0]]],
           "options": {"width": 0.1, "height": -1e6})",
        R"("operator": "pen", "view": "front", "strokes": [[[0, 0], [0.1, 0]]],
           "options": {"width": 1e-20, "height": 1e6})",
        R"("operator": "pen", "view": "front", "strokes": [[[0, 0], [0.1, 0]]],
           "options": {"width": 0.1, "height": 0.1, "taper": 1e6})",
        R"("operator": "pen", "view": "front", "strokes": [[[0, 0], [0, 0], [0, 0]]],
           "options": {"width": 0.1, "height": 0.1})",
        R"("operator": "pen", "view": "front", "strokes": [[[0, 0], [0, 0], [0, 0]]],
           "options": {"width": 0.1, "height": 0.1, "smooth": false, "taper": 0.1})",
        R"("operator": "pen", "view": "front", "strokes": [[[0, 0], [0, 0], [0, 0]]],
           "options": {"width": 0.1, "height": 0.1, "closed": true, "profile": "step"})",
        R"("operator": "pen", "view": "front", "strokes": [[[0, 0], [0.1, 0], [0, 0], [0.1, 0]]],
           "options": {"width": 0.1, "height": 0.1, "closed": true, "profile": "step",
           "smooth": false}, "details": "ignore", "mode": "base")",
        R"("operator": "pen", "view": "front", "strokes": [[[0, 0, 0], [0.1, 0, 0]]],
           "options": {"width": 0.1, "height": 0.1})",
        R"("operator": "pen", "view": {"facing": [0.5, 0.5, 0], "width": 1e-7},
           "strokes": [[[0, 0]]], "options": {"width": 1e-8, "height": 1e-8})",
        R"("operator": "smooth", "view": {"facing": [0.5, 0.5, 0], "width": 1e-9},
           "options": {"sigma": 1})",
        R"("operator": "smooth", "view": {"direction": [0, 0, 1], "width": 1e9},
           "options": {"sigma": 1})",
        R"("operator": "text", "view": "front", "strokes": [[[0, 0]]],
           "options": {"text": "I", "size": 1e6, "height": 1e6, "bevel": 1e6})",
        R"("operator": "text", "view": "front", "strokes": [[[0, 0]]],
           "options": {"text": "I", "size": 0, "height": 1, "bevel": 0})",
        R"("operator": "stamp", "view": "front", "strokes": [[[0, 0]]],
           "options": {"patch": "cone.png", "size": 1e6, "relief": 100, "scale_x": 100})",
        R"("operator": "stamp", "view": "front", "strokes": [[[0, 0]]],
           "options": {"patch": "cone.png", "size": 1e-20, "shear": 10})",
        R"("operator": "stamp", "view": "front", "strokes": [[[0, 0]]],
           "options": {"patch": "slanted.png", "size": 0.5, "relief": -100, "high_pass": 1})",
        R"("operator": "stamp", "view": "front", "strokes": [[[0, 0]]],
           "options": {"patch": "slanted.png", "size": 0.5, "high_pass": 1e-30})",
        R"("operator": "combine", "view": "front", "options": {"image": "cone.png", "size": 1e6,
           "relief": 100})",
        R"("operator": "combine", "view": "front", "options": {"image": "cone.png", "size": 1e-40})",
        R"("operator": "convolve", "view": "front",
           "options": {"kernel": "edge.json", "pixel": 1e-30})",
        R"("operator": "convolve", "view": "front",
           "options": {"kernel": "shift.json", "pixel": 0.2})",
        R"("operator": "transplant", "view": "front", "details": "ignore",
           "options": {"image": "cone.png", "size": 1e6, "relief": 100, "sigma": 1e6})",
        R"("operator": "transplant", "view": "front", "options": {"image": "cone.png",
           "size": 1e-30, "repeat": true, "scale_y": 1e-5, "relief": -100, "sigma": 1e-30})",
        R"("operator": "combine", "view": "front", "mode": "base", "details": "ignore",
           "options": {"image": "cone.png", "size": 1e-30, "repeat": true, "scale_x": 100,
           "scale_y": 1e-5, "shear": 10, "relief": -100})",
        R"("operator": "combine", "view": "front", "details": "ignore", "options": {
           "image": "cone.png", "size": 1e-3, "repeat": true, "relief": 100, "model": "rotation"})",
        R"("operator": "combine", "view": "front", "options": {"image": "cone.png", "relief": -100,
           "scale_x": 1e-3, "model": "overlay"})",
        R"("operator": "combine", "view": {"direction": [0, 0, 1], "width": 1e9},
           "options": {"image": "cone.png", "repeat": true})",
        R"("operator": "combine", "view": {"facing": [0.5, 0.5, 0], "width": 1e-9},
           "options": {"image": "cone.png", "repeat": true})"));

TEST(EditRobustness, TenThousandPoints) {
  std::string points;
  for (int i = 0; i < 10000; ++i) {
    const double t = i / 10000.0;
    points += (i > 0 ? ", [" : "[") + std::to_string(0.45 * t * std::cos(60 * t)) + ", " +
              std::to_string(0.45 * t * std::sin(60 * t)) + "]";
  }
  const auto start = std::chrono::steady_clock::now();
  Document d = flat_plane(128);
  d.apply(edit(R"("operator": "pen", "view": "front", "options": {"width": 0.005, "height": 0.001},
                  "strokes": [[)" +
               points + "]]"));
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  RecordProperty("seconds", std::to_string(seconds.count()));
  EXPECT_GT(map_of(d).edited_count(), 1000U);
  expect_unit_normals(map_of(d));
}

TEST(EditRobustness, AHugeSigmaTakesTheMeanOfTheModel) {
  Document d = document(plane_grid(2), noise_map(256, CodeType::U16));
  d.apply(edit(R"("operator": "smooth", "view": "front", "options": {"sigma": 1000})"));
  Vec2f mean(0.0F, 0.0F);
  for (int y = 0; y < 256; ++y) {
    for (int x = 0; x < 256; ++x) mean += map_of(d).normal(x, y).head<2>() / 65536.0F;
  }
  for (int y = 0; y < 256; y += 5) {
    for (int x = 0; x < 256; x += 5) {
      EXPECT_LT((map_of(d).normal(x, y).head<2>() - mean).norm(), 0.02F) << x << ", " << y;
    }
  }
}

}  // namespace
}  // namespace normalshop::test
