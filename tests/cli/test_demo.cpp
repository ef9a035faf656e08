#include <set>

#include "../io/temp_folder.h"
#include "demo_model.h"
#include "demo_recipe.h"
#include "demo_shape.h"
#include "noise.h"
#include "support/same_codes.h"
#include "support/sanitized.h"
#include <gtest/gtest.h>

#include "normalshop/core/error.h"
#include "normalshop/core/parallel.h"
#include "normalshop/core/slope.h"
#include "normalshop/io/edit_report.h"
#include "normalshop/io/file_assets.h"
#include "normalshop/surface/seam_mismatch.h"
#include "normalshop/surface/texel_density.h"
#include "normalshop/surface/texel_map.h"

namespace normalshop::demo {
namespace {

DemoModelOptions small_model() {
  DemoModelOptions options;
  options.cells = 24;
  options.map_size = 256;
  return options;
}

const DemoModel& model() {
  static const DemoModel made = make_demo_model(small_model());
  return made;
}

/// Largest difference between a jet's gradient and central differences.
template <class Function>
float gradient_error(const Function& f, const Vec3f& p) {
  constexpr float step = 1e-3F;
  Vec3f differences;
  for (Eigen::Index k = 0; k < 3; ++k) {
    const Vec3f d = step * Vec3f::Unit(k);
    differences[k] =
        (f(JetPoint::at(p + d)).value() - f(JetPoint::at(p - d)).value()) / (2.0F * step);
  }
  return (differences - f(JetPoint::at(p)).gradient()).cwiseAbs().maxCoeff();
}

TEST(DemoNoise, GradientsAreThoseOfTheValues) {
  for (int i = 0; i < 200; ++i) {
    const float t = static_cast<float>(i);
    const Vec3f p(0.37F * t - 20.0F, 0.23F * t, 5.0F - 0.31F * t);
    EXPECT_LT(gradient_error([](const JetPoint& q) { return noise(q, 5); }, p), 0.01F);
    EXPECT_LT(gradient_error([](const JetPoint& q) { return fractal_noise(q, 2, 0.5F, 5); }, p),
              0.03F);
    EXPECT_LT(gradient_error([](const JetPoint& q) { return pits(q, 1.0F, 5); }, p), 0.1F);
  }
}

TEST(DemoHead, PointsLieOnTheSurfaceAndNormalsPointOut) {
  const Mesh& mesh = model().mesh;
  for (std::size_t c = 0; c < mesh.corner_count(); c += 7) {
    EXPECT_LT(std::abs(head_distance(mesh.position(c)).value()), 1e-5F);
    EXPECT_NEAR(mesh.normals[c].norm(), 1.0F, 1e-5F);
    EXPECT_GT(mesh.normals[c].dot(mesh.position(c)), 0.0F) << mesh.position(c).transpose();
  }
}

TEST(DemoHead, AtlasHasSixChartsThatDoNotOverlap) {
  const Mesh mesh = make_demo_mesh();
  const Seams seams = find_seams(mesh);
  EXPECT_EQ(seams.chart_count, 6U);
  EXPECT_TRUE(seams.open_edges.empty());
  EXPECT_TRUE(seams.irregular_edges.empty());
  EXPECT_EQ(seams.edges.size(), 12U * 50U);
  const TexelMap texels(mesh, 0, 2048, 2048, 16);
  EXPECT_TRUE(texels.shared().empty());
  EXPECT_GT(texel_use(texels).coverage, 0.75);
}

TEST(DemoHead, ChartsKeepRoomForTheGutter) {
  const Mesh mesh = make_demo_mesh();
  const Seams seams = find_seams(mesh);
  const TexelMap texels(mesh, 0, 2048, 2048, 4);
  // Within 4 texels of a texel of one chart there is none of another.
  for (int y = 4; y < 2044; y += 3) {
    for (int x = 4; x < 2044; ++x) {
      const std::uint32_t here = texels.owner()(x, y);
      if (here == no_triangle) continue;
      for (const auto& [dx, dy] : {std::pair{4, 0}, {0, 4}, {-4, 4}, {4, 4}}) {
        const std::uint32_t other = texels.owner()(x + dx, y + dy);
        if (other == no_triangle) continue;
        ASSERT_EQ(seams.chart[here], seams.chart[other]) << x << " " << y;
      }
    }
  }
}

TEST(DemoHead, BothSidesOfSeamsReadAlike) {
  NORMALSHOP_SKIP_FIGURES();
  DemoModelOptions options;
  options.map_size = 1024;
  const DemoModel made = make_demo_model(options);
  const NormalMap map(made.normals, NormalConvention{});
  const NormalMap* maps[] = {&map};
  const SeamMismatch mismatch = measure_seams(made.mesh, find_seams(made.mesh).edges, maps);
  EXPECT_LT(mismatch.mean, 2.5);
}

TEST(DemoHead, IsTheSameForAnyNumberOfThreads) {
  const ThreadLimit one(1);
  const DemoModel again = make_demo_model(small_model());
  EXPECT_TRUE(test::same_codes(again.normals, model().normals));
  EXPECT_TRUE(test::same_codes(again.color, model().color));
}

TEST(DemoHead, IsReadBackAsItWasWritten) {
  const test::TempFolder folder;
  OpenOptions open;
  open.model = write_demo_model(model(), folder.path());
  const OpenedDocument opened = open_document(open);
  const Mesh& mesh = opened.document.mesh();
  ASSERT_EQ(mesh.triangle_count(), model().mesh.triangle_count());
  for (std::size_t c = 0; c < mesh.corner_count(); ++c) {
    ASSERT_EQ(mesh.position(c), model().mesh.position(c));
    ASSERT_EQ(mesh.uvs[c], model().mesh.uvs[c]);
    ASSERT_LT(angle_degrees(mesh.normals[c], model().mesh.normals[c]), 1e-3);
  }
  EXPECT_EQ(opened.model.texture_sets.size(), 1U);
  EXPECT_EQ(opened.document.storage().sets[0].normals.convention().space, NormalSpace::Tangent);
  EXPECT_FALSE(opened.document.storage().sets[0].normals.convention().green_down);
  EXPECT_FALSE(opened.document.storage().sets[0].albedo.empty());
}

TEST(DemoRecipe, EveryEditChangesTheHead) {
  const test::TempFolder folder;
  OpenOptions open;
  open.model = write_demo_model(model(), folder.path());
  FileAssets assets(folder.path());
  const Recipe recipe = parse_recipe(recipe_text(), "recipe.json", assets);
  std::set<EditMode> modes;
  for (const Edit& edit : recipe.edits) modes.insert(edit.mode);
  EXPECT_EQ(modes.size(), 2U);
  const EditJob job = run_edit_job(open, recipe, folder / "edited", {});
  ASSERT_GE(job.edits.size(), 5U);
  for (const EditReport& edit : job.edits) EXPECT_GT(edit.pushed.changed, 20U);
  for (const char* file : {"head.gltf", "head.bin", "head_normal.png", "report.json"}) {
    EXPECT_TRUE(std::filesystem::exists(folder / "edited" / file)) << file;
  }
}

}  // namespace
}  // namespace normalshop::demo
