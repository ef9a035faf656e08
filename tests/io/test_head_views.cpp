#include "document/fake_assets.h"
#include "support/chart_bijection.h"
#include "support/data.h"
#include "support/many_strokes.h"
#include "support/step_agreement.h"
#include <gtest/gtest.h>

#include "normalshop/chart/cover.h"
#include "normalshop/chart/resolution.h"
#include "normalshop/io/open_document.h"

/// The texels of a real head, seen from all sides.
namespace normalshop::test {
namespace {

std::optional<OpenedDocument> open_head(int size) {
  OpenOptions options;
  const auto model = data_file("lee_perry_smith/LeePerrySmith.glb");
  if (!model) return std::nullopt;
  options.model = *model;
  options.flip_v = true;
  options.size = size;
  options.normal_maps = {
      data_file("lee_perry_smith/Infinite-Level_02_Tangent_SmoothUV.jpg")->string()};
  return open_document(options);
}

TEST(HeadViews, UpdateEveryTexelOfTheirEffectiveChartsAndNoOther) {
  const std::optional<OpenedDocument> head = open_head(4096);
  if (!head) GTEST_SKIP() << "the real data is not on this machine";
  const Mesh& mesh = head->document.mesh();
  const StorageAtlas& storage = head->document.storage();
  CoverOptions options;
  options.views = 20;
  options.effective = effective_on(bounds(mesh).diagonal());
  Bijection all;
  int views = 0;
  for (const CoverView& cover : cover_surface(mesh, options)) {
    if (cover.shown) continue;  // what is hidden
    EditingChart chart;
    const float size = std::max(cover.view.width, cover.view.height);
    chart.grid = make_grid(cover.view, size / 600.0F, cover.low, cover.high);
    cover.rasterize(mesh, chart.grid, chart.ids);
    pull_attributes(mesh, storage, chart, {.normals = false, .albedo = false});
    compute_weight(chart, options.effective);
    all.add(edit_all(mesh, storage, chart));
    ++views;
  }
  EXPECT_EQ(views, 20);
  EXPECT_GT(all.effective, 50'000'000U);
  EXPECT_GT(all.pixels, 2'000'000U);
  EXPECT_EQ(all.missed, 0U);
  EXPECT_EQ(all.unlinked, 0U);
  EXPECT_EQ(all.outside, 0U);
  // Surface seen almost edge-on may lie closely behind what is drawn, with pixels of four texels
  // more of it.
  EXPECT_LT(all.behind, all.effective / 500);
}

TEST(HeadViews, KeepTheDetailsUnderFiftyStrokes) {
  std::optional<OpenedDocument> head = open_head(1024);
  if (!head) GTEST_SKIP() << "the real data is not on this machine";
  Document& document = head->document;
  const NormalMap before = document.storage().sets[0].normals;
  const std::string view = R"({"facing": [1.6, -0.6, 1.6], "width": 2.4})";
  FakeAssets assets;
  const auto apply = [&](const ShortStroke& stroke, float sign) {
    const std::string json = R"({"version": 1, "edits": [{)" + stroke.edit(view, sign) + "}]}";
    document.apply(parse_recipe(json, "r.json", assets).edits.at(0));
  };
  const std::vector<ShortStroke> strokes = fifty_strokes(1.0F);
  for (const ShortStroke& stroke : strokes) apply(stroke, 1.0F);
  const NormalMap added = document.storage().sets[0].normals;
  for (const ShortStroke& stroke : strokes) apply(stroke, -1.0F);
  const NormalMap& after = document.storage().sets[0].normals;
  std::size_t changed = 0;
  std::size_t beside = 0;
  double turned = 0.0;
  double left = 0.0;
  for (int y = 0; y < before.height(); ++y) {
    for (int x = 0; x < before.width(); ++x) {
      if (!after.edited(x, y)) {
        beside += after.vector(x, y) == before.vector(x, y) ? 1 : 0;
        continue;
      }
      ++changed;
      turned += angle_degrees(added.normal(x, y), before.normal(x, y));
      left += angle_degrees(after.normal(x, y), before.normal(x, y));
    }
  }
  EXPECT_GT(changed, 10000U);
  EXPECT_EQ(beside + changed, 1024U * 1024U);
  EXPECT_GT(turned / static_cast<double>(changed), 3.0);
  EXPECT_LE(left / static_cast<double>(changed), 0.05);
}

// Rims, depth steps and seams of the face, and tiles of 256 to 384 pixels.
TEST(HeadViews, CutIntoTilesAreThoseOfOneChart) {
  const std::optional<OpenedDocument> head = open_head(512);
  if (!head) GTEST_SKIP() << "the real data is not on this machine";
  FakeAssets assets;
  for (const std::string& fields :
       {std::string(R"("operator": "sharpen", "options": {"sigma": 0.05})"),
        std::string(R"("operator": "pen", "options": {"width": 0.3, "height": 0.1},
                        "strokes": [[[-2, -3], [-1, 2], [1, 3], [0, -3], [3, -2]]])")}) {
    SCOPED_TRACE(fields);
    const Edit edit =
        parse_recipe(R"({"version": 1, "edits": [{"view": "front", )" + fields + "}]}", "r.json",
                     assets)
            .edits.at(0);
    Document whole = head->document;
    Document tiled = head->document;
    EXPECT_EQ(whole.apply(edit).tiles, 1);
    EXPECT_GT(tiled.apply(edit, {.largest_side = 512}).tiles, 8);
    const NormalMap& a = whole.storage().sets[0].normals;
    const NormalMap& b = tiled.storage().sets[0].normals;
    int reached = 0;
    double largest = 0.0;
    for (int y = 0; y < a.height(); ++y) {
      for (int x = 0; x < a.width(); ++x) {
        if (a.edited(x, y) != b.edited(x, y)) ++reached;
        largest = std::max(largest, angle_degrees(a.normal(x, y), b.normal(x, y)));
      }
    }
    EXPECT_GT(a.edited_count(), 10000U);
    EXPECT_EQ(reached, 0);
    EXPECT_LT(largest, 0.02);
  }
}

TEST(HeadViews, FadeOutAtTheSameStepsAtTwoResolutions) {
  const std::optional<OpenedDocument> head = open_head(512);
  if (!head) GTEST_SKIP() << "the real data is not on this machine";
  const Mesh& mesh = head->document.mesh();
  const EffectiveOptions options = effective_on(bounds(mesh).diagonal());
  const View view = resolve(NamedView::Front, mesh);
  const ChartGrid grid = make_grid(view, 0.008F);
  const StepAgreement steps = step_agreement(mesh, grid, options.least_step);
  const WeightAgreement weights = weight_agreement(mesh, grid, options);
  EXPECT_GT(steps.coarse, 5000);
  EXPECT_LT(steps.coarse_only, steps.coarse / 20);
  EXPECT_LT(steps.fine_only, steps.fine / 8);
  EXPECT_LT(weights.far, weights.pixels / 250);
  EXPECT_LT(weights.mean, 0.005);
}

}  // namespace
}  // namespace normalshop::test
