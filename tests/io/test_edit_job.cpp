#include <cmath>
#include <cstring>
#include <numbers>

#include "io/temp_folder.h"
#include "support/data.h"
#include "support/meshes.h"
#include "support/same_codes.h"
#include <gtest/gtest.h>

#include "normalshop/core/error.h"
#include "normalshop/core/parallel.h"
#include "normalshop/core/slope.h"
#include "normalshop/io/atomic_file.h"
#include "normalshop/io/edit_report.h"
#include "normalshop/io/file_assets.h"
#include "normalshop/io/gltf_export.h"
#include "normalshop/io/image_file.h"
#include "normalshop/surface/convert_space.h"

/// Models opened, edited and exported, from files to files.
namespace normalshop {
namespace {

namespace fs = std::filesystem;
using test::data_file;
using test::same_codes;
using test::TempFolder;

Recipe recipe(const std::string& edits, const fs::path& folder = ".") {
  FileAssets assets(folder);
  return parse_recipe(R"({"version": 1, "edits": [)" + edits + "]}", "test.json", assets);
}

std::string pen(const std::string& view, const std::string& strokes, double width,
                const std::string& more = "") {
  return R"({"operator": "pen", "view": )" + view + R"(, "options": {"width": )" +
         std::to_string(width) + R"(, "height": )" + std::to_string(0.3 * width) +
         R"(}, "strokes": )" + strokes + more + "}";
}

/// A normal map of smooth waves.
RawImage waves(int width, int height, CodeType type) {
  NormalMap map = flat_normal_map(width, height, type);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double u = 2.0 * std::numbers::pi * x / width;
      const double v = 2.0 * std::numbers::pi * y / height;
      map.set_normal(x, y,
                     normal_from_slope(Vec2f(static_cast<float>(0.4 * std::sin(3.0 * u)),
                                             static_cast<float>(0.4 * std::cos(2.0 * v)))));
    }
  }
  return map.encode();
}

/// The mesh as a glTF file that names `map_name`.
fs::path write_model_file(const TempFolder& folder, const Mesh& mesh, const std::string& map_name) {
  const fs::path path = folder / "model.gltf";
  std::vector<GltfMaterial> materials;
  for (const std::string& name : mesh.texture_set_names) {
    GltfMaterial material;
    material.name = name;
    material.normal_map = map_name;
    materials.push_back(material);
  }
  export_gltf(path, mesh, materials);
  return path;
}

OpenOptions head_options() {
  OpenOptions options;
  if (const auto model = data_file("lee_perry_smith/LeePerrySmith.glb")) {
    options.model = *model;
    options.normal_maps = {
        data_file("lee_perry_smith/Infinite-Level_02_Tangent_SmoothUV.jpg")->string()};
    options.flip_v = true;
  }
  return options;
}

OpenOptions bottle_options() {
  OpenOptions options;
  if (const auto model = data_file("khr_waterbottle/WaterBottle.gltf")) options.model = *model;
  return options;
}

const char* const no_data = "the real data is not on this machine";

struct Round {
  double mean = 0.0;
  double largest = 0.0;
};

/// Angles of two maps where triangles own the texels.
Round covered_angles(const NormalMap& a, const NormalMap& b, const TexelMap& texels) {
  Round round;
  std::size_t count = 0;
  for (int y = 0; y < a.height(); ++y) {
    for (int x = 0; x < a.width(); ++x) {
      if (texels.owner()(x, y) == no_triangle || a.normal(x, y).isZero()) continue;
      const double angle = angle_degrees(a.normal(x, y), b.normal(x, y));
      round.mean += angle;
      round.largest = std::max(round.largest, angle);
      ++count;
    }
  }
  round.mean /= static_cast<double>(count);
  return round;
}

/// Object space -> tangent space at 16 bit -> file -> object space at 16 bit, through the reader.
Round object_round_trip(const OpenOptions& options, const TempFolder& folder) {
  const OpenedDocument opened = open_document(options);
  const auto exported = [&](const OpenedDocument& from, ExportPreset preset, const char* name) {
    const fs::path path = folder / name;
    write_image(path, export_map(from, 0, {preset, CodeType::U16}));
    OpenOptions again = options;
    again.size = 0;
    again.normal_maps = {path.string()};
    again.space = preset == ExportPreset::Object ? NormalSpace::Object : NormalSpace::Tangent;
    again.green_down = false;
    return open_document(again);
  };
  const OpenedDocument object = exported(opened, ExportPreset::Object, "object.png");
  const OpenedDocument tangent = exported(object, ExportPreset::Gltf, "tangent.png");
  const OpenedDocument back = exported(tangent, ExportPreset::Object, "back.png");
  const StorageSet& first = object.document.storage().sets[0];
  return covered_angles(first.normals, back.document.storage().sets[0].normals, first.texels);
}

TEST(EditJob, KeepsEveryCodeOfRealMapsWithoutAnEdit) {
  for (const OpenOptions& options : {head_options(), bottle_options()}) {
    if (options.model.empty()) GTEST_SKIP() << no_data;
    const TempFolder folder;
    const EditJob job = run_edit_job(options, {}, folder / "out", {});
    const fs::path own = options.normal_maps.empty()
                             ? *data_file("khr_waterbottle/WaterBottle_normal.png")
                             : fs::path(options.normal_maps[0]);
    EXPECT_TRUE(same_codes(read_image(own), read_image(job.files[0]))) << own;
  }
}

TEST(EditJob, KeepsTheCodesAroundAnEditOfARealMap) {
  const OpenOptions options = bottle_options();
  if (options.model.empty()) GTEST_SKIP() << no_data;
  const TempFolder folder;
  const EditJob job =
      run_edit_job(options, recipe(pen(R"("front")", "[[[-0.05, 0], [0.05, 0.01]]]", 0.006)),
                   folder / "out", {});
  const RawImage before = read_image(*data_file("khr_waterbottle/WaterBottle_normal.png"));
  const RawImage after = read_image(job.files[0]);
  const NormalMap& map = job.opened.document.storage().sets[0].normals;
  ASSERT_GT(map.edited_count(), 1000U);
  std::size_t changed = 0;
  for (int y = 0; y < map.height(); ++y) {
    for (int x = 0; x < map.width(); ++x) {
      const auto at = static_cast<std::ptrdiff_t>(x) * before.channels();
      const bool same = std::memcmp(before.row_data(y) + at, after.row_data(y) + at,
                                    static_cast<std::size_t>(before.channels())) == 0;
      ASSERT_TRUE(same || map.edited(x, y)) << x << " " << y;
      changed += same ? 0 : 1;
    }
  }
  EXPECT_GT(changed, map.edited_count() / 2);
}

TEST(EditJob, ComesBackFromTangentSpaceOfTheHead) {
  const TempFolder folder;
  const OpenOptions options = head_options();
  if (options.model.empty()) GTEST_SKIP() << no_data;
  const Round round = object_round_trip(options, folder);
  RecordProperty("mean_degrees", std::to_string(round.mean));
  EXPECT_LE(round.mean, 0.02);
}

TEST(EditJob, ComesBackFromTangentSpaceOfTheBottle) {
  const TempFolder folder;
  OpenOptions options = bottle_options();
  options.size = 1024;
  if (options.model.empty()) GTEST_SKIP() << no_data;
  const Round round = object_round_trip(options, folder);
  RecordProperty("mean_degrees", std::to_string(round.mean));
  EXPECT_LE(round.mean, 0.02);
}

TEST(EditJob, ComesBackFromTangentSpaceOfMirroredUvs) {
  const TempFolder folder;
  write_image(folder / "waves.png", waves(128, 128, CodeType::U16));
  OpenOptions options;
  options.model = write_model_file(folder, test::mirrored_pair(4), "waves.png");
  EXPECT_LE(object_round_trip(options, folder).mean, 0.02);
}

/// An edit on the half whose UVs are the mirrored ones of the other.
TEST(EditJob, EditsTheMirroredHalf) {
  const TempFolder folder;
  write_image(folder / "flat.png", flat_normal_map(256, 256, CodeType::U16).codes());
  OpenOptions options;
  options.model = write_model_file(folder, test::mirrored_pair(4), "flat.png");
  options.green_down = false;
  const std::string view = R"({"direction": [0, 0, 1], "center": [-0.5, 0.5, 0], "width": 1})";
  // A ridge along y at x = -0.3: it rises towards it from both sides.
  const EditJob job =
      run_edit_job(options,
                   recipe(R"({"operator": "pen", "view": )" + view +
                          R"(, "options": {"profile": "bump", "width": 0.2, "height": 0.02},
                 "strokes": [[[0.2, -0.3], [0.2, 0.3]]]})"),
                   folder / "out", {});
  EXPECT_GT(job.edits[0].pushed.largest_change, 5.0F);
  const NormalMap& map = job.opened.document.storage().sets[0].normals;
  // u = |x|: left of the ridge lies right in the map.
  const Vec3f left = map.normal(static_cast<int>(0.34F * 256.0F), 128);
  const Vec3f right = map.normal(static_cast<int>(0.26F * 256.0F), 128);
  const Mesh& mesh = job.opened.document.mesh();
  const TexelMap& texels = job.opened.document.storage().sets[0].texels;
  ASSERT_FALSE(texels.shared().empty());
  // The right half owns the texels: in its frame u runs right, so codes read by it lean outwards.
  EXPECT_GT(std::abs(left.x()), 0.05F);
  EXPECT_NEAR(left.x(), -right.x(), 0.02F);
  std::uint32_t mirrored = no_triangle;
  const auto wanted = static_cast<std::uint32_t>(128 * 256 + static_cast<int>(0.34F * 256.0F));
  for (const SharedTexel& s : texels.shared()) {
    if (s.texel == wanted) mirrored = s.triangle;
  }
  ASSERT_NE(mirrored, no_triangle);
  const SurfacePoint point = texels.surface_point(mirrored, static_cast<int>(0.34F * 256.0F), 128);
  EXPECT_LT(position_at(mesh, point).x(), -0.3F);
  // In object space the slope left of a ridge faces left.
  EXPECT_LT(frame_at(mesh, point, NormalSpace::Tangent).object_normal(left).x(), -0.05F);
}

/// On a sphere of radius 1 a height is its part of the radius of curvature.
TEST(EditJob, NotesReliefThatIsHighBesideTheCurvature) {
  const auto notes_of = [](const std::string& height, const std::string& rule) {
    const TempFolder folder;
    write_image(folder / "flat.png", flat_normal_map(256, 256, CodeType::U16).codes());
    OpenOptions options;
    options.model = write_model_file(folder, test::uv_sphere(64, 32), "flat.png");
    options.green_down = false;
    const EditJob job = run_edit_job(
        options,
        recipe(R"({"operator": "pen", "view": "front", "mode": "base", "curvature": ")" + rule +
               R"(", "options": {"profile": "bump", "width": 0.5, "height": )" + height +
               R"(}, "strokes": [[[0, 0]]]})"),
        folder / "out", {});
    const std::string report = read_file(folder / "out/report.json");
    EXPECT_NE(report.find("\"largest_height_over_radius\""), std::string::npos);
    EXPECT_NE(report.find("\"passes_centre_of_curvature\": false"), std::string::npos);
    std::string notes;
    for (const std::string& note : job.notes) notes += note + "\n";
    return notes;
  };
  EXPECT_EQ(notes_of("0.05", "drop").find("radius"), std::string::npos);
  EXPECT_NE(notes_of("0.12", "drop").find("12 % of the surface's radius of curvature; \"curv"),
            std::string::npos);
  EXPECT_NE(notes_of("0.12", "keep").find("more than the 7 %"), std::string::npos);
}

TEST(EditJob, EditsWhereUvsRepeat) {
  const TempFolder folder;
  Mesh mesh = test::plane_grid(4);
  const RawImage codes = waves(128, 128, CodeType::U8);
  write_image(folder / "waves.png", codes);
  std::array<RawImage, 2> results;
  for (std::size_t k = 0; k < 2; ++k) {
    OpenOptions options;
    options.model = write_model_file(folder, mesh, "waves.png");
    const EditJob job =
        run_edit_job(options, recipe(pen(R"("front")", "[[[-0.4, 0.1], [0.4, -0.1]]]", 0.1)),
                     folder / ("out" + std::to_string(k)), {});
    EXPECT_GT(job.edits[0].pushed.changed, 500U);
    results[k] = read_image(job.files[0]);
    for (Vec2f& uv : mesh.uvs) uv += Vec2f(2.0F, -3.0F);
  }
  EXPECT_TRUE(same_codes(results[0], results[1]));
}

/// Two meshes on one atlas under a turned and scaled node: both are edited, lengths are those of
/// the world.
TEST(EditJob, EditsInTheWorldOfTheNodes) {
  const TempFolder folder;
  write_image(folder / "flat.png", flat_normal_map(256, 256, CodeType::U16).codes());
  const fs::path path = write_model_file(folder, test::plane_grid(4), "flat.png");
  std::string text = read_file(path);
  // A quarter turn about x takes +z to -y; three times as large.
  const std::string node = R"("mesh": 0)";
  const std::size_t at =
      text.find(node) != std::string::npos ? text.find(node) : text.find(R"("mesh":0)");
  ASSERT_NE(at, std::string::npos) << text;
  text.insert(at, R"("rotation": [0.70710678, 0, 0, 0.70710678], "scale": [3, 3, 3], )");
  write_file(path, text);
  OpenOptions options;
  options.model = path;
  const EditJob job = run_edit_job(
      options,
      recipe(pen(R"({"direction": [0, -1, 0], "up": [0, 0, 1]})", "[[[-1, 0], [1, 0]]]", 0.3)),
      folder / "out", {});
  const NormalMap& map = job.opened.document.storage().sets[0].normals;
  int reach = 0;
  for (int y = 0; y < 256; ++y) reach += map.edited(128, y) ? 1 : 0;
  // 0.3 of 3 units are 26 of 256 texels; spread by what keeps a crease free of stairs.
  EXPECT_NEAR(reach, 26, 8);
}

TEST(EditJob, ReportsFilesWithTheirFolders) {
  const TempFolder folder;
  fs::create_directories(folder / "maps");
  write_image(folder / "maps/n.png", flat_normal_map(16, 16, CodeType::U8).codes());
  OpenOptions options;
  options.model = write_model_file(folder, test::plane_grid(1), "maps/n.png");
  const EditJob job = run_edit_job(options, {}, folder / "out", {});
  const Value report = report_value(job);
  const Value::Array& files = *report.find("files")->array();
  ASSERT_EQ(files.size(), job.files.size());
  bool in_maps = false;
  for (const Value& file : files) {
    EXPECT_TRUE(fs::is_regular_file(folder / "out" / *file.text())) << *file.text();
    in_maps = in_maps || *file.text() == "maps/n.png";
  }
  EXPECT_TRUE(in_maps);
  EXPECT_NE(read_file(folder / "out/report.json").find("\"maps/n.png\""), std::string::npos);
}

/// A red disc in the middle of grey, alpha included.
RawImage red_disc(int size) {
  RawImage codes(size, size, 4, CodeType::U8);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const bool inside = std::hypot(x - size / 2, y - size / 2) < 0.1 * size;
      auto* code = codes.row<std::uint8_t>(y) + static_cast<std::ptrdiff_t>(4 * x);
      code[0] = inside ? 220 : 120;
      code[1] = code[2] = 120;
      code[3] = 77;
    }
  }
  return codes;
}

const char* const grab_right =
    R"({"operator": "warp", "view": "front", "options": {"kind": "grab", "radius": 0.4},
        "strokes": [[[0, 0], [0.15, 0]]]})";

/// The square with waves, and that file for its colours, which shows the disc.
OpenOptions colored_square(const TempFolder& folder, const fs::path& colors, int size) {
  write_image(folder / "n.png", waves(64, 64, CodeType::U8));
  write_image(colors, red_disc(size));
  OpenOptions options;
  options.model = write_model_file(folder, test::plane_grid(1), "n.png");
  options.albedos = {colors.string()};
  return options;
}

TEST(EditJob, ColoursThatMoveAreWritten) {
  const TempFolder folder;
  const OpenOptions options = colored_square(folder, folder / "c.png", 128);
  const EditJob job = run_edit_job(options, recipe(grab_right), folder / "out", {});
  const RawImage moved = read_image(folder / "out/map_color.png");
  const RawImage before = red_disc(128);
  ASSERT_EQ(moved.channels(), 4);
  ASSERT_EQ(moved.width(), 128);
  EXPECT_GT(moved.code(64 + 16, 64, 0), 200.0F);
  EXPECT_LT(moved.code(64 - 10, 64, 0), 135.0F);
  for (int y = 0; y < 128; ++y) {
    for (int x = 0; x < 128; ++x) {
      ASSERT_EQ(moved.code(x, y, 3), 77.0F);
      if (std::hypot(x - 64, y - 64) > 80) {
        ASSERT_EQ(moved.code(x, y, 0), before.code(x, y, 0));
      }
    }
  }
  // The written model shows them, though the one that was read names no colour map.
  const Model back = read_model(folder / "out/model.gltf");
  ASSERT_TRUE(back.texture_sets[0].albedo.has_value());
  EXPECT_EQ(back.texture_sets[0].albedo->path, folder / "out/map_color.png");
  EXPECT_GT(job.edits[0].colors_changed, 500U);
  EXPECT_NE(read_file(folder / "out/report.json").find("\"colors_changed\""), std::string::npos);
}

TEST(EditJob, ColoursThatStayAreNotWritten) {
  const TempFolder folder;
  const OpenOptions options = colored_square(folder, folder / "c.png", 64);
  run_edit_job(options, recipe(pen(R"("front")", "[[[-0.2, 0], [0.2, 0]]]", 0.1)), folder / "out",
               {});
  EXPECT_FALSE(fs::exists(folder / "out/map_color.png"));
}

TEST(EditJob, ColoursAreNotWrittenOverThoseTheyCameFrom) {
  const TempFolder folder;
  fs::create_directories(folder / "out");
  const OpenOptions options = colored_square(folder, folder / "out/map_color.png", 64);
  const std::string before = read_file(folder / "out/map_color.png");
  EXPECT_THROW(run_edit_job(options, recipe(grab_right), folder / "out", {}), InvalidInput);
  EXPECT_EQ(read_file(folder / "out/map_color.png"), before);
  EXPECT_FALSE(fs::exists(folder / "out/map_normal.png"));
}

/// All of the waves lie under the last level's one texel.
TEST(EditJob, WritesMipLevelsAndRoughness) {
  const TempFolder folder;
  write_image(folder / "waves.png", waves(128, 128, CodeType::U16));
  OpenOptions options;
  options.model = write_model_file(folder, test::plane_grid(2), "waves.png");
  ExportOptions how;
  how.mip_levels = true;
  how.roughness = 0.5F;
  how.roughness_level = 7;
  const EditJob job = run_edit_job(options, {}, folder / "out", how);
  EXPECT_EQ(read_image(folder / "out" / "map_normal_mip3.png").width(), 16);
  EXPECT_TRUE(fs::exists(folder / "out" / "map_normal_mip7.png"));
  EXPECT_FALSE(fs::exists(folder / "out" / "map_normal_mip8.png"));
  const RawImage roughness = read_image(folder / "out" / "map_roughness.png");
  ASSERT_EQ(roughness.width(), 1);
  // 0.4^2 / 2 along both axes.
  EXPECT_NEAR(roughness.code(0, 0, 0), 255.0F * std::pow(0.0625F + 0.16F, 0.25F), 0.6F);
  how.roughness_level = 8;
  EXPECT_THROW(run_edit_job(options, {}, folder / "none", how), InvalidInput);
  EXPECT_FALSE(fs::exists(folder / "none"));
}

TEST(EditJob, DoesNotDependOnThreads) {
  const TempFolder folder;
  write_image(folder / "waves.png", waves(256, 256, CodeType::U8));
  OpenOptions options;
  options.model = write_model_file(folder, test::uv_sphere(64, 32), "waves.png");
  const Recipe edits =
      recipe(pen(R"("left")", "[[[-0.6, 0.3], [0.6, -0.2]]]", 0.2) +
             R"(, {"operator": "smooth", "view": "front", "options": {"sigma": 0.05}})");
  const EditJob many = run_edit_job(options, edits, folder / "many", {});
  const ThreadLimit one(1);
  const EditJob single = run_edit_job(options, edits, folder / "one", {});
  ASSERT_EQ(many.files.size(), single.files.size());
  for (std::size_t i = 0; i + 1 < many.files.size(); ++i) {  // the last is the report, with times
    EXPECT_EQ(read_file(many.files[i]), read_file(single.files[i])) << many.files[i];
  }
}

TEST(EditNotes, TellHowMuchLongerThanTexelsPixelsAre) {
  Edit edit;
  edit.path = "r.json: edits[0]";
  EditReport report;
  report.texels_per_pixel = 1.0F;
  std::vector<std::string> notes;
  note_edit(edit, report, notes);
  EXPECT_TRUE(notes.empty());
  report.texels_per_pixel = 1.904F;
  note_edit(edit, report, notes);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_EQ(notes[0],
            "r.json: edits[0]: covers more texels than an editing chart has pixels, which are 90 % "
            "longer than the finest texels, so it comes out softer than the map could show; edit "
            "from nearer");
}

}  // namespace
}  // namespace normalshop
