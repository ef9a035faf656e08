#include <algorithm>
#include <cmath>

#include "io/gltf_builder.h"
#include "io/temp_folder.h"
#include "support/meshes.h"
#include "support/same_codes.h"
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "normalshop/core/error.h"
#include "normalshop/core/slope.h"
#include "normalshop/io/atomic_file.h"
#include "normalshop/io/export_maps.h"
#include "normalshop/io/file_assets.h"
#include "normalshop/io/gltf_export.h"
#include "normalshop/io/image_file.h"
#include "normalshop/io/model_info.h"

namespace normalshop {
namespace {

using test::mentions;
using test::same_codes;
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

/// A model whose materials scale their normals, with or without a map.
OpenOptions write_scaled(const TempFolder& folder, float scale, const std::string& map) {
  OpenOptions options;
  options.model = folder / "scaled.gltf";
  GltfMaterial material;
  material.name = "map";
  material.normal_map = map;
  export_gltf(options.model, test::plane_grid(2), {material});
  auto json = nlohmann::ordered_json::parse(read_file(options.model));
  json["materials"][0]["normalTexture"]["scale"] = scale;
  write_file(options.model, json.dump());
  return options;
}

float scale_of(const std::filesystem::path& model) {
  const Model read = read_model(model);
  return read.texture_sets[0].normal_scale;
}

RawImage tilted(int size) {
  RawImage codes = flat_normal_map(size, size, CodeType::U8).codes();
  for (int i = 0; i < size * size; ++i) codes.data()[3 * i] = static_cast<std::uint8_t>(70 + i);
  return codes;
}

TEST(NormalScale, LeavesCodesAndTheModelsScale) {
  const TempFolder folder;
  const RawImage codes = tilted(8);
  write_image(folder / "n.png", codes);
  for (const bool given : {false, true}) {
    OpenOptions options = write_scaled(folder, 0.5F, given ? "other.png" : "n.png");
    write_image(folder / "other.png", flat_normal_map(4, 4, CodeType::U8).codes());
    if (given) options.normal_maps = {(folder / "n.png").string()};
    OpenedDocument opened = open_document(options);
    const NormalMap& map = opened.document.storage().sets[0].normals;
    const Vec3f stored = NormalMap(codes, {}).normal(3, 2);
    const Vec3f shown = Vec3f(0.5F * stored.x(), 0.5F * stored.y(), stored.z()).normalized();
    EXPECT_LT(angle_degrees(map.normal(3, 2), shown), 0.3);
    EXPECT_TRUE(same_codes(export_map(opened, 0, {}), codes));
    std::vector<std::string> notes;
    const auto files = export_document(opened, folder / "out", {}, notes);
    EXPECT_EQ(scale_of(folder / "out/scaled.gltf"), 0.5F);
    // In object space there is nothing to scale.
    export_document(opened, folder / "object", {ExportPreset::Object, {}}, notes);
    EXPECT_EQ(scale_of(folder / "object/scaled.gltf"), 1.0F);
    OpenOptions again = options;
    again.model = folder / "object/scaled.gltf";
    again.normal_maps.clear();
    again.space = NormalSpace::Object;
    again.green_down = false;
    const OpenedDocument object = open_document(again);
    EXPECT_LT(angle_degrees(object.document.storage().sets[0].normals.normal(3, 2), shown), 1.0);
  }
}

TEST(NormalScale, IsMultipliedIntoTheMapWhereCodesCannotBearIt) {
  const TempFolder folder;
  write_image(folder / "n.png", tilted(8));
  const OpenOptions options = write_scaled(folder, 0.0F, "n.png");
  const OpenedDocument opened = open_document(options);
  // Half a step of 8 bits in each of x and y.
  EXPECT_LT(angle_degrees(opened.document.storage().sets[0].normals.normal(3, 2), Vec3f::UnitZ()),
            0.32);
  std::vector<std::string> notes;
  export_document(opened, folder / "out", {}, notes);
  EXPECT_EQ(scale_of(folder / "out/scaled.gltf"), 1.0F);
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

TEST(ExportMaps, WritesNoMapForASetWithoutOneThatNoEditReached) {
  const TempFolder folder;
  OpenOptions options = write_two_sets(folder);
  options.size = 64;
  OpenedDocument opened = open_document(options);
  std::vector<std::string> notes;
  export_document(opened, folder / "none", {}, notes);
  EXPECT_FALSE(std::filesystem::exists(folder / "none/map_normal.png"));
  FileAssets assets(folder.path());
  const Recipe recipe = parse_recipe(
      R"({"version": 1, "edits": [{"operator": "pen", "options": {"width": 0.1, "height": 0.01},
          "view": {"direction": [0, 0, 1], "center": [2.5, 0.5, 0], "width": 1},
          "strokes": [[[-0.2, 0], [0.2, 0]]]}]})",
      "recipe", assets);
  EXPECT_GT(opened.document.apply(recipe.edits[0]).pushed.changed, 10U);
  export_document(opened, folder / "one", {}, notes);
  EXPECT_FALSE(std::filesystem::exists(folder / "one/map_normal.png"));
  EXPECT_TRUE(std::filesystem::exists(folder / "one/second_normal.png"));
  const Model back = read_model(folder / "one/two.gltf");
  EXPECT_FALSE(back.texture_sets[0].normal_map.has_value());
  EXPECT_TRUE(back.texture_sets[1].normal_map.has_value());
}

TEST(ExportMaps, SaysWhatGltfViewersDoNotTake) {
  const TempFolder folder;
  OpenOptions options = write_two_sets(folder);
  write_image(folder / "N.TIF", flat_normal_map(8, 8, CodeType::U8).codes());
  options.normal_maps = {"map=" + (folder / "N.TIF").string()};
  options.green_down = true;
  const OpenedDocument opened = open_document(options);
  EXPECT_TRUE(opened.sets[0].tiff);
  std::vector<std::string> notes;
  export_document(opened, folder / "as_it_is", {}, notes);
  EXPECT_TRUE(std::filesystem::exists(folder / "as_it_is/map_normal.tif"));
  EXPECT_TRUE(mentions(notes, "only PNG and JPEG"));
  EXPECT_TRUE(mentions(notes, "tangent space, green up"));
  notes.clear();
  export_document(opened, folder / "gltf", {ExportPreset::Gltf, {}}, notes);
  EXPECT_TRUE(std::filesystem::exists(folder / "gltf/map_normal.png"));
  EXPECT_FALSE(mentions(notes, "glTF viewers"));
  export_document(opened, folder / "object", {ExportPreset::Object, {}}, notes);
  EXPECT_TRUE(mentions(notes, "tangent space, green up"));
}

TEST(ExportMaps, HalfFloatsStayHalf) {
  const TempFolder folder;
  OpenOptions options = write_two_sets(folder);
  const RawImage codes = flat_normal_map(8, 8, CodeType::F32).codes();
  for (const bool half : {true, false}) {
    write_image(folder / "n.exr", codes, {.half_float = half});
    options.normal_maps = {"map=" + (folder / "n.exr").string()};
    const OpenedDocument opened = open_document(options);
    std::vector<std::string> notes;
    ImageTraits traits;
    export_document(opened, folder / "out", {}, notes);
    EXPECT_TRUE(same_codes(read_image(folder / "out/map_normal.exr", &traits), codes));
    EXPECT_EQ(traits.half_float, half);
    export_document(opened, folder / "out", {{}, CodeType::F32}, notes);
    read_image(folder / "out/map_normal.exr", &traits);
    EXPECT_FALSE(traits.half_float);
  }
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
  const Value info = file_info(options.model);
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
  const Value map = file_info(folder / "flat.png");
  EXPECT_TRUE(*map.find("normal map")->boolean());
  EXPECT_EQ(*map.find("bits")->text(), "16");
  RawImage gray(16, 16, 1, CodeType::U8);
  std::fill_n(gray.data(), gray.size_bytes(), std::uint8_t{90});
  write_image(folder / "gray.png", gray);
  EXPECT_FALSE(*file_info(folder / "gray.png").find("normal map")->boolean());
  EXPECT_THROW(file_info(folder / "none.png"), IoError);
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

TEST(FileAssets, OpacityIsFromZeroToOne) {
  const TempFolder folder;
  RawImage codes(4, 1, 4, CodeType::F32);
  const std::array<float, 4> alpha{std::nanf(""), -3.0F, 0.25F, 7.0F};
  for (int x = 0; x < 4; ++x) {
    const std::array<float, 4> texel{0.1F * static_cast<float>(x), -0.1F, 0.9F,
                                     alpha[static_cast<std::size_t>(x)]};
    std::copy(texel.begin(), texel.end(), codes.row<float>(0) + std::ptrdiff_t{4} * x);
  }
  write_image(folder / "patch.exr", codes);
  const Patch patch = FileAssets(folder.path()).patch("patch.exr");
  EXPECT_EQ(patch.opacity(0, 0), 0.0F);
  EXPECT_EQ(patch.opacity(1, 0), 0.0F);
  EXPECT_EQ(patch.opacity(2, 0), 0.25F);
  EXPECT_EQ(patch.opacity(3, 0), 1.0F);
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
