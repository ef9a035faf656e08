#include "document/picture_fixture.h"
#include "support/sanitized.h"

#include "normalshop/chart/details.h"
#include "normalshop/core/error.h"

/// Edits that displace along any fixed direction: "mode": {"along": [x, y, z]}.
namespace normalshop::test {
namespace {

constexpr int along_size = 128;

std::string along(const std::string& direction) {
  return R"(, "mode": {"along": )" + direction + "}";
}

std::string message_of(const std::function<void()>& run) {
  try {
    run();
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "no message";
}

const std::string along_pen =
    R"("operator": "pen", "options": {"profile": "bump", "width": 0.25, "height": 0.05},
       "strokes": [[[-0.15, -0.1], [0.15, 0.1]]], "view": "front")";

float farthest_normal(const NormalMap& a, const NormalMap& b) {
  float most = 0.0F;
  for (int y = 0; y < a.height(); ++y) {
    for (int x = 0; x < a.width(); ++x) {
      most = std::max(most, (a.normal(x, y) - b.normal(x, y)).norm());
    }
  }
  return most;
}

TEST(AlongEdit, is_read_and_written) {
  const std::string recipe =
      R"({"version": 1, "edits": [{)" + along_pen + along("[0.5, -2, 3]") + "}]}";
  const Edit read = parse(recipe).edits.at(0);
  EXPECT_EQ(read.mode, EditMode::Along);
  EXPECT_EQ(read.along, Vec3f(0.5F, -2, 3));
  const std::string text = to_json(to_value(parse(recipe)));
  EXPECT_EQ(to_json(to_value(parse(text))), text);
  EXPECT_NE(text.find("along"), std::string::npos);
}

TEST(AlongEdit, says_what_is_accepted) {
  const auto message = [](const std::string& mode) {
    return message_of([&] { edit(along_pen + R"(, "mode": )" + mode); });
  };
  EXPECT_EQ(message("7"),
            "r.json: edits[0].mode must be view or base, or an object with \"along\", not the "
            "number 7");
  EXPECT_EQ(message("{}"),
            "r.json: edits[0].mode.along is missing; it must be three numbers [x, y, z]");
  EXPECT_EQ(message(R"({"along": [0, 0, 0]})"),
            "r.json: edits[0].mode.along must be a direction [x, y, z] of a length of at least "
            "1e-6, not a list of 3");
  EXPECT_NE(message(R"({"along": [0, 0]})"), "no message");
  EXPECT_NE(message(R"({"along": [0, 0, 1], "up": [0, 1, 0]})"), "no message");
  EXPECT_NE(message(R"("along")"), "no message");
}

TEST(AlongEdit, along_the_view_is_the_mode_view) {
  const Document before = hemisphere_document(along_size);
  for (const char* details : {"keep", "ignore"}) {
    const std::string fields = along_pen + R"(, "details": ")" + details + "\"";
    Document view = before;
    Document fixed = before;
    const EditReport a = view.apply(edit(fields));
    const EditReport b = fixed.apply(edit(fields + along("[0, 0, 7]")));
    EXPECT_EQ(a.pushed.changed, b.pushed.changed);
    EXPECT_GT(a.pushed.largest_change, 10.0F);
    EXPECT_LT(farthest_normal(map_of(view), map_of(fixed)), 2e-5F);
  }
}

TEST(AlongEdit, along_its_normal_is_the_mode_base_on_a_plane) {
  const std::string fields =
      R"("operator": "smooth", "options": {"sigma": 0.02}, "view": {"direction": [0.3, 0.2, 1]})";
  Document base = document(plane_grid(2), noise_map(along_size, CodeType::U16));
  Document fixed = base;
  base.apply(edit(fields + R"(, "mode": "base")"));
  fixed.apply(edit(fields + along("[0, 0, 1]")));
  EXPECT_GT(map_of(base).edited_count(), 10000U);
  EXPECT_LT(farthest_normal(map_of(base), map_of(fixed)), 2e-5F);
}

TEST(AlongEdit, what_changes_nothing_keeps_every_code) {
  Document plane = document(plane_grid(2), noise_map(along_size, CodeType::U8));
  for (
      const char* fields :
      {R"("operator": "pen", "options": {"width": 0.2, "height": 0}, "strokes": [[[0, 0], [1, 0]]])",
       R"("operator": "smooth", "options": {"sigma": 0})",
       R"("operator": "smooth", "options": {"sigma": 0.1}, "strength": 0)"}) {
    plane.apply(edit(std::string(fields) + R"(, "view": "front")" + along("[0.5, 0.2, 1]")));
  }
  EXPECT_EQ(map_of(plane).edited_count(), 0U);
}

TEST(AlongEdit, a_direction_into_the_surface_is_an_error) {
  Document plane = flat_plane(along_size);
  EXPECT_EQ(message_of([&] { plane.apply(edit(along_pen + along("[0.2, 0, -1]"))); }),
            "r.json: edits[0].mode.along must point out of surface that the edit's view shows, as "
            "from inside the model towards the eye: none there faces it");
  EXPECT_NE(message_of([&] { plane.apply(edit(along_pen + along("[1, 0, 0.01]"))); }),
            "no message");
  const std::string everywhere =
      R"("operator": "smooth", "options": {"sigma": 0.1}, "view": "surface")";
  EXPECT_NE(message_of([&] { plane.apply(edit(everywhere + along("[0, 0, -1]"))); }), "no message");
  EXPECT_EQ(plane.log().size(), 0U);
}

TEST(AlongEdit, mirrors_its_direction) {
  const auto asymmetry = [](const NormalMap& map) {
    float most = 0.0F;
    for (int y = 0; y < along_size; ++y) {
      for (int x = 0; x < along_size; ++x) {
        const Vec3f other = map.normal(along_size - 1 - x, y);
        most =
            std::max(most, degrees_between(map.normal(x, y), {-other.x(), other.y(), other.z()}));
      }
    }
    return most;
  };
  const std::string fields =
      R"("operator": "pen", "view": {"direction": [0.5, 0.1, 1], "center": [0.3, 0.1, 0.8], "width": 1.2},
         "options": {"profile": "bump", "width": 0.2, "height": 0.05},
         "strokes": [[[-0.1, -0.15], [0.15, 0.1]]])" +
      along("[0.8, 0.3, 0.6]");
  Document sides = hemisphere_document(along_size);
  const float before = asymmetry(map_of(sides));
  Document once = sides;
  once.apply(edit(fields));
  sides.apply(edit(fields + R"(, "mirror": "x")"));
  EXPECT_GT(asymmetry(map_of(once)), 5.0F);
  EXPECT_LT(asymmetry(map_of(sides)), before + 0.5F);
}

/// Of the whole surface, what faces the direction changes; what turns away keeps its codes.
TEST(AlongEdit, reaches_the_surface_that_faces_it) {
  NORMALSHOP_SKIP_FIGURES();
  Document sphere = document(uv_sphere(48, 24), noise_map(along_size, CodeType::U16));
  const EditReport report =
      sphere.apply(edit(R"("operator": "smooth", "options": {"sigma": 0.05}, "view": "surface")" +
                        along("[0, 1, 0]")));
  EXPECT_GT(report.pushed.changed, 1000U);
  for (int y = 0; y < along_size; ++y) {
    for (int x = 2; x < along_size - 2; ++x) {
      // uv_sphere: v runs from the pole at the top down.
      const float degrees_from_top = 180.0F * (static_cast<float>(y) + 0.5F) / along_size;
      if (degrees_from_top > 78.0F) {
        ASSERT_FALSE(map_of(sphere).edited(x, y)) << x << ", " << y;
      }
    }
  }
  EXPECT_TRUE(map_of(sphere).edited(along_size / 2, along_size / 4));
}

const std::string picture_pen =
    R"("operator": "pen", "options": {"profile": "bump", "width": 30, "height": 6},
       "strokes": [[[-300, 0], [300, 0]]], "view": "front")";

/// A ridge over the plane of a picture, pushed over sideways: (x, y, 0) + h(y) d.
TEST(AlongEdit, leans_relief_in_pictures) {
  ImageDocument leaning = picture(SlopeImage(64, 64, Vec2f(0, 0)));
  leaning.apply(edit(picture_pen + along("[0.1, 0.6, 1]")));
  const Vec3f d = Vec3f(0.1F, 0.6F, 1).normalized();
  float most = 0.0F;
  float lean = 0.0F;
  for (int y = 0; y < 64; ++y) {
    const float h_v = bump_slope(6, 15, 31.5F - static_cast<float>(y));
    const Vec3f truth = Vec3f::UnitX().cross(Vec3f(Vec3f::UnitY() + h_v * d));
    most = std::max(most, degrees_between(leaning.normals().normal(32, y), truth));
    lean = std::max(lean, degrees_between(truth, Vec3f(0, -h_v, 1)));
  }
  EXPECT_LT(most, 0.05F);
  EXPECT_GT(lean, 5.0F);
}

TEST(AlongEdit, straight_out_of_a_picture_is_the_mode_view) {
  const SlopeImage source = waves(64, 64, 3, 0.5F);
  ImageDocument view = picture(source);
  ImageDocument fixed = picture(source);
  const std::string smooth = R"("operator": "smooth", "options": {"sigma": 3}, "view": "front")";
  view.apply(edit(smooth));
  fixed.apply(edit(smooth + along("[0, 0, 2]")));
  EXPECT_LT(farthest(view, slopes_of(fixed).slopes), 1e-5F);
  EXPECT_EQ(message_of([&] { fixed.apply(edit(smooth + along("[0, 1, 0.1]"))); }),
            "r.json: edits[0].mode.along must point out of the picture: its z must be above 0, and "
            "the angle to [0, 0, 1] below 75 degrees");
}

}  // namespace
}  // namespace normalshop::test
