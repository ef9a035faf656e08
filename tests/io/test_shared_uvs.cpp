#include "io/temp_folder.h"
#include "support/data.h"
#include "support/meshes.h"
#include "support/whole_texels.h"
#include <gtest/gtest.h>

#include "normalshop/io/edit_report.h"
#include "normalshop/io/file_assets.h"
#include "normalshop/io/gltf_export.h"
#include "normalshop/io/image_file.h"
#include "normalshop/io/open_document.h"

/// Real models with overlapping and mirrored charts.
namespace normalshop::test {
namespace {

struct Seen {
  WholeTexels all;
  std::size_t shared = 0;  ///< as push counts them
};

/// Adds a slope to all that a view shows, in every texture set, each as it was opened.
Seen edit_all_in_view(const OpenedDocument& opened, const Vec3f& direction) {
  const Mesh& mesh = opened.document.mesh();
  StorageAtlas storage = opened.document.storage();
  const View view = framing_view(mesh, direction);
  const float pixel = std::max(view.width, view.height) / 700.0F;
  EditingChart chart = pull(mesh, storage, make_grid(view, pixel));
  Seen seen;
  for (std::size_t i = 0; i < storage.sets.size(); ++i) {
    PushResult result;
    const WholeTexels found = push_and_check(mesh, storage.sets[i], static_cast<std::uint32_t>(i),
                                             chart, Vec2f(0.2F, 0.1F), result);
    seen.all.written += found.written;
    seen.all.shared += found.shared;
    seen.all.strange += found.strange;
    seen.all.unshown += found.unshown;
    seen.all.repeated += found.repeated;
    seen.all.touched += found.touched;
    seen.shared += result.shared;
  }
  return seen;
}

void expect_whole_texels(const char* file, std::size_t least_shared) {
  const auto model = data_file(file);
  if (!model) GTEST_SKIP() << "the real data is not on this machine";
  OpenOptions options;
  options.model = *model;
  options.size = 512;
  const OpenedDocument opened = open_document(options);
  for (const Vec3f& direction : {Vec3f(0.4F, 0.5F, 1.0F), Vec3f(-1.0F, 0.3F, -0.6F)}) {
    const Seen seen = edit_all_in_view(opened, direction);
    EXPECT_GT(seen.all.shared, least_shared);
    EXPECT_EQ(seen.shared, seen.all.shared);
    EXPECT_EQ(seen.all.repeated, 0U);
    EXPECT_EQ(seen.all.touched, 0U);
    EXPECT_EQ(seen.all.unshown, 0U);
    EXPECT_EQ(seen.all.strange, 0U);
  }
}

TEST(SharedUvs, OfTheSofaTakeWholeEdits) {
  expect_whole_texels("polyhaven_sofa_03/sofa_03_1k.gltf", 10000);
}

TEST(SharedUvs, OfTheBoomboxTakeWholeEdits) {
  expect_whole_texels("khr_boombox_axes/BoomBoxWithAxes.gltf", 50000);
}

/// The mirrored half of a square, edited alone.
TEST(SharedUvs, AreToldInTheReport) {
  const TempFolder folder;
  write_image(folder / "flat.png", flat_normal_map(128, 128, CodeType::U16).codes());
  OpenOptions options;
  options.model = folder / "pair.gltf";
  GltfMaterial material;
  material.name = "map";
  material.normal_map = "flat.png";
  export_gltf(options.model, mirrored_pair(4), {material});
  FileAssets assets(folder.path());
  const Recipe recipe = parse_recipe(R"({"version": 1, "edits": [
    {"operator": "pen", "view": {"direction": [0, 0, 1], "center": [-0.5, 0.5, 0], "width": 1},
     "options": {"profile": "bump", "width": 0.2, "height": 0.02},
     "strokes": [[[0.1, -0.3], [0.1, 0.3]]]}]})",
                                     "r.json", assets);
  const EditJob job = run_edit_job(options, recipe, folder / "out", {});
  const PushResult& pushed = job.edits[0].pushed;
  EXPECT_GT(pushed.shared, 1000U);
  EXPECT_EQ(pushed.shared, pushed.changed) << "away from the borders and their gutter";
  const Value report = report_value(job);
  const Value& edit = report.find("edits")->array()->at(0);
  EXPECT_EQ(*edit.find("texels_shared")->number(), static_cast<double>(pushed.shared));
  const std::string told = "r.json: edits[0]: all of its " + std::to_string(pushed.changed);
  const auto is_told = [&](const std::string& note) { return note.starts_with(told); };
  EXPECT_TRUE(std::any_of(job.notes.begin(), job.notes.end(), is_told));
}

}  // namespace
}  // namespace normalshop::test
