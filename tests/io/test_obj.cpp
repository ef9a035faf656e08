#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <span>

#include "io/holds_together.h"
#include "io/temp_folder.h"
#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "normalshop/core/error.h"
#include "normalshop/core/random.h"
#include "normalshop/core/slope.h"
#include "normalshop/io/atomic_file.h"
#include "normalshop/io/detail/polygon.h"
#include "normalshop/io/image_file.h"
#include "normalshop/io/model.h"

namespace normalshop {
namespace {

using test::TempFolder;

Model parse(const std::string& text, const ModelReadOptions& options = {}) {
  return parse_obj(std::as_bytes(std::span(text)), "/none/test.obj", options);
}

const std::string square =
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 2\n";

double area(std::span<const Vec3f> p, const std::array<int, 3>& t) {
  const auto at = [&](std::size_t k) { return p[static_cast<std::size_t>(t[k])]; };
  return 0.5 * static_cast<double>((at(1) - at(0)).cross(at(2) - at(0)).z());
}

TEST(Polygon, QuadsAreCutAlongTheShorterDiagonalInUv) {
  const std::vector<Vec3f> p = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  std::vector<Vec2f> uv = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  EXPECT_EQ(triangulate(p, uv)[1], (std::array<int, 3>{0, 2, 3}));
  uv[2] = {1.5F, 1.5F};
  EXPECT_EQ(triangulate(p, uv)[1], (std::array<int, 3>{1, 2, 3}));
}

TEST(Polygon, ConcaveShapesAreCoveredOnce) {
  const std::vector<std::vector<Vec3f>> shapes = {
      {{0, 0, 0}, {2, 0, 0}, {0.5F, 0.5F, 0}, {0, 2, 0}},
      {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {2, 1, 0}, {0, 4, 0}},
      {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 2, 0}, {1, 2, 0}, {0, 2, 0}}};
  const std::vector<double> areas = {1.0, 10.0, 4.0};
  for (std::size_t s = 0; s < shapes.size(); ++s) {
    for (std::size_t turn = 0; turn < shapes[s].size(); ++turn) {
      std::vector<Vec3f> p = shapes[s];
      std::rotate(p.begin(), p.begin() + static_cast<std::ptrdiff_t>(turn), p.end());
      const std::vector<Vec2f> uvs(p.size(), Vec2f(0, 0));
      const auto triangles = triangulate(p, uvs);
      ASSERT_EQ(triangles.size(), p.size() - 2);
      double sum = 0.0;
      for (const auto& t : triangles) {
        EXPECT_GE(area(p, t), 0.0);
        sum += area(p, t);
      }
      EXPECT_NEAR(sum, areas[s], 1e-6);
    }
  }
}

/// Corners without an ear, as no program writes them: an answer all the same, and soon.
TEST(Polygon, CraftedPolygonsEnd) {
  const std::size_t n = 300000;
  std::vector<Vec3f> same(n, Vec3f(1, 2, 3));
  std::vector<Vec3f> turning(n);
  for (std::size_t i = 0; i < n; ++i) {
    const float a = 2.4F * static_cast<float>(i % 4096);
    turning[i] = {std::cos(a), std::sin(a), 0.0F};
  }
  for (const auto& p : {same, turning}) {
    const auto triangles = triangulate(p, std::vector<Vec2f>(n, Vec2f(0, 0)));
    ASSERT_EQ(triangles.size(), n - 2);
    std::vector<int> uses(n, 0);
    for (const auto& t : triangles) {
      for (const int corner : t) ++uses[static_cast<std::size_t>(corner)];
    }
    EXPECT_EQ(std::count(uses.begin(), uses.end(), 0), 0);
  }
}

TEST(Obj, VRunsDownInTheMesh) {
  const Model model = parse(square + "f 1/1/1 2/2/1 3/3/1 4/4/1\n");
  ASSERT_EQ(model.mesh.triangle_count(), 2U);
  EXPECT_EQ(model.mesh.uvs[0], Vec2f(0, 1));
  EXPECT_EQ(model.mesh.uvs[2], Vec2f(1, 0));
  EXPECT_TRUE(model.has_normals);
  EXPECT_EQ(model.mesh.normals[0], Vec3f(0, 0, 1));
  EXPECT_EQ(parse(square + "f 1/1 2/2 3/3\n", {.flip_v = true}).mesh.uvs[0], Vec2f(0, 0));
}

TEST(Obj, NegativeIndicesContinuationsAndMissingNormals) {
  const Model model = parse(square + "f -4/-4 -3/-3 \\\n -2/-2 # end\r\nf 1//1 2//1 3//1\n");
  ASSERT_EQ(model.mesh.triangle_count(), 1U);
  EXPECT_EQ(model.mesh.triangles[0], Vec3u(0, 1, 2));
  EXPECT_FALSE(model.has_normals);
  EXPECT_LT(angle_degrees(model.mesh.normals[0], Vec3f::UnitZ()), 1e-4);
  ASSERT_EQ(model.notes.size(), 2U);
}

TEST(Obj, AFaceMayHaveMoreThan255Corners) {
  std::string text;
  std::string face = "f";
  for (int i = 0; i < 400; ++i) {
    const double a = 6.283185307 * i / 400;
    text += "v " + std::to_string(std::cos(a)) + " " + std::to_string(std::sin(a)) + " 0\nvt 0 0\n";
    face += " " + std::to_string(i + 1) + "/" + std::to_string(i + 1);
  }
  EXPECT_EQ(parse(text + face + "\n").mesh.triangle_count(), 398U);
}

TEST(Obj, BadLinesAreNamedByNumber) {
  for (const char* line :
       {"f 1/1 2/2", "f 1/1 2/2 9/1", "f 0/1 1/1 2/1", "f -5/1 1/1 2/1", "f 1/9 2/1 3/1", "f a b c",
        "f 1/1/7 2/2/1 3/3/1", "f 1/1 2/2 99999999999999999999/1", "v 1 2", "v 1 2 nan",
        "v 1 2 1e99", "v 1 2 x", "vt inf 0", "vt", "vn 0 0", "f 1/1 2/2 -9223372036854775808/1"}) {
    try {
      parse(square + line + "\n");
      ADD_FAILURE() << line;
    } catch (const InvalidInput& error) {
      EXPECT_NE(std::string(error.what()).find("line 10"), std::string::npos) << error.what();
    }
  }
  EXPECT_THROW(parse(""), InvalidInput);
  EXPECT_THROW(parse(square), InvalidInput);
  EXPECT_THROW(parse(square + "f 1 2 3\n"), InvalidInput);
}

TEST(Obj, RandomBytesAreErrorsOrModels) {
  Random random(5);
  const std::string good = square + "usemtl a\nf 1/1/1 2/2/1 3/3/1 4/4/1\n";
  for (int attempt = 0; attempt < 2000; ++attempt) {
    std::string bytes = good;
    for (int i = 0; i < 4; ++i)
      bytes[random.next() % bytes.size()] = static_cast<char>(random.next());
    // Some damage cannot be seen; what is read holds together all the same.
    try {
      EXPECT_TRUE(test::holds_together(parse(bytes)));
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("test.obj"), std::string::npos) << error.what();
    }
  }
}

class ObjWithMaterials : public ::testing::Test {
 protected:
  void SetUp() override {
    RawImage normals(8, 8, 3, CodeType::U8);
    for (std::size_t i = 0; i < normals.size_bytes(); ++i) {
      normals.data()[i] = i % 3 == 2 ? 255 : static_cast<std::uint8_t>(120 + i % 16);
    }
    std::filesystem::create_directories(folder_ / "in/maps");
    std::filesystem::create_directories(folder_ / "out");
    write_image(folder_ / "in/maps/n.png", normals);
    RawImage height(8, 8, 1, CodeType::U8);
    std::fill_n(height.data(), 64, std::uint8_t{90});
    write_image(folder_ / "in/maps/h.png", height);
    write_image(folder_ / "in/maps/c d.png", normals);
    write_file(folder_ / "in/my lib.mtl", std::string_view(library_));
    write_file(folder_ / "in/a.obj", std::string_view(object_));
  }
  TempFolder folder_;
  const std::string library_ =
      "# lib\nnewmtl one\nKd 0.5 0.25 1\nnorm maps/n.png\n\nnewmtl two\r\nmap_Kd maps\\c d.png\r\n"
      "bump -bm 2 maps/h.png\r\nnewmtl three\nmap_Bump maps/n.png\n";
  const std::string object_ =
      "# head\r\nmtllib my lib.mtl\r\n" + square +
      "vt 0.25 0.75 0.0\no thing\nusemtl one\nf 1/1/1 2/2/1 3/3/1 4/4/1\ng x\nusemtl two\n"
      "f 1/1 2/2 3/3 # tail\nusemtl three\nf 1/5 2/2 3/3\n";
};

TEST_F(ObjWithMaterials, GiveTextureSets) {
  const Model model = read_model(folder_ / "in/a.obj");
  ASSERT_EQ(model.texture_sets.size(), 2U);  // one and three share their normal map
  EXPECT_EQ(model.texture_sets[0].name, "one");
  EXPECT_EQ(model.texture_sets[0].materials, (std::vector<int>{0, 2}));
  EXPECT_EQ(model.texture_sets[0].normal_map->path, folder_ / "in/maps/n.png");
  EXPECT_EQ(model.texture_sets[0].albedo_factor, Vec3f(0.5F, 0.25F, 1.0F));
  EXPECT_EQ(model.texture_sets[1].albedo->path, folder_ / "in/maps/c d.png");
  EXPECT_FALSE(model.texture_sets[1].normal_map.has_value());
  EXPECT_EQ(model.mesh.texture_sets, (std::vector<std::uint32_t>{0, 0, 1, 0}));
}

TEST_F(ObjWithMaterials, AreWrittenBackLineByLine) {
  const Model model = read_model(folder_ / "in/a.obj");
  write_model(model, folder_ / "out/b.obj", {{0, {"one_normal.png"}}, {1, {"two_normal.png"}}});
  std::string expected = object_;
  expected.replace(expected.find("mtllib my lib.mtl\r\n"), 19, "mtllib b.mtl\n");
  EXPECT_EQ(read_file(folder_ / "out/b.obj"), expected);
  EXPECT_EQ(read_file(folder_ / "out/b.mtl"),
            "# lib\nnewmtl one\nKd 0.5 0.25 1\n\nnorm one_normal.png\nnewmtl two\r\n"
            "map_Kd maps\\c d.png\r\nbump -bm 2 maps/h.png\r\nnorm two_normal.png\nnewmtl three\n"
            "norm one_normal.png\n");
  EXPECT_TRUE(std::filesystem::exists(folder_ / "out/maps/h.png"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "out/maps/c d.png"));
  const Model back = read_model(folder_ / "out/b.obj");
  EXPECT_EQ(back.texture_sets[1].normal_map->path, folder_ / "out/two_normal.png");
  EXPECT_EQ(back.mesh.uvs, model.mesh.uvs);
}

/// The object written back with these libraries in place; returns out/b.obj and out/b.mtl.
class ObjWriterText : public ObjWithMaterials {
 protected:
  std::pair<std::string, std::string> written(
      const std::string& object, const std::map<std::string, std::string>& libraries = {},
      const ModelReadOptions& options = {}) {
    for (const auto& [name, text] : libraries) {
      std::filesystem::create_directories((folder_ / name).parent_path());
      write_file(folder_ / name, std::string_view(text));
    }
    write_file(folder_ / "in/x.obj", std::string_view(object));
    model_ = read_model(folder_ / "in/x.obj", options);
    std::map<std::size_t, MapReferences> maps;
    for (std::size_t i = 0; i < model_.texture_sets.size(); ++i) {
      maps[i] = {"set" + std::to_string(i) + ".png"};
    }
    notes_ = write_model(model_, folder_ / "out/b.obj", maps).notes;
    back_ = read_model(folder_ / "out/b.obj");
    return {read_file(folder_ / "out/b.obj"), read_file(folder_ / "out/b.mtl")};
  }
  Model model_;
  Model back_;
  std::vector<std::string> notes_;
};

TEST_F(ObjWriterText, NamesMayHoldNumberSigns) {
  const auto [object, library] =
      written("mtllib a#b.mtl\n" + square +
                  "usemtl Material #25\nf 1/1 2/2 3/3\nusemtl Material #26\nf 1/1 3/3 4/4\n"
                  "usemtl plain # a comment\nf 1/1 2/2 4/4\nusemtl  spaced\nf 2/2 3/3 4/4\n",
              {{"in/a#b.mtl",
                "newmtl Material #25\nmap_Kd maps/h.png\nnewmtl Material #26\nnewmtl plain\n"
                "map_Kd maps/c d.png\nnewmtl   spaced\nKd 0.25 0.5 1\n"}});
  ASSERT_EQ(model_.texture_sets.size(), 4U);
  EXPECT_EQ(model_.texture_sets[0].albedo->path, folder_ / "in/maps/h.png");
  EXPECT_FALSE(model_.texture_sets[1].albedo.has_value());
  EXPECT_EQ(model_.texture_sets[2].albedo->path, folder_ / "in/maps/c d.png");
  EXPECT_EQ(model_.texture_sets[3].albedo_factor, Vec3f(0.25F, 0.5F, 1.0F));
  ASSERT_EQ(back_.texture_sets.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(back_.texture_sets[i].normal_map->path,
              folder_ / ("out/set" + std::to_string(i) + ".png"));
  }
  EXPECT_EQ(library.find("newmtl Material\n"), std::string::npos) << library;
}

TEST_F(ObjWriterText, CopiedTexturesAreNamedWhereTheyLie) {
  const std::string object =
      "mtllib sub/s.mtl\nmtllib t.mtl\n" + square + "usemtl s\nf 1/1 2/2 3/3\n";
  const auto [text, library] =
      written(object, {{"in/sub/s.mtl", "newmtl s\r\nmap_Kd -s 2 2 2 c d.png \r\nKs 1 1 1\r\n"},
                       {"in/sub/c d.png", "first"},
                       {"in/t.mtl", "newmtl t\nmap_Kd ./c d.png\nmap_Ks ../tex/c d.png\n"},
                       {"in/c d.png", "second"},
                       {"tex/c d.png", "third"}});
  EXPECT_EQ(library,
            "newmtl s\r\nmap_Kd -s 2 2 2 sub/c d.png \r\nKs 1 1 1\r\nnorm set0.png\n"
            "newmtl t\nmap_Kd ./c d.png\nmap_Ks c d_2.png\n");
  EXPECT_EQ(read_file(folder_ / "out/sub/c d.png"), "first");
  EXPECT_EQ(read_file(folder_ / "out/c d.png"), "second");
  EXPECT_EQ(read_file(folder_ / "out/c d_2.png"), "third");
  EXPECT_TRUE(notes_.empty()) << notes_[0];
}

TEST_F(ObjWriterText, FlippingTouchesTheSecondNumberAlone) {
  const auto [text, library] = written(
      "v 0 0 0\nv 1 0 0\nv 1 1 0\n  vt\t0.250  +0.750 0.5 # v 1\r\nvt 0.5 \\\n  0.25\nvt 1\n"
      "f 1/1 2/2 3/3\n",
      {}, {.flip_v = true});
  EXPECT_NE(text.find("  vt\t0.250  0.25 0.5 # v 1\r\nvt 0.5 \\\n  0.75\nvt 1 1\n"),
            std::string::npos)
      << text;
  EXPECT_EQ(back_.mesh.uvs, model_.mesh.uvs);
}

/// The file is called x.obj, so that is what its faces without a material would be called too.
TEST_F(ObjWriterText, FacesWithoutAMaterialGetANameOfTheirOwn) {
  const auto [text, library] =
      written("mtllib x.mtl\n" + square + "f 1/1 2/2 3/3\nusemtl x\nf 1/1 3/3 4/4\n",
              {{"in/x.mtl", "newmtl x\nKd 0.5 0.5 0.5\nnewmtl x_2\n"}});
  EXPECT_NE(text.find("usemtl x_3\nf 1/1 2/2 3/3\nusemtl x\nf"), std::string::npos) << text;
  ASSERT_EQ(back_.texture_sets.size(), 2U);
  EXPECT_EQ(back_.texture_sets[0].normal_map->path, folder_ / "out/set0.png");
  EXPECT_EQ(back_.texture_sets[1].normal_map->path, folder_ / "out/set1.png");
}

TEST_F(ObjWithMaterials, FlippedVIsWrittenFlipped) {
  const Model model = read_model(folder_ / "in/a.obj", {.flip_v = true});
  write_model(model, folder_ / "out/b.obj", {{0, {"n.png"}}});
  EXPECT_EQ(read_model(folder_ / "out/b.obj").mesh.uvs, model.mesh.uvs);
}

TEST_F(ObjWithMaterials, NewColoursTakeThePlaceOfTheOld) {
  const Model model = read_model(folder_ / "in/a.obj");
  write_model(model, folder_ / "out/b.obj", {{1, {"", false, "two_color.png"}}});
  EXPECT_EQ(read_file(folder_ / "out/b.mtl"),
            "# lib\nnewmtl one\nKd 0.5 0.25 1\nnorm maps/n.png\n\nnewmtl two\r\n"
            "bump -bm 2 maps/h.png\r\nmap_Kd two_color.png\nnewmtl three\nmap_Bump maps/n.png\n");
  const Model back = read_model(folder_ / "out/b.obj");
  EXPECT_EQ(back.texture_sets[1].albedo->path, folder_ / "out/two_color.png");
}

TEST(ObjLibrary, MissingOnesAreNoted) {
  const Model model = parse("mtllib gone.mtl\n" + square + "usemtl a\nf 1/1 2/2 3/3\n");
  ASSERT_EQ(model.texture_sets.size(), 1U);
  EXPECT_EQ(model.texture_sets[0].name, "a");
  EXPECT_NE(model.notes.back().find("gone.mtl"), std::string::npos);
}

}  // namespace
}  // namespace normalshop
