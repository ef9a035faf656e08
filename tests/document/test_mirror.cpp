#include "document/edit_fixture.h"

#include "normalshop/core/error.h"

/// Edits made on both sides of a plane of symmetry.
namespace normalshop::test {
namespace {

constexpr int map_size = 128;

/// The largest angle between normals and the mirror images of those on the other side of the middle
/// column.
float asymmetry(const NormalMap& map) {
  float most = 0.0F;
  for (int y = 0; y < map_size; ++y) {
    for (int x = 0; x < map_size; ++x) {
      const Vec3f other = map.normal(map_size - 1 - x, y);
      most = std::max(most, degrees_between(map.normal(x, y), {-other.x(), other.y(), other.z()}));
    }
  }
  return most;
}

const std::string& stroke() {
  static const std::string fields =
      R"("operator": "pen", "view": {"direction": [0.5, 0.1, 1], "center": [0.3, 0.1, 0.8], "width": 1.2},
         "options": {"profile": "crease", "width": 0.2, "height": 0.05},
         "strokes": [[[-0.1, -0.15], [0.15, 0.1], [0.1, 0.25]]])";
  return fields;
}

TEST(Mirror, MakesBothSidesAlike) {
  Document d = hemisphere_document(map_size);
  const float before = asymmetry(map_of(d));
  Document once = d;
  const EditReport one = once.apply(edit(stroke()));
  const EditReport both = d.apply(edit(stroke() + R"(, "mirror": "x")"));
  EXPECT_GT(asymmetry(map_of(once)), 5.0F);
  EXPECT_LT(asymmetry(map_of(d)), before + 0.5F);
  EXPECT_NEAR(static_cast<double>(both.pushed.changed),
              2.0 * static_cast<double>(one.pushed.changed),
              0.02 * static_cast<double>(one.pushed.changed));
  EXPECT_EQ(d.log().size(), 1U);
}

TEST(Mirror, LettersAndPatchesAreMirrored) {
  Document d = document(plane_grid(2), flat_normal_map(map_size, map_size, CodeType::F32));
  d.apply(edit(R"("operator": "stamp", "view": {"direction": [0, 0, 1], "center": [0.25, 0.5, 0],
                  "width": 0.4}, "options": {"patch": "slanted.png", "size": 0.2, "rotation": 30},
                  "strokes": [[[0, 0]]], "mirror": {"axis": "x", "at": 0.5})"));
  EXPECT_GT(map_of(d).edited_count(), 500U);
  EXPECT_LT(asymmetry(map_of(d)), 1e-2F);
}

TEST(Mirror, BothSidesSeeWhatWasThere) {
  // Over the middle a flattened stroke meets its image; the second one still finds the details.
  Document d = document(plane_grid(2), noise_map(map_size, CodeType::U16));
  const std::string flat = R"("operator": "flatten", "strength": 0.5, "view": "front",
      "options": {"area": "brush", "brush": 0.3}, "strokes": [[[0, -0.2], [0, 0.2]]])";
  Document twice = d;
  d.apply(edit(flat + R"(, "mirror": {"axis": "x", "at": 0.5})"));
  twice.apply(edit(flat));
  twice.apply(edit(flat));
  float left = 0.0F;
  float left_twice = 0.0F;
  for (int y = 50; y < 78; ++y) {
    left = std::max(left, degrees_between(map_of(d).normal(64, y), Vec3f::UnitZ()));
    left_twice = std::max(left_twice, degrees_between(map_of(twice).normal(64, y), Vec3f::UnitZ()));
  }
  EXPECT_LT(left, 0.2F);  // half and half of the same
  EXPECT_GT(left_twice, 2.0F);
}

TEST(Mirror, ASideWithoutSurfaceStopsTheWholeEdit) {
  Document d = flat_plane(map_size);
  try {
    d.apply(edit(R"("operator": "pen", "view": "front", "options": {"width": 0.1, "height": 0.02},
                    "strokes": [[[0.1, 0], [0.2, 0]]], "mirror": "x")"));
    FAIL() << "there is nothing where x is below 0";
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("edits[0]"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("mirror"), std::string::npos) << error.what();
  }
  EXPECT_EQ(map_of(d).edited_count(), 0U);
}

TEST(Mirror, IsReadAndWritten) {
  FakeAssets assets;
  const Recipe recipe = parse(R"({"version": 1, "edits": [{)" + stroke() +
                              R"(, "mirror": {"axis": "y", "at": -1.5}}]})");
  ASSERT_TRUE(recipe.edits[0].mirror.has_value());
  EXPECT_EQ(recipe.edits[0].mirror->axis, Axis::Y);
  EXPECT_EQ(recipe.edits[0].mirror->at, -1.5F);
  const std::string text = to_json(to_value(recipe));
  EXPECT_EQ(to_json(to_value(parse_recipe(text, "again", assets))), text);
  EXPECT_FALSE(edit(stroke()).mirror.has_value());
  for (const char* wrong :
       {R"("w")", "1", "{}", R"({"axis": "x", "offset": 1})", R"({"axis": "x", "at": "left"})"}) {
    EXPECT_THROW(edit(stroke() + R"(, "mirror": )" + wrong), InvalidInput) << wrong;
  }
}

}  // namespace
}  // namespace normalshop::test
