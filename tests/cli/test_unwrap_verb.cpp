#include "../io/temp_folder.h"
#include "../support/atlas_check.h"
#include "cli/run_program.h"
#include "cli/small_models.h"
#include "support/meshes.h"
#include "support/sanitized.h"
#include <gtest/gtest.h>

#include "normalshop/document/value.h"
#include "normalshop/io/atomic_file.h"
#include "normalshop/io/image_file.h"
#include "normalshop/io/model.h"

/// `unwrap` from end to end: the model that it writes, its report, and what it refuses.
namespace normalshop::test {
namespace {

namespace fs = std::filesystem;

class UnwrapVerb : public ::testing::Test {
 protected:
  UnwrapVerb() {
    write_file(folder_ / "bare.obj", square_obj(false));
    write_gltf(folder_ / "ball.gltf", uv_sphere(24, 12));
    write_file(folder_ / "recipe.json", pen_recipe());
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  ProgramRun unwrap_to(const std::string& model, const std::string& output,
                       const Arguments& more = {}) const {
    Arguments all{"unwrap", path(model), "-o", path(output)};
    all.insert(all.end(), more.begin(), more.end());
    return call_program(all);
  }
  static double number(const Value& report, const char* field) {
    const Value* found = report.find(field);
    return found != nullptr && found->number() != nullptr ? *found->number() : -1.0;
  }
  void expect_refused(const ProgramRun& run, int exit_code, const std::string& word) const {
    EXPECT_EQ(run.exit_code, exit_code) << run.err;
    EXPECT_NE(run.err.find(word), std::string::npos) << run.err;
    EXPECT_EQ(run.err.find('\n'), run.err.size() - 1) << run.err;
    EXPECT_FALSE(fs::exists(folder_ / "out.gltf"));
    EXPECT_FALSE(fs::exists(folder_ / "out.bin"));
  }

  TempFolder folder_;
};

TEST_F(UnwrapVerb, GivesUvsToAModelThatEditThenTakes) {
  const Arguments edit{"edit", path("bare.obj"), "--recipe", path("recipe.json"),
                       "-o",   path("edited")};
  const ProgramRun before = call_program(edit);
  EXPECT_EQ(before.exit_code, 1);
  EXPECT_NE(before.err.find("normalshop unwrap"), std::string::npos) << before.err;

  const ProgramRun run = unwrap_to("bare.obj", "out.gltf");
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.out.find("2 triangles in 1 charts"), std::string::npos) << run.out;
  Arguments after = edit;
  after[1] = path("out.gltf");
  after.insert(after.end(), {"--size", "128"});
  const ProgramRun edited = call_program(after);
  EXPECT_EQ(edited.exit_code, 0) << edited.err;
  EXPECT_EQ(read_image(folder_ / "edited/out_normal.png").width(), 128);
  const ProgramRun drawn = call_program(
      {"render", path("edited/out.gltf"), "-o", path("picture.png"), "--resolution", "40x40"});
  EXPECT_EQ(drawn.exit_code, 0) << drawn.err;
}

TEST_F(UnwrapVerb, ReportsWhatItWrote) {
  const ProgramRun run =
      unwrap_to("ball.gltf", "out.gltf", {"--json", "--size", "512", "--gutter", "2"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Value report = parse_json(run.out, "standard output");
  const Mesh mesh = read_model(folder_ / "out.gltf").mesh;
  EXPECT_EQ(number(report, "triangles"), static_cast<double>(mesh.triangle_count()));
  EXPECT_EQ(number(report, "degenerate"), 48.0);  // those at the poles
  EXPECT_NEAR(number(report, "mean_stretch"), mean_area_stretch(mesh), 1e-4);
  EXPECT_EQ(number(report, "overlaps"), 0.0);
  EXPECT_EQ(number(report, "turned_over"), 0.0);
  EXPECT_GE(number(report, "charts"), 3.0);
  EXPECT_EQ(picture_of_atlas(mesh, 512).overlapping, 0U);
  EXPECT_EQ(mesh.texture_set_names, std::vector<std::string>{"out"});
  ASSERT_NE(report.find("files"), nullptr);
  for (const Value& file : *report.find("files")->array()) EXPECT_TRUE(fs::exists(*file.text()));
}

TEST_F(UnwrapVerb, OptionsArrive) {
  NORMALSHOP_SKIP_FIGURES();
  write_gltf(folder_ / "cube.gltf", cube(2));
  const auto report = [&](const char* model, const Arguments& more, const char* field) {
    Arguments all = more;
    all.emplace_back("--json");
    const ProgramRun run = unwrap_to(model, "out.gltf", all);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return number(parse_json(run.out, "standard output"), field);
  };
  const double usual = report("ball.gltf", {}, "charts");
  EXPECT_GT(report("ball.gltf", {"--stretch", "1.01"}, "charts"), usual);
  EXPECT_GT(report("ball.gltf", {"--angle", "20"}, "charts"), usual);
  EXPECT_EQ(report("cube.gltf", {}, "charts"), 6.0);
  EXPECT_LT(report("cube.gltf", {"--across-hard-edges"}, "charts"), 6.0);
  // A wide gutter in a small map leaves less of it to the triangles.
  EXPECT_LT(report("cube.gltf", {"--size", "128", "--gutter", "12"}, "coverage"),
            report("cube.gltf", {"--size", "1024", "--gutter", "1"}, "coverage") - 0.05);
}

TEST_F(UnwrapVerb, KeepsTheBufferThatTheModelReads) {
  const std::string text = read_file(folder_ / "ball.gltf");
  write_file(folder_ / "other.gltf", std::string_view(text));  // reads ball.bin, too
  const std::string before = read_file(folder_ / "ball.bin");
  const ProgramRun run = call_program({"unwrap", path("other.gltf"), "-o", path("ball.gltf")});
  expect_refused(run, 2, "ball.bin");
  EXPECT_EQ(read_file(folder_ / "ball.bin"), before);
}

TEST_F(UnwrapVerb, RefusesInOneLine) {
  expect_refused(unwrap_to("missing.obj", "out.gltf"), 1, "missing.obj");
  expect_refused(unwrap_to("recipe.json", "out.gltf"), 1, "recipe.json");
  expect_refused(unwrap_to("bare.obj", "out.obj"), 2, ".gltf");
  expect_refused(unwrap_to("bare.obj", "out"), 2, ".gltf");
  expect_refused(unwrap_to("bare.obj", "out.gltf", {"--angle", "95"}), 2, "--angle");
  expect_refused(unwrap_to("bare.obj", "out.gltf", {"--stretch", "nan"}), 2, "--stretch");
  expect_refused(unwrap_to("bare.obj", "out.gltf", {"--gutter", "-3"}), 2, "--gutter");
  expect_refused(unwrap_to("bare.obj", "out.gltf", {"--size", "many"}), 2, "--size");
  expect_refused(unwrap_to("ball.gltf", "ball.gltf"), 2, "model itself");
  expect_refused(call_program({"unwrap", path("bare.obj")}), 2, "--output");
  expect_refused(unwrap_to("bare.obj", "no/folder/out.gltf"), 1, "out.");
  write_file(folder_ / "flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
  expect_refused(unwrap_to("flat.obj", "out.gltf"), 1, "area");
  write_file(folder_ / "points.obj", "v 0 0 0\n");
  expect_refused(unwrap_to("points.obj", "out.gltf"), 1, "no faces");
}

}  // namespace
}  // namespace normalshop::test
