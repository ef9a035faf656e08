#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "io/temp_folder.h"
#include "support/same_codes.h"
#include "support/udim_plane.h"
#include <gtest/gtest.h>

#include "normalshop/core/error.h"
#include "normalshop/core/slope.h"
#include "normalshop/io/edit_report.h"
#include "normalshop/io/file_assets.h"
#include "normalshop/io/image_file.h"
#include "normalshop/io/model_info.h"
#include "normalshop/io/udim.h"

/// Models over several UDIM tiles.
namespace normalshop::test {
namespace {

namespace fs = std::filesystem;

constexpr std::array<int, 4> plane_tiles{1001, 1002, 1011, 1012};

/// Waves that go on over the tiles' borders, and differ at the opposite borders of a tile.
RawImage tile_codes(int tile, int texels, CodeType type) {
  NormalMap map = flat_normal_map(texels, texels, type);
  const float u0 = tile % 2 == 1 ? 0.0F : 1.0F;
  const float v0 = tile > 1010 ? 1.0F : 0.0F;
  for (int y = 0; y < texels; ++y) {
    for (int x = 0; x < texels; ++x) {
      const float u = u0 + (static_cast<float>(x) + 0.5F) / static_cast<float>(texels);
      const float v = v0 + 1.0F - (static_cast<float>(y) + 0.5F) / static_cast<float>(texels);
      map.set_normal(x, y, normal_from_slope({0.4F * std::sin(2.0F * u), 0.3F * std::cos(v)}));
    }
  }
  return map.encode();
}

class Udim : public testing::Test {
 protected:
  /// The plane with its four maps, of two types.
  void write(const std::string& pattern, const std::string& map_line, int n = 8) {
    for (const int tile : plane_tiles) {
      write_image(tile_path(folder_ / pattern, tile),
                  tile_codes(tile, 128, tile == 1002 ? CodeType::U16 : CodeType::U8));
    }
    options_.model = write_udim_plane(folder_ / "", n, map_line);
    options_.green_down = false;
  }
  static Recipe stroke(const std::string& points) {
    FileAssets assets(".");
    return parse_recipe(R"({"version": 1, "edits": [{"operator": "pen", "view": "front",
      "options": {"width": 0.2, "height": 0.04}, "strokes": )" +
                            points + "}]}",
                        "test.json", assets);
  }

  TempFolder folder_;
  OpenOptions options_;
};

TEST_F(Udim, EveryTileIsATextureSet) {
  write("skin.<UDIM>.png", "norm skin.<UDIM>.png");
  const OpenedDocument opened = open_document(options_);
  const Mesh& mesh = opened.document.mesh();
  ASSERT_EQ(opened.sets.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    const auto set = static_cast<std::uint32_t>(i);
    EXPECT_EQ(opened.model.texture_sets[i].tile, plane_tiles[i]);
    EXPECT_EQ(mesh.texture_set_names[i], "skin." + std::to_string(plane_tiles[i]));
    EXPECT_EQ(std::count(mesh.texture_sets.begin(), mesh.texture_sets.end(), set), 32);
    EXPECT_FALSE(mesh.repeats(set));
    const NormalMap& map = opened.document.storage().sets[i].normals;
    EXPECT_TRUE(same_codes(map.codes(), tile_codes(plane_tiles[i], 128, map.codes().type())));
  }
  for (const Vec2f& uv : mesh.uvs) {
    EXPECT_TRUE(uv.minCoeff() >= 0.0F && uv.maxCoeff() <= 1.0F);
  }
  EXPECT_NE(to_json(file_info(options_.model)).find("\"tile\": 1011"), std::string::npos);
}

/// Also where charts reach the tiles' borders, where nothing of the opposite border may be read.
TEST_F(Udim, MapsEndAtTheirTiles) {
  write("skin.<UDIM>.png", "map_Bump -bm 1 skin.<UDIM>.png");
  const OpenedDocument opened = open_document(options_);
  std::vector<const NormalMap*> maps;
  for (const StorageSet& set : opened.document.storage().sets) maps.push_back(&set.normals);
  EXPECT_EQ(opened.document.seams().size(), 16U);
  const SeamMismatch seams = measure_seams(opened.document.mesh(), opened.document.seams(), maps);
  EXPECT_LT(seams.max, 1.0);
}

TEST_F(Udim, OneStrokeEditsSeveralTilesAndClosesTheirSeams) {
  write("skin.<UDIM>.png", "norm skin.<UDIM>.png");
  const EditJob job =
      run_edit_job(options_,
                   stroke("[[[-0.6, -0.5], [0.02, 0.03], [0.7, 0.4]], [[-0.5, 0.6], [0.5, "
                          "0.7]], [[0.7, -0.5], [0.6, 0.3]]]"),
                   folder_ / "out", {});
  RecordProperty("before", std::to_string(job.seams_before.p99));
  RecordProperty("after", std::to_string(job.seams_after.p99));
  EXPECT_GT(job.seams_growth.count, 60U);
  EXPECT_LT(job.seams_growth.mean, 0.1);
  EXPECT_LT(job.seams_after.p99, 1.5);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_GT(job.opened.document.storage().sets[i].normals.edited_count(), 500U);
    const std::string name = "skin_normal." + std::to_string(plane_tiles[i]) + ".png";
    const RawImage written = read_image(folder_ / "out" / name);
    EXPECT_EQ(written.type(), plane_tiles[i] == 1002 ? CodeType::U16 : CodeType::U8);
  }
  const std::string library = read_file(folder_ / "out" / "plane.mtl");
  EXPECT_NE(library.find("norm skin_normal.<UDIM>.png"), std::string::npos);
  // What was written opens as it was.
  OpenOptions again = options_;
  again.model = folder_ / "out" / "plane.obj";
  const OpenedDocument reopened = open_document(again);
  ASSERT_EQ(reopened.sets.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_TRUE(same_codes(reopened.document.storage().sets[i].normals.codes(),
                           job.opened.document.storage().sets[i].normals.encode()));
  }
}

TEST_F(Udim, TilesWithoutAnEditKeepTheirCodes) {
  write("skin.<UDIM>.png", "norm skin.<UDIM>.png");
  run_edit_job(options_, stroke("[[[-0.8, -0.6], [-0.4, -0.5]]]"), folder_ / "out", {});
  for (const int tile : {1002, 1011, 1012}) {
    EXPECT_TRUE(
        same_codes(read_image(folder_ / "out" / ("skin_normal." + std::to_string(tile) + ".png")),
                   tile_codes(tile, 128, tile == 1002 ? CodeType::U16 : CodeType::U8)));
  }
  EXPECT_TRUE(fs::exists(folder_ / "out" / "skin.1002.png")) << "what the MTL names is copied";
}

TEST_F(Udim, MapsAreGivenByPatterns) {
  write("other_<UVTILE>.png", "");
  EXPECT_TRUE(fs::exists(folder_ / "other_u2_v1.png"));
  options_.normal_maps = {(folder_ / "other_<UVTILE>.png").string()};
  const OpenedDocument opened = open_document(options_);
  ASSERT_EQ(opened.sets.size(), 4U);
  EXPECT_EQ(opened.sets[3].normal_map_path.filename(), "other_u2_v2.png");
}

TEST_F(Udim, WithoutPatternsMapsRepeat) {
  write("skin.<UDIM>.png", "norm skin.1001.png", 7);
  const OpenedDocument opened = open_document(options_);
  ASSERT_EQ(opened.sets.size(), 1U);
  EXPECT_TRUE(opened.document.mesh().repeats(0));
  EXPECT_EQ(opened.document.mesh().uvs[0], Vec2f(0.0F, 1.0F));
}

std::string refusal_of(const OpenOptions& options) {
  try {
    open_document(options);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST_F(Udim, RefusesWhatItCannotRead) {
  write("skin.<UDIM>.png", "norm skin.<UDIM>.png", 7);
  EXPECT_NE(refusal_of(options_).find("crosses the border of the UDIM tile 1002"),
            std::string::npos);
  write("skin.<UDIM>.png", "norm skin.<UDIM>.png");
  fs::remove(folder_ / "skin.1011.png");
  EXPECT_NE(refusal_of(options_).find("skin.1011.png"), std::string::npos);
}

}  // namespace
}  // namespace normalshop::test
