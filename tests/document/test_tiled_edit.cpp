#include "document/edit_fixture.h"
#include "document/operator_cases.h"
#include "support/sanitized.h"

#include "normalshop/core/error.h"
#include "normalshop/document/tile_plan.h"

/// Edits whose chart is cut into tiles, beside the same ones with the chart in one piece.
namespace normalshop::test {
namespace {

/// Charts with more pixels a side are cut.
constexpr TransferOptions cut{.largest_side = 256};

struct Difference {
  int texels = 0;        // that are not the same bits
  int reached = 0;       // that one edit reached and the other did not
  float largest = 0.0F;  // degrees
};

Difference difference(const Document& a, const Document& b) {
  Difference d;
  const NormalMap& p = map_of(a);
  const NormalMap& q = map_of(b);
  for (int y = 0; y < p.height(); ++y) {
    for (int x = 0; x < p.width(); ++x) {
      if (p.edited(x, y) != q.edited(x, y)) ++d.reached;
      if (p.vector(x, y) == q.vector(x, y)) continue;
      ++d.texels;
      d.largest = std::max(d.largest, degrees_between(p.normal(x, y), q.normal(x, y)));
    }
  }
  return d;
}

struct Pair {
  Document whole;
  Document tiled;
  EditReport of_whole;
  EditReport of_tiled;
};

Pair apply_both(const Document& document, const Edit& edit) {
  Pair pair{document, document, {}, {}};
  pair.of_whole = pair.whole.apply(edit);
  pair.of_tiled = pair.tiled.apply(edit, cut);
  EXPECT_EQ(pair.of_whole.tiles, 1);
  EXPECT_GT(pair.of_tiled.tiles, 3);
  EXPECT_EQ(pair.of_whole.chart_width, pair.of_tiled.chart_width);
  EXPECT_EQ(pair.of_whole.chart_height, pair.of_tiled.chart_height);
  EXPECT_GT(pair.of_whole.pushed.changed, 0U);
  return pair;
}

// Where pixels and texels lie at numbers without rounding, nothing else is different.
TEST(TiledEdit, OfAPenIsBitForBitThatOfOneChart) {
  const Document plane = document(plane_grid(2), noise_map(256, CodeType::U16));
  const Pair pair = apply_both(plane, edit(R"("operator": "pen", "view": "front",
      "options": {"width": 0.0625, "height": 0.015625, "smooth": false},
      "strokes": [[[-0.46875, -0.4375], [0.46875, 0.375], [-0.125, 0.46875]],
                  [[0.25, -0.46875], [0.25, 0.46875]]])"));
  const Difference d = difference(pair.whole, pair.tiled);
  EXPECT_EQ(d.texels, 0);
  EXPECT_EQ(d.reached, 0);
  EXPECT_EQ(pair.of_whole.pushed.changed, pair.of_tiled.pushed.changed);
  EXPECT_EQ(pair.of_whole.pushed.largest_change, pair.of_tiled.pushed.largest_change);
}

// Where coordinates round: a twentieth of what codes of 8 bits tells apart.
TEST(TiledEdit, OfEveryLocalOperatorIsThatOfOneChart) {
  NORMALSHOP_SKIP_FIGURES();
  const Document plane = document(plane_grid(2), noise_map(256, CodeType::U16));
  int compared = 0;
  for (const double size : {1.6, 2.2}) {
    for (const OperatorCase& c : operator_cases(size)) {
      const Edit one = edit_of(c);
      const bool inside = c.options.find("inside") != std::string::npos;
      if (!one.operation->is_local() || inside != (size > 2.0)) continue;
      SCOPED_TRACE(c.name);
      const Pair pair = apply_both(plane, one);
      const Difference d = difference(pair.whole, pair.tiled);
      EXPECT_EQ(d.reached, 0);
      EXPECT_LT(d.largest, 0.02F);
      ++compared;
    }
  }
  EXPECT_EQ(compared, 15);
}

// Here positions round differently in every tile.
TEST(TiledEdit, OnASphereReachesTheSameTexels) {
  NORMALSHOP_SKIP_FIGURES();
  const Document sphere = document(uv_sphere(48, 24), noise_map(160, CodeType::U16));
  for (const std::string& fields :
       {std::string(R"("operator": "smooth", "options": {"sigma": 0.02})"),
        std::string(R"("operator": "smooth", "options": {"sigma": 0.02},
                        "mode": {"along": [0.4, 0.2, 0.9]})"),
        std::string(R"("operator": "pen", "options": {"width": 0.2, "height": 0.03},
                        "strokes": [[[-0.9, -0.2], [0, 0.9], [0.9, -0.3], [0.1, -0.9]]])")}) {
    SCOPED_TRACE(fields);
    const Pair pair = apply_both(sphere, edit(fields + R"(, "view": {"direction": [0.5, 0.3, 0.8],
        "center": [0, 0, 0], "width": 2.1})"));
    const Difference d = difference(pair.whole, pair.tiled);
    EXPECT_EQ(d.reached, 0);
    EXPECT_LT(d.largest, 0.05F);
  }
}

// One half is in other tiles than its mirror image, which has the same texels.
TEST(TiledEdit, OfSharedTexelsIsThatOfOneChart) {
  const Document halves = document(mirrored_pair(2), noise_map(256, CodeType::U16));
  const Pair pair = apply_both(halves, edit(R"("operator": "pen", "view": "front",
      "options": {"width": 0.125, "height": 0.03125, "smooth": false},
      "strokes": [[[-0.875, -0.25], [0.25, 0.375], [0.75, -0.375]]])"));
  const Difference d = difference(pair.whole, pair.tiled);
  EXPECT_EQ(d.texels, 0);
  EXPECT_EQ(d.reached, 0);
  EXPECT_EQ(pair.of_whole.pushed.changed, pair.of_tiled.pushed.changed);
  EXPECT_EQ(pair.of_whole.pushed.shared, pair.of_tiled.pushed.shared);
  EXPECT_GT(pair.of_tiled.pushed.shared, 0U);
}

ChartPlan plan_of(const Edit& edit, const Document& d) {
  return plan_chart(edit, whole_view(resolve(edit.view, d.mesh())), d.mesh(), d.storage());
}

TilePlan tiles_of(const Edit& edit, const Document& d, const TransferOptions& transfer = cut) {
  return plan_tiles(edit, resolve(edit.view, d.mesh()), plan_of(edit, d), transfer);
}

TEST(TilePlan, CoversWhatAnEditMayChange) {
  const Document plane = flat_plane(2048);
  const Edit smooth = edit(R"("operator": "smooth", "view": "front", "options": {"sigma": 0.004})");
  const TilePlan plan = tiles_of(smooth, plane);
  ASSERT_GT(plan.tiles.size(), 36U);
  const Rect& window = plan.grid.window;
  Image<std::uint8_t> covered(window.width(), window.height(), 0);
  for (const ChartTile& tile : plan.tiles) {
    EXPECT_LE(std::max(tile.window.width(), tile.window.height()), 512);
    EXPECT_EQ((tile.window.x0 - window.x0) % 64, 0);
    EXPECT_EQ((tile.window.y0 - window.y0) % 64, 0);
    EXPECT_EQ(intersect(tile.window, window), tile.window);
    EXPECT_EQ(intersect(grow(tile.own, 64), tile.window), intersect(grow(tile.own, 64), window));
    for (int y = tile.own.y0; y < tile.own.y1; ++y) {
      for (int x = tile.own.x0; x < tile.own.x1; ++x) ++covered(x - window.x0, y - window.y0);
    }
  }
  for (int y = 0; y < window.height(); ++y) {
    for (int x = 0; x < window.width(); ++x) ASSERT_EQ(covered(x, y), 1) << x << ", " << y;
  }
}

TEST(TilePlan, LeavesOutWhatStrokesDoNotReach) {
  const Document plane = flat_plane(2048);
  const Edit line = edit(R"("operator": "pen", "view": "front",
      "options": {"width": 0.01, "height": 0.01}, "strokes": [[[-0.45, 0.1], [0.45, 0.1]]])");
  const TilePlan plan = tiles_of(line, plane);
  EXPECT_GE(plan.tiles.size(), 8U);
  EXPECT_LE(plan.grid.window.height(), 64);
  EXPECT_LE(plan.tiles.size(), 16U);
}

TEST(TilePlan, KeepsInOnePieceWhatFitsOrNeedsIt) {
  const Document plane = flat_plane(1024);
  const std::string view = R"(, "view": "front")";
  const std::string pen = R"("operator": "pen", "options": {"width": 0.1, "height": 0.01},
      "strokes": [[[-0.45, -0.4], [0.45, 0.4]]])";
  EXPECT_FALSE(tiles_of(edit(pen + view), plane).tiles.empty());
  EXPECT_TRUE(tiles_of(edit(pen + view), plane, {}).tiles.empty());
  for (const std::string& more :
       {std::string(R"(, "mode": "base")"), std::string(R"(, "window": "view")"),
        std::string(R"(, "mirror": {"axis": "x", "at": 0.5})")}) {
    EXPECT_TRUE(tiles_of(edit(pen + view + more), plane).tiles.empty()) << more;
  }
  EXPECT_TRUE(tiles_of(edit(pen + view), plane, {.update = Update::Area, .largest_side = 256})
                  .tiles.empty());
  for (const std::string& other :
       {std::string(R"("operator": "balance")"), std::string(R"("operator": "project")"),
        std::string(R"("operator": "smooth", "options": {"sigma": 0.1})"),
        std::string(R"("operator": "flatten", "options": {"area": "alike"},
                        "strokes": [[[0, 0], [0.2, 0.2]]])")}) {
    EXPECT_TRUE(tiles_of(edit(other + view), plane).tiles.empty()) << other;
  }
}

std::string failure(Document document, const std::string& fields) {
  try {
    document.apply(edit(fields), cut);
  } catch (const InvalidInput& error) {
    EXPECT_FALSE(map_of(document).has_edits());
    return error.what();
  }
  return "applied";
}

TEST(TiledEdit, RefusesWhatOneChartRefuses) {
  const Document plane = flat_plane(1024);
  const std::string pen = R"("operator": "pen", "options": {"width": 0.01, "height": 0.01},
      "view": "front", )";
  const std::string off = failure(plane, pen + R"("strokes": [[[-0.4, -0.4], [0.4, 0.4]],
      [[0.52, -0.4], [0.6, 0.4]]])");
  EXPECT_EQ(off.substr(0, 33), "r.json: edits[0].strokes[1] lies ") << off;
  const std::string averted = failure(
      plane, pen + R"("mode": {"along": [1, 0, -0.5]}, "strokes": [[[-0.4, -0.4], [0.4, 0.4]]])");
  EXPECT_EQ(averted.substr(0, 39), "r.json: edits[0].mode.along must point ") << averted;
}

}  // namespace
}  // namespace normalshop::test
