#include <array>

#include "io/gltf_builder.h"
#include "io/temp_folder.h"
#include <gtest/gtest.h>

#include "normalshop/core/error.h"
#include "normalshop/core/slope.h"
#include "normalshop/io/atomic_file.h"
#include "normalshop/io/model.h"

namespace normalshop {
namespace {

using test::GltfBuilder;
using test::mentions;
using test::TempFolder;
using test::textured;
using Json = GltfBuilder::Json;

/// Writes the builder's model and reads it back as JSON.
Json written_json(const GltfBuilder& gltf, const TempFolder& folder, const MapReferences& map,
                  const ModelReadOptions& options = {}) {
  write_file(folder / "in.gltf", gltf.text());
  const Model model = read_model(folder / "in.gltf", options);
  write_model(model, folder / "out.gltf", {{0, map}});
  return Json::parse(read_file(folder / "out.gltf"));
}

TEST(GltfWriter, KeepsExtrasSamplersAndUvsOfTheOldTexture) {
  const TempFolder folder;
  GltfBuilder gltf;
  gltf.square()["material"] = 0;
  gltf.json["extras"] = {{"zebra", 1}, {"apple", {1.5, nullptr, "\u00e9"}}};
  gltf.json["images"] = {{{"uri", "data:image/png;base64,AAAA"}}};
  gltf.json["samplers"] = {{{"wrapS", 33071}}};
  gltf.json["textures"] = {{{"sampler", 0}, {"source", 0}}};
  Json material = textured("normalTexture", 0);
  material["normalTexture"]["scale"] = 0.5;
  material["normalTexture"]["extensions"]["KHR_texture_transform"] = {{"offset", {0.5, 0.0}}};
  gltf.json["materials"] = Json::array({material});
  const Json out = written_json(gltf, folder, {"new.png", false});
  EXPECT_EQ(out["extras"].dump(), gltf.json["extras"].dump());
  const Json& info = out["materials"][0]["normalTexture"];
  EXPECT_EQ(info["scale"], 0.5);
  EXPECT_EQ(info["extensions"]["KHR_texture_transform"]["offset"][0], 0.5);
  EXPECT_EQ(out["textures"][info["index"].get<std::size_t>()]["sampler"], 0);
  const Json applied = written_json(gltf, folder, {"new.png", true});
  EXPECT_FALSE(applied["materials"][0]["normalTexture"].contains("scale"));
}

TEST(GltfWriter, GivesAMaterialToTrianglesWithout) {
  const TempFolder folder;
  GltfBuilder gltf;
  gltf.square();
  const Json out = written_json(gltf, folder, {"maps/new.png", false});
  EXPECT_EQ(out["meshes"][0]["primitives"][0]["material"], 0);
  EXPECT_EQ(out["materials"][0]["normalTexture"]["index"], 0);
  EXPECT_EQ(out["images"][0]["uri"], "maps/new.png");
}

/// Three materials of one normal map: two with the set's colours, one with its own.
TEST(GltfWriter, NewColoursComeToTheMaterialsThatShowedThem) {
  const TempFolder folder;
  GltfBuilder gltf;
  for (int i = 0; i < 3; ++i) gltf.square()["material"] = i;
  for (const char* name : {"n.png", "c.png", "other.png"}) {
    gltf.json["images"].push_back({{"uri", name}});
    write_file(folder / name, std::string_view("x"));
  }
  gltf.json["samplers"] = {{{"wrapS", 33071}}};
  gltf.json["textures"] = {{{"source", 0}}, {{"source", 1}, {"sampler", 0}}, {{"source", 2}}};
  for (const int texture : {1, 2, 1}) {
    Json material = textured("color", texture);
    material["pbrMetallicRoughness"]["roughnessFactor"] = 0.25;
    material["normalTexture"] = {{"index", 0}};
    gltf.json["materials"].push_back(material);
  }
  const Json out = written_json(gltf, folder, {"", false, "new color.png"});
  const auto image_of = [&](const Json& info) {
    const Json& texture = out["textures"][info["index"].get<std::size_t>()];
    return out["images"][texture["source"].get<std::size_t>()]["uri"].get<std::string>();
  };
  for (std::size_t i = 0; i < 3; ++i) {
    const Json& pbr = out["materials"][i]["pbrMetallicRoughness"];
    EXPECT_EQ(image_of(pbr["baseColorTexture"]), i == 1 ? "other.png" : "new%20color.png");
    EXPECT_EQ(pbr["roughnessFactor"], 0.25);
    EXPECT_EQ(image_of(out["materials"][i]["normalTexture"]), "n.png");
  }
  const Json& first = out["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"];
  EXPECT_EQ(out["textures"][first["index"].get<std::size_t>()]["sampler"], 0);
}

/// A colour map that the user gives is one in the normal map's UVs.
TEST(GltfWriter, NewColoursHaveTheUvsThatTheyWereEditedIn) {
  const TempFolder folder;
  GltfBuilder gltf;
  Json& primitive = gltf.square();
  primitive["material"] = 0;
  primitive["attributes"]["TEXCOORD_1"] = primitive["attributes"]["TEXCOORD_0"];
  for (const char* name : {"n.png", "c.png"}) {
    gltf.json["images"].push_back({{"uri", name}});
    write_file(folder / name, std::string_view("x"));
  }
  gltf.json["textures"] = {{{"source", 0}}, {{"source", 1}}};
  Json material = textured("color", 1);
  material["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"] = 1;
  material["normalTexture"] = {{"index", 0}, {"scale", 0.5}};
  gltf.json["materials"] = Json::array({material});
  write_file(folder / "in.gltf", gltf.text());
  Model model = read_model(folder / "in.gltf");
  EXPECT_TRUE(mentions(model.notes, "other UVs"));
  model.texture_sets[0].albedo_materials = model.texture_sets[0].materials;
  write_model(model, folder / "out.gltf", {{0, {"", false, "new.png"}}});
  const Json out = Json::parse(read_file(folder / "out.gltf"));
  const Json& info = out["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"];
  EXPECT_FALSE(info.contains("texCoord"));
  EXPECT_FALSE(info.contains("scale"));
  const Json& texture = out["textures"][info["index"].get<std::size_t>()];
  EXPECT_EQ(out["images"][texture["source"].get<std::size_t>()]["uri"], "new.png");
}

TEST(GltfWriter, NewColoursOfOlderMaterialsStayInTheirExtension) {
  const TempFolder folder;
  GltfBuilder gltf;
  gltf.square()["material"] = 0;
  write_file(folder / "c.png", std::string_view("x"));
  gltf.json["images"] = {{{"uri", "c.png"}}};
  gltf.json["textures"] = {{{"source", 0}}};
  const char* const older = "KHR_materials_pbrSpecularGlossiness";
  gltf.json["materials"] = {{{"extensions", {{older, {{"diffuseTexture", {{"index", 0}}}}}}}}};
  const Json out = written_json(gltf, folder, {"", false, "new.png"});
  const Json& material = out["materials"][0];
  EXPECT_EQ(material["extensions"][older]["diffuseTexture"]["index"], 1);
  EXPECT_FALSE(material.contains("pbrMetallicRoughness"));
  EXPECT_FALSE(material.contains("normalTexture"));
  EXPECT_EQ(out["images"][1]["uri"], "new.png");
}

TEST(GltfWriter, FlipsEveryUvOnceAndItsLimits) {
  const TempFolder folder;
  GltfBuilder gltf;
  Json& primitive = gltf.square();
  primitive["attributes"]["TANGENT"] =
      gltf.floats({1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1}, 4);
  const int uv = primitive["attributes"]["TEXCOORD_0"].get<int>();
  gltf.json["accessors"][uv]["min"] = {0.0, 0.0};
  gltf.json["accessors"][uv]["max"] = {1.0, 1.0};
  // The same data under a second accessor.
  gltf.json["accessors"].push_back(gltf.json["accessors"][uv]);
  primitive["attributes"]["TEXCOORD_1"] = gltf.json["accessors"].size() - 1;
  const Json out = written_json(gltf, folder, {"new.png", false}, {.flip_v = true});
  const Model flipped = read_model(folder / "in.gltf", {.flip_v = true});
  const Model back = read_model(folder / "out.gltf");
  EXPECT_EQ(back.mesh.uvs, flipped.mesh.uvs);
  EXPECT_FALSE(out["meshes"][0]["primitives"][0]["attributes"].contains("TANGENT"));
}

std::vector<float> tangents_along(float x, float y) {
  return {x, y, 0, 1, x, y, 0, 1, x, y, 0, 1, x, y, 0, 1};
}

/// What a reader of the written file takes must be the frames that the maps were edited in.
TEST(GltfWriter, LeavesOutOnlyTheTangentsThatWereNotUsed) {
  const TempFolder folder;
  GltfBuilder gltf;
  const auto primitives = [&]() -> Json& { return gltf.json["meshes"][0]["primitives"]; };
  for (int i = 0; i < 4; ++i) gltf.square();
  primitives()[0]["attributes"]["TANGENT"] = gltf.floats(tangents_along(0, 1), 4);
  std::vector<float> one_zero = tangents_along(0, 1);
  one_zero[5] = 0.0F;
  primitives()[2]["attributes"]["TANGENT"] = gltf.floats(one_zero, 4);
  primitives()[3]["attributes"]["TANGENT"] = gltf.floats(tangents_along(0, 1), 4);
  primitives()[3]["attributes"].erase("NORMAL");
  // Apart from each other, or they would share vertices.
  for (std::size_t i = 1; i < 4; ++i) {
    const float z = static_cast<float>(i);
    primitives()[i]["attributes"]["POSITION"] =
        gltf.floats({0, 0, z, 1, 0, z, 1, 1, z, 0, 1, z}, 3);
  }
  write_file(folder / "in.gltf", gltf.text());
  const Model model = read_model(folder / "in.gltf");
  EXPECT_FALSE(model.has_tangents);
  EXPECT_TRUE(model.some_tangents);
  ASSERT_EQ(model.mesh.tangents.size(), 24U);
  for (std::size_t corner = 0; corner < 24; ++corner) {
    const Vec3f expected = corner < 6 ? Vec3f(0, 1, 0) : Vec3f(1, 0, 0);
    EXPECT_LT(angle_degrees(model.mesh.tangents[corner].head<3>(), expected), 1e-4) << corner;
  }
  const WrittenModel written = write_model(model, folder / "out.gltf", {{0, {"n.png"}}});
  EXPECT_TRUE(mentions(written.notes, "tangents"));
  const Json out = Json::parse(read_file(folder / "out.gltf"));
  const Json& parts = out["meshes"][0]["primitives"];
  EXPECT_TRUE(parts[0]["attributes"].contains("TANGENT"));
  EXPECT_FALSE(parts[2]["attributes"].contains("TANGENT"));
  EXPECT_FALSE(parts[3]["attributes"].contains("TANGENT"));
  EXPECT_EQ(read_model(folder / "out.gltf").mesh.tangents, model.mesh.tangents);
}

TEST(GltfWriter, NeverWritesOutsideItsFolder) {
  const TempFolder folder;
  std::filesystem::create_directories(folder / "in");
  std::filesystem::create_directories(folder / "out");
  GltfBuilder gltf;
  gltf.square()["material"] = 0;
  gltf.json["images"] = {{{"uri", "../shared.png"}}, {{"uri", "missing.png"}}};
  gltf.json["textures"] = {{{"source", 0}}};
  gltf.json["materials"] = Json::array({textured("color", 0)});
  write_file(folder / "shared.png", std::string_view("pixels"));
  write_file(folder / "in/a.gltf", gltf.text());
  const WrittenModel written =
      write_model(read_model(folder / "in/a.gltf"), folder / "out/a.gltf", {{0, {"n.png"}}});
  EXPECT_EQ(read_file(folder / "out/shared.png"), "pixels");
  const Json out = Json::parse(read_file(folder / "out/a.gltf"));
  EXPECT_EQ(out["images"][0]["uri"], "shared.png");
  EXPECT_TRUE(mentions(written.notes, "missing.png"));
  EXPECT_EQ(written.files.size(), 2U);
}

/// The builder's one buffer as two files of one name, in the folders a and b beside the model's.
void split_buffer(const GltfBuilder& gltf, const TempFolder& folder) {
  const auto half = static_cast<std::size_t>(gltf.json["bufferViews"][4]["byteOffset"].get<int>());
  Json json = gltf.json;
  json["buffers"] = {{{"byteLength", half}, {"uri", "../a/data.bin"}},
                     {{"byteLength", gltf.bytes.size() - half}, {"uri", "../b/data.bin"}}};
  for (std::size_t i = 4; i < json["bufferViews"].size(); ++i) {
    Json& view = json["bufferViews"][i];
    view["buffer"] = 1;
    view["byteOffset"] = view["byteOffset"].get<std::size_t>() - half;
  }
  for (const char* name : {"in", "out", "a", "b"}) {
    std::filesystem::create_directories(folder / name);
  }
  write_file(folder / "a/data.bin", std::string_view(gltf.bytes).substr(0, half));
  write_file(folder / "b/data.bin", std::string_view(gltf.bytes).substr(half));
  write_file(folder / "a/color.png", std::string_view("first"));
  write_file(folder / "b/color.png", std::string_view("second"));
  write_file(folder / "in/a.gltf", json.dump());
}

TEST(GltfWriter, CompanionsOfOneNameStayApart) {
  for (const bool flip : {false, true}) {
    const TempFolder folder;
    GltfBuilder gltf;
    gltf.square();
    gltf.square();
    gltf.json["images"] = {
        {{"uri", "../a/color.png"}}, {{"uri", "../b/color.png"}}, {{"uri", "../b/color.png"}}};
    split_buffer(gltf, folder);
    const Model model = read_model(folder / "in/a.gltf", {.flip_v = flip});
    const WrittenModel written = write_model(model, folder / "out/a.gltf", {{0, {"n.png"}}});
    EXPECT_EQ(written.files.size(), 5U);
    const Json out = Json::parse(read_file(folder / "out/a.gltf"));
    const std::array<std::string, 3> expected{"first", "second", "second"};
    for (std::size_t i = 0; i < 3; ++i) {
      const std::string name = "out/" + out["images"][i]["uri"].get<std::string>();
      EXPECT_EQ(read_file(folder / name), expected[i]);
    }
    EXPECT_EQ(read_model(folder / "out/a.gltf").mesh.uvs, model.mesh.uvs);
  }
}

TEST(GltfWriter, RefusesAnotherFormatAndUnwritablePlaces) {
  const TempFolder folder;
  GltfBuilder gltf;
  gltf.square();
  const Model model = gltf.read();
  EXPECT_THROW(write_model(model, folder / "a.glb", {{0, {"n.png"}}}), InvalidInput);
  EXPECT_THROW(write_model(model, folder / "a.gltf", {{1, {"n.png"}}}), InvalidInput);
  EXPECT_THROW(write_model(model, folder / "none/a.gltf", {{0, {"n.png"}}}), IoError);
  EXPECT_EQ(test::files_in(folder.path()), 0U);
}

}  // namespace
}  // namespace normalshop
