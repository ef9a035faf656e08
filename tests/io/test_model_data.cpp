#include <fstream>

#include "io/temp_folder.h"
#include "support/data.h"
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "normalshop/core/error.h"
#include "normalshop/core/slope.h"
#include "normalshop/io/atomic_file.h"
#include "normalshop/io/image_file.h"
#include "normalshop/io/model.h"

/// Models that nobody here made. Counts are those of the data's own description.
namespace normalshop {
namespace {

using Json = nlohmann::ordered_json;
using test::data_file;
using test::TempFolder;

void expect_consistent(const Model& model) {
  const Mesh& mesh = model.mesh;
  ASSERT_EQ(mesh.uvs.size(), mesh.corner_count());
  ASSERT_EQ(mesh.normals.size(), mesh.corner_count());
  ASSERT_EQ(mesh.texture_sets.size(), mesh.triangle_count());
  ASSERT_EQ(mesh.texture_set_names.size(), model.texture_sets.size());
  EXPECT_EQ(model.has_tangents, !mesh.tangents.empty());
  if (model.has_tangents) {
    ASSERT_EQ(mesh.tangents.size(), mesh.corner_count());
  }
  for (const Vec3f& n : mesh.normals) ASSERT_NEAR(n.norm(), 1.0F, 1e-4F);
  for (const std::uint32_t set : mesh.texture_sets) ASSERT_LT(set, model.texture_sets.size());
  for (const Vec3u& t : mesh.triangles) ASSERT_LT(t.maxCoeff(), mesh.positions.size());
}

struct Expected {
  const char* file;
  std::size_t triangles;
  std::size_t sets;
  bool tangents;
  bool normal_map;
};

class RealModel : public ::testing::TestWithParam<Expected> {};

TEST_P(RealModel, HasItsKnownContent) {
  const Expected& expected = GetParam();
  const auto path = data_file(expected.file);
  if (!path) GTEST_SKIP() << "the real data is not on this machine";
  const Model model = read_model(*path);
  expect_consistent(model);
  EXPECT_EQ(model.mesh.triangle_count(), expected.triangles);
  EXPECT_EQ(model.texture_sets.size(), expected.sets);
  EXPECT_EQ(model.has_tangents, expected.tangents);
  EXPECT_TRUE(model.has_normals || std::string(expected.file).starts_with("spot"));
  EXPECT_EQ(model.texture_sets[0].normal_map.has_value(), expected.normal_map);
  if (expected.normal_map) {
    const RawImage map = read_image(model.texture_sets[0].normal_map->path);
    EXPECT_GE(map.channels(), 3);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Files, RealModel,
    ::testing::Values(
        Expected{"franka_panda/hand.gltf", 29264, 1, false, true},
        Expected{"franka_panda/link5.gltf", 11904, 1, false, true},
        Expected{"franka_panda/link7.gltf", 25145, 1, false, true},
        Expected{"bell_pepper/yellow_bell_pepper_no_stem_low.gltf", 968, 1, false, true},
        Expected{"khr_avocado/Avocado.gltf", 682, 1, true, true},
        Expected{"khr_suzanne/Suzanne.gltf", 3936, 1, true, false},
        Expected{"khr_waterbottle/WaterBottle.gltf", 4510, 1, true, true},
        Expected{"lee_perry_smith/LeePerrySmith.glb", 17684, 1, false, false},
        Expected{"polyhaven_sofa_03/sofa_03_1k.gltf", 8004, 1, false, true},
        Expected{"polyhaven_wooden_table_02/wooden_table_02_1k.gltf", 196, 1, false, true},
        Expected{"spot/spot_triangulated.obj", 5856, 1, false, false},
        Expected{"spot/spot_quadrangulated.obj", 5856, 1, false, false}));

TEST(RealModels, TeaSetSharesOneAtlas) {
  const auto path = data_file("polyhaven_tea_set_01/tea_set_01_1k.gltf");
  if (!path) GTEST_SKIP() << "the real data is not on this machine";
  const Model model = read_model(*path);
  expect_consistent(model);
  ASSERT_EQ(model.texture_sets.size(), 1U);
  EXPECT_EQ(model.texture_sets[0].name, "tea_set_01");
  EXPECT_GT(model.mesh.triangle_count(), 20000U);
  // The node transforms are applied: ten things side by side.
  EXPECT_GT(bounds(model.mesh).diagonal(), 0.9F);
}

TEST(RealModels, BoomBoxHasTwoSetsAndNodesThatPlaceIt) {
  const auto path = data_file("khr_boombox_axes/BoomBoxWithAxes.gltf");
  if (!path) GTEST_SKIP() << "the real data is not on this machine";
  const Model model = read_model(*path);
  expect_consistent(model);
  ASSERT_EQ(model.texture_sets.size(), 2U);
  EXPECT_TRUE(model.texture_sets[0].normal_map.has_value());
  EXPECT_FALSE(model.texture_sets[1].normal_map.has_value());
  EXPECT_TRUE(model.texture_sets[1].albedo.has_value());
}

TEST(RealModels, ControlMeshOfSpotHasPolygonsWithoutUvs) {
  const auto path = data_file("spot/spot_control_mesh.obj");
  if (!path) GTEST_SKIP() << "the real data is not on this machine";
  const std::string text = read_file(*path);
  if (text.find("\nvt ") == std::string::npos) {
    EXPECT_THROW(read_model(*path), InvalidInput);
  } else {
    expect_consistent(read_model(*path));
  }
}

TEST(RealModels, ScansWithoutUvsAreRefusedInOneSentence) {
  const auto path = data_file("scan_boot/boot.obj");
  if (!path) GTEST_SKIP() << "the real data is not on this machine";
  try {
    read_model(*path);
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("no texture coordinates"), std::string::npos);
  }
}

TEST(RealModels, GltfComesBackWithAllButItsNormalTexture) {
  const auto path = data_file("franka_panda/hand.gltf");
  if (!path) GTEST_SKIP() << "the real data is not on this machine";
  const TempFolder folder;
  const Model model = read_model(*path);
  const auto out = folder / "hand.gltf";
  const WrittenModel written = write_model(model, out, {{0, {"hand_material_normal.png"}}});
  EXPECT_TRUE(written.notes.empty());
  Json before = Json::parse(read_file(*path));
  Json after = Json::parse(read_file(out));
  EXPECT_EQ(after["materials"][0]["normalTexture"]["index"], 3);
  EXPECT_EQ(after["textures"][3]["source"], 6);
  EXPECT_EQ(after["images"][6]["uri"], "hand_material_normal.png");
  EXPECT_FALSE(after["textures"][3].contains("extensions"));
  // Without the three changes it is the same text.
  after["materials"][0]["normalTexture"]["index"] = 0;
  after["textures"].erase(3);
  after["images"].erase(6);
  EXPECT_EQ(before.dump(), after.dump());
  EXPECT_EQ(read_file(folder / "hand.bin"), read_file(path->parent_path() / "hand.bin"));
  for (const char* name : {"hand_color.png", "hand_normal.ktx2", "hand_normal.png"}) {
    EXPECT_TRUE(std::filesystem::exists(folder / name)) << name;
  }
  const Model back = read_model(out);
  EXPECT_EQ(back.mesh.uvs, model.mesh.uvs);
  EXPECT_EQ(back.mesh.triangles, model.mesh.triangles);
  EXPECT_EQ(back.texture_sets[0].normal_map->path, folder / "hand_material_normal.png");
}

TEST(RealModels, AnEditedMapIsNeverOverwrittenByTheOldOne) {
  const auto path = data_file("franka_panda/hand.gltf");
  if (!path) GTEST_SKIP() << "the real data is not on this machine";
  const TempFolder folder;
  write_file(folder / "hand_normal.png", std::string_view("edited"));
  write_model(read_model(*path), folder / "hand.gltf", {{0, {"hand_normal.png"}}});
  EXPECT_EQ(read_file(folder / "hand_normal.png"), "edited");
}

TEST(RealModels, SubfoldersAreKept) {
  const auto path = data_file("polyhaven_sofa_03/sofa_03_1k.gltf");
  if (!path) GTEST_SKIP() << "the real data is not on this machine";
  const TempFolder folder;
  const Model model = read_model(*path);
  EXPECT_EQ(model.texture_sets[0].materials, (std::vector<int>{0, 1}));
  write_model(model, folder / "sofa.gltf", {{0, {"sofa normal.png"}}});
  EXPECT_TRUE(std::filesystem::exists(folder / "textures/sofa_03_diff_1k.jpg"));
  const Json json = Json::parse(read_file(folder / "sofa.gltf"));
  EXPECT_EQ(json["images"].back()["uri"], "sofa%20normal.png");
  EXPECT_EQ(read_model(folder / "sofa.gltf").texture_sets.size(), 1U);
}

TEST(RealModels, FlippedHeadIsWrittenRightForEveryViewer) {
  const auto path = data_file("lee_perry_smith/LeePerrySmith.glb");
  if (!path) GTEST_SKIP() << "the real data is not on this machine";
  const TempFolder folder;
  const Model plain = read_model(*path);
  const Model flipped = read_model(*path, {.flip_v = true});
  for (std::size_t i = 0; i < plain.mesh.uvs.size(); ++i) {
    ASSERT_EQ(flipped.mesh.uvs[i].y(), 1.0F - plain.mesh.uvs[i].y());
    ASSERT_EQ(flipped.mesh.uvs[i].x(), plain.mesh.uvs[i].x());
  }
  const WrittenModel written = write_model(flipped, folder / "head.glb", {{0, {"n.png"}}});
  ASSERT_EQ(written.notes.size(), 1U);
  const Model back = read_model(folder / "head.glb");
  EXPECT_EQ(back.mesh.uvs, flipped.mesh.uvs);
  EXPECT_EQ(back.mesh.positions, flipped.mesh.positions);
  EXPECT_EQ(back.mesh.triangles, flipped.mesh.triangles);
  EXPECT_EQ(back.texture_sets[0].normal_map->path, folder / "n.png");
  // Unflipped, the binary chunk is the source's, byte for byte.
  write_model(plain, folder / "plain.glb", {{0, {"n.png"}}});
  const std::string source = read_file(*path);
  const std::string copy = read_file(folder / "plain.glb");
  EXPECT_EQ(source.substr(source.size() - 403032), copy.substr(copy.size() - 403032));
}

TEST(RealModels, SpotKeepsItsQuads) {
  const auto path = data_file("spot/spot_quadrangulated.obj");
  if (!path) GTEST_SKIP() << "the real data is not on this machine";
  const TempFolder folder;
  const Model model = read_model(*path);
  write_model(model, folder / "spot.obj", {{0, {"spot_normal.png"}}});
  std::string out = read_file(folder / "spot.obj");
  for (const std::string added : {"mtllib spot.mtl\n", "usemtl spot_quadrangulated\n"}) {
    const std::size_t at = out.find(added);
    ASSERT_NE(at, std::string::npos) << added;
    out.erase(at, added.size());
  }
  EXPECT_EQ(out, read_file(*path));
  const Model back = read_model(folder / "spot.obj");
  EXPECT_EQ(back.texture_sets[0].normal_map->path, folder / "spot_normal.png");
  EXPECT_EQ(back.mesh.uvs, model.mesh.uvs);
}

}  // namespace
}  // namespace normalshop
