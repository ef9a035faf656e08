#include <array>

#include "io/temp_folder.h"
#include "support/data.h"
#include "support/sanitized.h"
#include <gtest/gtest.h>

#include "normalshop/io/edit_report.h"
#include "normalshop/io/file_assets.h"
#include "normalshop/io/gltf_export.h"
#include "normalshop/io/image_file.h"
#include "normalshop/surface/shapes.h"

/// Both sides of the seams that an edit crosses agree afterwards as well as before.
namespace normalshop {
namespace {

using test::data_file;
using test::TempFolder;

/// Growth of the mismatch at the seams that these edits cross.
SeamMismatch growth(const OpenOptions& options, const std::string& edits,
                    const TempFolder& folder) {
  FileAssets assets(folder.path());
  const Recipe recipe =
      parse_recipe(R"({"version": 1, "edits": [)" + edits + "]}", "test.json", assets);
  return run_edit_job(options, recipe, folder / "out", {}).seams_growth;
}

void expect_small(const SeamMismatch& growth, std::size_t least) {
  EXPECT_GE(growth.count, least);
  EXPECT_LT(growth.mean, 0.1);
  EXPECT_LT(growth.p99, 1.0);
}

/// The sphere of six charts with a flat map; charts differ in size and are turned.
OpenOptions six_charts(const TempFolder& folder) {
  std::array<ChartSquare, 6> charts;
  for (std::size_t i = 0; i < charts.size(); ++i) {
    charts[i].center = {0.18F + 0.3F * static_cast<float>(i % 3), i < 3 ? 0.25F : 0.72F};
    charts[i].side = 0.12F + 0.02F * static_cast<float>(i % 4);
    charts[i].degrees = 17.0F * static_cast<float>(i);
  }
  GltfMaterial material;
  material.name = "map";
  material.normal_map = "flat.png";
  OpenOptions options;
  options.model = folder / "sphere.gltf";
  export_gltf(options.model, cube_sphere(16, charts, "map"), {material});
  write_image(folder / "flat.png", flat_normal_map(512, 512, CodeType::U16).codes());
  return options;
}

constexpr const char* corner_view = R"({"direction": [1, 1, 1], "width": 2.2})";

std::string on_corner(const std::string& fields) {
  return R"({"view": )" + std::string(corner_view) + ", " + fields + "}";
}

TEST(EditSeams, AgreeUnderEveryProfile) {
  NORMALSHOP_SKIP_FIGURES();
  for (const char* profile : {"bump", "crease", "scratch"}) {
    const TempFolder folder;
    const SeamMismatch grown = growth(
        six_charts(folder),
        on_corner(R"("operator": "pen", "options": {"width": 0.12, "height": 0.03, "profile": ")" +
                  std::string(profile) +
                  R"("}, "strokes": [[[-0.6, -0.4], [0.1, 0.5], [0.6, 0.1], [-0.5, 0.3]]])"),
        folder);
    SCOPED_TRACE(profile);
    expect_small(grown, 50);
  }
}

TEST(EditSeams, AgreeUnderText) {
  NORMALSHOP_SKIP_FIGURES();
  const TempFolder folder;
  expect_small(growth(six_charts(folder),
                      on_corner(R"("operator": "text", "options": {"text": "normals", "size": 0.3,
                                "height": 0.02, "bevel": 0.02}, "strokes": [[[0, 0], [0, 0.4]]])"),
                      folder),
               30);
}

TEST(EditSeams, AgreeUnderStampsAndFilters) {
  const TempFolder folder;
  RawImage patch = flat_normal_map(16, 16, CodeType::U8).codes();
  for (int i = 0; i < 256; ++i) patch.data()[3 * i] = i % 16 < 8 ? 80 : 175;
  write_image(folder / "patch.png", patch);
  const OpenOptions options = six_charts(folder);
  expect_small(
      growth(options,
             on_corner(R"("operator": "stamp", "options": {"patch": "patch.png", "size": 0.4},
                       "strokes": [[[0, 0], [0.4, 0.3], [-0.4, 0.2]]])") +
                 ", " + on_corner(R"("operator": "smooth", "options": {"sigma": 0.02})"),
             folder),
      100);
}

TEST(EditSeams, AgreeOnTheHead) {
  const auto model = data_file("lee_perry_smith/LeePerrySmith.glb");
  if (!model) GTEST_SKIP() << "the real data is not on this machine";
  OpenOptions options;
  options.model = *model;
  options.flip_v = true;
  options.normal_maps = {
      data_file("lee_perry_smith/Infinite-Level_02_Tangent_SmoothUV.jpg")->string()};
  for (const auto& [size, width] : {std::pair(1024, "0.1"), std::pair(4096, "0.2")}) {
    const TempFolder folder;
    options.size = size;
    const SeamMismatch grown =
        growth(options,
               R"({"operator": "pen", "view": "back", "options": {"height": 0.05, "width": )" +
                   std::string(width) +
                   R"(}, "strokes": [[[-2.5, -2.8], [-2.3, -3.6]], [[-1.5, -2.8], [-1.3, -3.6]],
                     [[-0.6, -2.8], [-0.4, -3.6]], [[0.5, -2.8], [0.7, -3.6]],
                     [[1.5, -2.8], [1.7, -3.6]], [[2.5, -2.8], [2.7, -3.6]]]})",
               folder);
    SCOPED_TRACE(std::to_string(size) + " texels, width " + width);
    expect_small(grown, 50);
  }
}

TEST(EditSeams, AgreeOnTheBottle) {
  const auto model = data_file("khr_waterbottle/WaterBottle.gltf");
  if (!model) GTEST_SKIP() << "the real data is not on this machine";
  const TempFolder folder;
  OpenOptions options;
  options.model = *model;
  options.size = 1024;
  std::string edits;
  for (const char* view : {"front", "left", "back", "right"}) {
    edits += std::string(edits.empty() ? "" : ", ") +
             R"({"operator": "pen", "options": {"width": 0.008, "height": 0.002}, "view": ")" +
             view +
             R"(", "strokes": [[[-0.05, -0.12], [0.05, -0.08], [-0.05, -0.03], [0.05, 0.03],
             [-0.05, 0.08], [0.05, 0.12]]]})";
  }
  expect_small(growth(options, edits, folder), 100);
}

}  // namespace
}  // namespace normalshop
