#include <algorithm>

#include "io/temp_folder.h"
#include "support/meshes.h"
#include <gtest/gtest.h>

#include "normalshop/core/error.h"
#include "normalshop/io/atomic_file.h"
#include "normalshop/io/export_maps.h"
#include "normalshop/io/file_assets.h"
#include "normalshop/io/gltf_export.h"
#include "normalshop/io/image_file.h"
#include "normalshop/io/model_info.h"

namespace normalshop {
namespace {

using test::TempFolder;

/// Two squares side by side, each its own texture set: "map" and "second".
Mesh two_sets() {
  Mesh mesh = test::plane_grid(1);
  Mesh other = test::plane_grid(1);
  const auto shift = static_cast<std::uint32_t>(mesh.positions.size());
  for (Vec3f& p : other.positions) mesh.positions.push_back(p + Vec3f(2.0F, 0.0F, 0.0F));
  for (const Vec3u& t : other.triangles) mesh.triangles.push_back(t.array() + shift);
  mesh.normals.insert(mesh.normals.end(), other.normals.begin(), other.normals.end());
  mesh.uvs.insert(mesh.uvs.end(), other.uvs.begin(), other.uvs.end());
  mesh.tangents.insert(mesh.tangents.end(), other.tangents.begin(), other.tangents.end());
  mesh.texture_sets.resize(mesh.triangle_count(), 1);
  mesh.texture_set_names.emplace_back("second");
  return mesh;
}

OpenOptions write_two_sets(const TempFolder& folder) {
  OpenOptions options;
  options.model = folder / "two.gltf";
  GltfMaterial first;
  first.name = "map";
  GltfMaterial second;
  second.name = "second";
  export_gltf(options.model, two_sets(), {first, second});
  write_image(folder / "flat.png", flat_normal_map(32, 16, CodeType::U8).codes());
  return options;
}

std::string message_of(const OpenOptions& options) {
  try {
    open_document(options);
  } catch (const InvalidInput& e) {
    return e.what();
  }
  return "";
}

TEST(OpenDocument, StartsFlatWithoutAMap) {
  const TempFolder folder;
  OpenOptions options = write_two_sets(folder);
  options.size = 64;
  const OpenedDocument opened = open_document(options);
  ASSERT_EQ(opened.sets.size(), 2U);
  const NormalMap& map = opened.document.storage().sets[0].normals;
  EXPECT_EQ(map.width(), 64);
  EXPECT_EQ(map.codes().type(), CodeType::U16);
  EXPECT_EQ(map.normal(5, 9), Vec3f(0.0F, 0.0F, 1.0F));
  EXPECT_TRUE(opened.sets[0].normal_map.empty());
  EXPECT_GE(opened.notes.size(), 2U);
}

TEST(OpenDocument, TakesTheMapOfANamedSet) {
  const TempFolder folder;
  OpenOptions options = write_two_sets(folder);
  options.normal_maps = {"second=" + (folder / "flat.png").string()};
  const OpenedDocument opened = open_document(options);
  EXPECT_EQ(opened.document.storage().sets[1].normals.width(), 32);
  EXPECT_EQ(opened.document.storage().sets[1].normals.height(), 16);
  EXPECT_EQ(opened.sets[1].type, CodeType::U8);
  EXPECT_TRUE(opened.sets[0].normal_map.empty());
}

TEST(OpenDocument, SaysWhichSetsThereAre) {
  const TempFolder folder;
  OpenOptions options = write_two_sets(folder);
  const std::string file = (folder / "flat.png").string();
  options.normal_maps = {file};
  EXPECT_NE(message_of(options).find("map, second"), std::string::npos) << message_of(options);
  options.normal_maps = {"map=" + file, "map=" + file};
  EXPECT_NE(message_of(options).find("given twice"), std::string::npos) << message_of(options);
  options.normal_maps.clear();
  options.size = 20000;
  EXPECT_NE(message_of(options).find("--size"), std::string::npos) << message_of(options);
}

TEST(OpenDocument, ResizesInMoreBitsThanItReads) {
  const TempFolder folder;
  OpenOptions options = write_two_sets(folder);
  options.normal_maps = {"map=" + (folder / "flat.png").string()};
  options.size = 96;
  const OpenedDocument opened = open_document(options);
  const NormalMap& map = opened.document.storage().sets[0].normals;
  EXPECT_EQ(map.width(), 96);
  EXPECT_EQ(map.height(), 48);
  EXPECT_EQ(map.codes().type(), CodeType::U16);
  EXPECT_EQ(opened.sets[0].type, CodeType::U8);
  EXPECT_EQ(opened.sets[0].imported_width, 32);
  // Exported as it came: 8 bits.
  EXPECT_EQ(export_map(opened, 0, {}).type(), CodeType::U8);
}

TEST(ExportMaps, FollowsThePreset) {
  const TempFolder folder;
  OpenOptions options = write_two_sets(folder);
  RawImage codes = flat_normal_map(8, 8, CodeType::U8).codes();
  for (int i = 0; i < 64; ++i) codes.data()[3 * i + 1] = 180;
  write_image(folder / "tilted.png", codes);
  options.normal_maps = {"map=" + (folder / "tilted.png").string()};
  options.green_down = false;
  options.space = NormalSpace::Tangent;
  const OpenedDocument opened = open_document(options);
  EXPECT_EQ(export_map(opened, 0, {}).code(2, 3, 1), 180.0F);
  EXPECT_EQ(export_map(opened, 0, {ExportPreset::OpenGl, {}}).code(2, 3, 1), 180.0F);
  const RawImage directx = export_map(opened, 0, {ExportPreset::DirectX, {}});
  EXPECT_NEAR(directx.code(2, 3, 1), 75.0F, 1.0F);
  EXPECT_EQ(export_map(opened, 0, {{}, CodeType::F32}).type(), CodeType::F32);
}

TEST(ExportMaps, SparesTheModelsOwnFolder) {
  const TempFolder folder;
  const OpenedDocument opened = open_document(write_two_sets(folder));
  const std::size_t before = test::files_in(folder.path());
  std::vector<std::string> notes;
  EXPECT_THROW(export_document(opened, folder.path(), {}, notes), InvalidInput);
  EXPECT_EQ(test::files_in(folder.path()), before);
}

TEST(ModelInfo, CountsWhatIsThere) {
  const TempFolder folder;
  const OpenOptions options = write_two_sets(folder);
  const Value info = file_info(options.model, false);
  EXPECT_EQ(*info.find("triangles")->number(), 4.0);
  const Value::Array& sets = *info.find("texture set")->array();
  ASSERT_EQ(sets.size(), 2U);
  EXPECT_EQ(*sets[1].find("name")->text(), "second");
  EXPECT_EQ(*sets[1].find("charts")->number(), 1.0);
  EXPECT_EQ(*sets[1].find("triangles")->number(), 2.0);
}

TEST(ModelInfo, TellsMapsFromPictures) {
  const TempFolder folder;
  write_image(folder / "flat.png", flat_normal_map(16, 16, CodeType::U16).codes());
  const Value map = file_info(folder / "flat.png", false);
  EXPECT_TRUE(*map.find("normal map")->boolean());
  EXPECT_EQ(*map.find("bits")->text(), "16");
  RawImage gray(16, 16, 1, CodeType::U8);
  std::fill_n(gray.data(), gray.size_bytes(), std::uint8_t{90});
  write_image(folder / "gray.png", gray);
  EXPECT_FALSE(*file_info(folder / "gray.png", false).find("normal map")->boolean());
  EXPECT_THROW(file_info(folder / "none.png", false), IoError);
}

TEST(FileAssets, ReadsAPatchWithItsOpacity) {
  const TempFolder folder;
  RawImage codes(4, 2, 4, CodeType::U8);
  for (int i = 0; i < 8; ++i) {
    const std::array<std::uint8_t, 4> texel{218, 128, 218, static_cast<std::uint8_t>(i * 36)};
    std::copy(texel.begin(), texel.end(), codes.data() + static_cast<std::ptrdiff_t>(4 * i));
  }
  write_image(folder / "patch.png", codes);
  const Patch patch = FileAssets(folder.path()).patch("patch.png");
  ASSERT_EQ(patch.slopes.width(), 4);
  ASSERT_EQ(patch.opacity.height(), 2);
  // n = (0.71, 0, 0.71): the surface falls by 1 to the right.
  EXPECT_NEAR(patch.slopes(1, 1).x(), -1.0F, 0.02F);
  EXPECT_NEAR(patch.slopes(1, 1).y(), 0.0F, 0.02F);
  EXPECT_NEAR(patch.opacity(3, 1), 252.0F / 255.0F, 1e-6F);
}

TEST(FileAssets, RefusesWhatIsNoPatch) {
  const TempFolder folder;
  RawImage gray(4, 4, 1, CodeType::U8);
  std::fill_n(gray.data(), gray.size_bytes(), std::uint8_t{90});
  write_image(folder / "gray.png", gray);
  FileAssets assets(folder.path());
  EXPECT_THROW(assets.patch("gray.png"), InvalidInput);
  EXPECT_THROW(assets.patch("none.png"), IoError);
  EXPECT_THROW(assets.text("a", "none.ttf"), Error);
}

}  // namespace
}  // namespace normalshop
