#include <cmath>
#include <functional>

#include "io/gltf_builder.h"
#include "io/holds_together.h"
#include "io/temp_folder.h"
#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "normalshop/core/error.h"
#include "normalshop/core/random.h"
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

std::string error_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "(nothing was thrown)";
}

TEST(Gltf, CornersAreInTheOrderOfTheIndices) {
  GltfBuilder gltf;
  gltf.square();
  const Model model = gltf.read();
  ASSERT_EQ(model.mesh.triangle_count(), 2U);
  EXPECT_EQ(model.mesh.triangles[0], Vec3u(0, 1, 2));
  EXPECT_EQ(model.mesh.triangles[1], Vec3u(0, 2, 3));
  EXPECT_EQ(model.mesh.uvs[2], Vec2f(1, 0));
  EXPECT_TRUE(model.has_normals);
  EXPECT_FALSE(model.has_tangents);
  ASSERT_EQ(model.texture_sets.size(), 1U);
  EXPECT_EQ(model.texture_sets[0].name, "test");
  EXPECT_EQ(model.texture_sets[0].materials, std::vector<int>{-1});
}

TEST(Gltf, NodeTransformsPlaceAndMirror) {
  GltfBuilder gltf;
  Json& primitive = gltf.square();
  primitive["attributes"]["TANGENT"] =
      gltf.floats({1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1}, 4);
  gltf.json["nodes"] = {{{"children", {1}}, {"translation", {10, 0, 0}}},
                        {{"mesh", 0}, {"scale", {-2, 1, 0.5}}, {"rotation", {0.6, 0, 0, 0.8}}}};
  const Model model = gltf.read();
  const Mesh& mesh = model.mesh;
  ASSERT_TRUE(model.has_tangents);
  for (std::size_t t = 0; t < 2; ++t) {
    const Vec3f a = mesh.position(3 * t);
    const Vec3f face = (mesh.position(3 * t + 1) - a).cross(mesh.position(3 * t + 2) - a);
    // Seen from outside the triangles stay counter-clockwise.
    EXPECT_LT(angle_degrees(face, mesh.normals[3 * t]), 1e-4);
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec4f& tangent = mesh.tangents[3 * t + k];
      EXPECT_LT(angle_degrees(tangent.head<3>(), Vec3f(-1, 0, 0)), 1e-4);
      const Vec3f up = tangent.w() * mesh.normals[3 * t].cross(Vec3f(tangent.head<3>()));
      const Vec3f expected = Eigen::Quaternionf(0.8F, 0.6F, 0, 0) * Vec3f(0, 1, 0);
      EXPECT_LT(angle_degrees(up, expected), 1e-3);
    }
  }
  EXPECT_EQ(mesh.positions[1].x(), 8.0F);
}

TEST(Gltf, NormalsFollowTheInverseTranspose) {
  GltfBuilder gltf;
  Json& primitive = gltf.square();
  const float s = std::sqrt(0.5F);
  primitive["attributes"]["NORMAL"] = gltf.floats({s, 0, s, s, 0, s, s, 0, s, s, 0, s}, 3);
  gltf.json["nodes"][0]["scale"] = {2, 1, 1};
  EXPECT_LT(angle_degrees(gltf.read().mesh.normals[0], Vec3f(1, 0, 2)), 1e-4);
}

TEST(Gltf, StripsFansAndMissingIndices) {
  for (const int mode : {4, 5, 6}) {
    GltfBuilder gltf;
    Json& primitive = gltf.square();
    primitive["mode"] = mode;
    if (mode == 4) {
      primitive["indices"] = gltf.accessor(std::vector<std::uint8_t>{2, 3, 0}, 5121, "SCALAR", 1);
    } else {
      primitive.erase("indices");
    }
    const Mesh mesh = gltf.read().mesh;
    ASSERT_EQ(mesh.triangle_count(), mode == 4 ? 1U : 2U);
    if (mode == 4) {
      EXPECT_EQ(mesh.triangles[0], Vec3u(2, 3, 0));
    }
    if (mode == 5) {
      EXPECT_EQ(mesh.triangles[1], Vec3u(1, 3, 2));
    }
    if (mode == 6) {
      EXPECT_EQ(mesh.triangles[1], Vec3u(2, 3, 0));
    }
  }
}

TEST(Gltf, NormalisedIntegersStridesAndSparseValues) {
  GltfBuilder gltf;
  Json& primitive = gltf.square();
  // Four pairs of 16 bits, each followed by four bytes of something else.
  const std::vector<std::uint16_t> mixed = {0,     65535, 7, 7, 65535, 65535, 7, 7,
                                            65535, 0,     7, 7, 0,     0,     7, 7};
  const int view = gltf.view(mixed, 8);
  const int where = gltf.view(std::vector<std::uint8_t>{2});
  const int what = gltf.view(std::vector<std::uint16_t>{32768, 13107});
  gltf.json["accessors"].push_back({{"bufferView", view},
                                    {"componentType", 5123},
                                    {"normalized", true},
                                    {"count", 4},
                                    {"type", "VEC2"},
                                    {"sparse",
                                     {{"count", 1},
                                      {"indices", {{"bufferView", where}, {"componentType", 5121}}},
                                      {"values", {{"bufferView", what}}}}}});
  primitive["attributes"]["TEXCOORD_0"] = gltf.json["accessors"].size() - 1;
  const Mesh mesh = gltf.read().mesh;
  EXPECT_EQ(mesh.uvs[0], Vec2f(0, 1));
  EXPECT_EQ(mesh.uvs[1], Vec2f(1, 1));
  EXPECT_NEAR(mesh.uvs[2].x(), 32768.0 / 65535.0, 1e-7);
  EXPECT_NEAR(mesh.uvs[2].y(), 0.2, 1e-6);
}

TEST(Gltf, MaterialsShareASetByNormalImageThenByColour) {
  GltfBuilder gltf;
  for (int i = 0; i < 5; ++i) gltf.square()["material"] = i;
  gltf.json["images"] = {{{"uri", "a%20b.png"}}, {{"uri", "c.png"}}, {{"uri", "a%20b.png"}}};
  gltf.json["textures"] = {{{"source", 0}}, {{"source", 1}}, {{"source", 2}}};
  Json normal_and_color = textured("normalTexture", 2);
  normal_and_color["pbrMetallicRoughness"]["baseColorTexture"]["index"] = 1;
  gltf.json["materials"] = {textured("normalTexture", 0),
                            normal_and_color,
                            textured("color", 1),
                            textured("color", 1),
                            {{"name", "../x y"}}};
  const Model model = gltf.read();
  ASSERT_EQ(model.texture_sets.size(), 3U);
  EXPECT_EQ(model.texture_sets[0].materials, (std::vector<int>{0, 1}));
  EXPECT_EQ(model.texture_sets[1].materials, (std::vector<int>{2, 3}));
  EXPECT_EQ(model.texture_sets[0].normal_map->path, "/none/a b.png");
  EXPECT_EQ(model.texture_sets[1].albedo->path, "/none/c.png");
  EXPECT_EQ(model.texture_sets[2].name, "set.._x_y");
  EXPECT_EQ(model.mesh.texture_sets[9], 2U);
}

TEST(Gltf, TextureTransformIsAppliedToUvs) {
  GltfBuilder gltf;
  gltf.square()["material"] = 0;
  gltf.json["images"] = {{{"uri", "n.png"}}};
  gltf.json["textures"] = {{{"source", 0}}};
  Json material = textured("normalTexture", 0);
  material["normalTexture"]["scale"] = 0.5;
  material["normalTexture"]["extensions"]["KHR_texture_transform"] = {
      {"offset", {0.1, 0.2}}, {"scale", {2, 3}}, {"rotation", std::acos(0.0)}};
  gltf.json["materials"] = Json::array({material});
  const Model model = gltf.read();
  // (1, 1) is scaled to (2, 3), and rotated by a quarter against the clock (v runs down).
  EXPECT_NEAR(model.mesh.uvs[1].x(), 3.1F, 1e-5F);
  EXPECT_NEAR(model.mesh.uvs[1].y(), -1.8F, 1e-5F);
  EXPECT_EQ(model.texture_sets[0].normal_scale, 0.5F);
}

TEST(Gltf, OneImageUnderTwoScalesIsTwoSets) {
  GltfBuilder gltf;
  for (int i = 0; i < 3; ++i) gltf.square()["material"] = i;
  gltf.json["images"] = {{{"uri", "n.png"}}};
  gltf.json["textures"] = {{{"source", 0}}};
  Json scaled = textured("normalTexture", 0);
  scaled["normalTexture"]["scale"] = 0.3;
  gltf.json["materials"] = {textured("normalTexture", 0), scaled, textured("normalTexture", 0)};
  const Model model = gltf.read();
  ASSERT_EQ(model.texture_sets.size(), 2U);
  EXPECT_EQ(model.texture_sets[0].materials, (std::vector<int>{0, 2}));
  EXPECT_EQ(model.texture_sets[1].normal_scale, 0.3F);
}

/// Images in formats that are not read: the fallback is taken, and without one they are named.
TEST(Gltf, UnreadImagesAreSkippedForTheirFallbackAndNamedWithout) {
  struct Format {
    std::string extension_name;
    std::string mime;
    std::string uri;
  };
  for (const Format& f : {Format{"KHR_texture_basisu", "image/ktx2", "n.ktx2"},
                          Format{"EXT_texture_webp", "image/webp", "n.WEBP"},
                          Format{"MSFT_texture_dds", "image/vnd-ms.dds", "n.dds"}}) {
    GltfBuilder gltf;
    gltf.square()["material"] = 0;
    gltf.json["images"] = {{{"uri", "n.png"}}, {{"uri", f.uri}}};
    gltf.json["textures"] = {
        {{"source", 0}, {"extensions", {{f.extension_name, {{"source", 1}}}}}}};
    gltf.json["materials"] = Json::array({textured("normalTexture", 0)});
    EXPECT_EQ(gltf.read().texture_sets[0].normal_map->path, "/none/n.png");
    gltf.json["textures"][0].erase("source");
    gltf.json["extensionsRequired"] = {f.extension_name};
    const Model model = gltf.read();
    EXPECT_FALSE(model.texture_sets[0].normal_map.has_value());
    EXPECT_TRUE(mentions(model.notes, f.uri));
    gltf.json["images"][1] = {{"bufferView", 0}, {"mimeType", f.mime}, {"name", "inside"}};
    EXPECT_FALSE(gltf.read().texture_sets[0].normal_map.has_value());
    EXPECT_TRUE(mentions(gltf.read().notes, "inside"));
  }
}

TEST(Gltf, EmbeddedImagesComeAsBytes) {
  GltfBuilder gltf;
  gltf.square()["material"] = 0;
  const int view = gltf.view(std::vector<std::uint8_t>{1, 2, 3});
  gltf.json["images"] = {{{"bufferView", view}, {"mimeType", "image/png"}},
                         {{"uri", "data:image/jpeg;base64,AQIDBA=="}}};
  gltf.json["textures"] = {{{"source", 0}}, {{"source", 1}}};
  Json material = textured("normalTexture", 0);
  material["pbrMetallicRoughness"]["baseColorTexture"]["index"] = 1;
  gltf.json["materials"] = Json::array({material});
  const TextureSet set = gltf.read().texture_sets[0];
  EXPECT_EQ(set.normal_map->bytes,
            (std::vector<std::byte>{std::byte{1}, std::byte{2}, std::byte{3}}));
  EXPECT_EQ(set.albedo->bytes.size(), 4U);
  EXPECT_TRUE(set.albedo->path.empty());
}

TEST(Gltf, WhatIsMissingIsSaid) {
  GltfBuilder no_uvs;
  no_uvs.square()["attributes"].erase("TEXCOORD_0");
  EXPECT_NE(error_of([&] { no_uvs.read(); }).find("no texture coordinates"), std::string::npos);
  ModelReadOptions keep;
  keep.keep_without_uvs = true;
  const Mesh kept = no_uvs.read(keep).mesh;
  EXPECT_EQ(kept.triangle_count(), 2U);
  EXPECT_EQ(kept.uvs, std::vector<Vec2f>(6, Vec2f(0.0F, 0.0F)));

  GltfBuilder some;
  some.square();
  some.json["materials"] = {{{"name", "glass"}}};
  GltfBuilder::Json& glass = some.square();
  glass["attributes"].erase("TEXCOORD_0");
  glass["material"] = 0;
  some.square()["mode"] = 0;
  some.square()["attributes"].erase("NORMAL");
  const Model model = some.read();
  EXPECT_EQ(model.mesh.triangle_count(), 4U);
  EXPECT_EQ(model.texture_sets.size(), 1U);  // what has no UVs has no map
  EXPECT_TRUE(mentions(model.notes, "1 parts without texture coordinates"));
  EXPECT_TRUE(mentions(model.notes, "points and lines"));
  EXPECT_TRUE(mentions(model.notes, "normals are computed"));
  EXPECT_FALSE(model.has_normals);
  EXPECT_LT(angle_degrees(model.mesh.normals[11], Vec3f::UnitZ()), 1e-4);

  for (const char* name : {"KHR_draco_mesh_compression", "EXT_meshopt_compression", "ACME_x"}) {
    GltfBuilder required;
    required.square();
    required.json["extensionsRequired"] = {name};
    EXPECT_NE(error_of([&] { required.read(); }).find(name), std::string::npos);
  }
}

/// One change of a good file each, and words of the message.
TEST(Gltf, DamagedFilesAreErrorsThatNameTheField) {
  const std::vector<std::pair<std::string, std::function<void(Json&)>>> cases = {
      {"asset.version", [](Json& j) { j["asset"]["version"] = "1.0"; }},
      {"accessors[0] reaches beyond", [](Json& j) { j["accessors"][0]["count"] = 5; }},
      {"count", [](Json& j) { j["accessors"][0]["count"] = 9007199254740991; }},
      {"count", [](Json& j) { j["accessors"][0]["count"] = -1; }},
      {"count", [](Json& j) { j["accessors"][0]["count"] = "4"; }},
      {"no bufferView",
       [](Json& j) {
         j["accessors"][0].erase("bufferView");
         j["accessors"][0]["count"] = 1048577;
       }},
      {"another count", [](Json& j) { j["accessors"][2]["count"] = 3; }},
      {"accessors[0]", [](Json& j) { j["accessors"][0]["byteOffset"] = 4; }},
      {"accessors[0]", [](Json& j) { j["accessors"][0]["byteOffset"] = 9007199254740000; }},
      {"componentType", [](Json& j) { j["accessors"][0]["componentType"] = 5124; }},
      {"type", [](Json& j) { j["accessors"][0]["type"] = "MAT4"; }},
      {"components", [](Json& j) { j["accessors"][0]["type"] = "VEC2"; }},
      {"bufferView", [](Json& j) { j["accessors"][0]["bufferView"] = 99; }},
      {"bufferViews[0]", [](Json& j) { j["bufferViews"][0]["byteLength"] = 100000; }},
      {"byteStride", [](Json& j) { j["bufferViews"][0]["byteStride"] = 2; }},
      {"bufferViews[0].buffer", [](Json& j) { j["bufferViews"][0]["buffer"] = 3; }},
      {"POSITION", [](Json& j) { j["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = 77; }},
      {"POSITION",
       [](Json& j) { j["meshes"][0]["primitives"][0]["attributes"].erase("POSITION"); }},
      {"indices", [](Json& j) { j["meshes"][0]["primitives"][0]["indices"] = 0; }},
      {"mode", [](Json& j) { j["meshes"][0]["primitives"][0]["mode"] = 9; }},
      {"material", [](Json& j) { j["meshes"][0]["primitives"][0]["material"] = 0; }},
      {"no triangles", [](Json& j) { j["meshes"][0]["primitives"] = Json::array(); }},
      {"primitives must be a list", [](Json& j) { j["meshes"][0]["primitives"] = 3; }},
      {"nodes[0].mesh", [](Json& j) { j["nodes"][0]["mesh"] = 5; }},
      {"more than one parent", [](Json& j) { j["nodes"][0]["children"] = {0}; }},
      {"does not exist", [](Json& j) { j["scenes"][0]["nodes"] = {4}; }},
      {"scene", [](Json& j) { j["scene"] = 2; }},
      {"rotation",
       [](Json& j) {
         j["nodes"][0]["rotation"] = {0, 0, 0, 0};
       }},
      {"rotation",
       [](Json& j) {
         j["nodes"][0]["rotation"] = {0, 0, 1};
       }},
      {"matrix", [](Json& j) { j["nodes"][0]["matrix"] = "x"; }},
      {"no triangles",
       [](Json& j) {
         j["nodes"][0]["scale"] = {0, 0, 0};
       }},
      {"1e18",
       [](Json& j) {
         j["nodes"][0]["translation"] = {1e20, 0, 0};
       }},
  };
  for (const auto& [words, change] : cases) {
    GltfBuilder gltf;
    gltf.square();
    change(gltf.json);
    const std::string message = error_of([&] { gltf.read(); });
    EXPECT_NE(message.find(words), std::string::npos) << words << ": " << message;
    EXPECT_NE(message.find("test.gltf"), std::string::npos) << message;
  }
}

TEST(Gltf, NumbersThatAreNotFiniteAreRefused) {
  GltfBuilder gltf;
  gltf.square()["attributes"]["POSITION"] =
      gltf.floats({0, 0, 0, 1, std::nanf(""), 0, 1, 1, 0, 0, 1, 0}, 3);
  EXPECT_NE(error_of([&] { gltf.read(); }).find("not finite"), std::string::npos);
}

TEST(Gltf, DeepNestingIsRefused) {
  std::string text = R"({"asset":{"version":"2.0"},"extras":)";
  text += std::string(200000, '[') + std::string(200000, ']') + "}";
  EXPECT_THROW(parse_gltf(std::as_bytes(std::span(text)), "deep.gltf"), InvalidInput);
}

TEST(Gltf, TruncatedAndRandomFilesAreErrors) {
  const TempFolder folder;
  GltfBuilder gltf;
  gltf.square();
  const std::string whole = gltf.text();
  for (std::size_t size = 0; size < whole.size(); size += 7) {
    const auto part = std::as_bytes(std::span(whole).first(size));
    EXPECT_THROW(parse_gltf(part, "part.gltf"), InvalidInput);
  }
  Random random(1);
  for (int attempt = 0; attempt < 500; ++attempt) {
    std::string bytes = whole;
    for (int i = 0; i < 3; ++i)
      bytes[random.next() % bytes.size()] = static_cast<char>(random.next());
    // Some damage cannot be seen; what is read holds together all the same.
    try {
      const Model model = parse_gltf(std::as_bytes(std::span(bytes)), "noise.gltf");
      EXPECT_TRUE(test::holds_together(model));
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("noise.gltf"), std::string::npos) << error.what();
    }
  }
  EXPECT_THROW(read_model(folder / "missing.glb"), IoError);
  EXPECT_THROW(read_model(folder.path()), InvalidInput);
  EXPECT_THROW(read_model(folder / "model.fbx"), InvalidInput);
  write_file(folder / "empty.gltf", std::string_view());
  EXPECT_THROW(read_model(folder / "empty.gltf"), InvalidInput);
}

TEST(Gltf, MissingBuffersAreNamed) {
  const std::string text =
      R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":4,"uri":"gone%20away.bin"}]})";
  const std::string message =
      error_of([&] { parse_gltf(std::as_bytes(std::span(text)), "/none/a.gltf"); });
  EXPECT_NE(message.find("/none/gone away.bin"), std::string::npos) << message;
}

}  // namespace
}  // namespace normalshop
