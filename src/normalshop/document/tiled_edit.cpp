#include "normalshop/document/tiled_edit.h"

#include <algorithm>

#include "normalshop/chart/tiled_push.h"
#include "normalshop/core/stopwatch.h"
#include "normalshop/document/apply_edit.h"

namespace normalshop {

namespace {

bool shows_surface(const EditingChart& chart, const Rect& pixels) {
  for (int y = pixels.y0; y < pixels.y1; ++y) {
    const float* row = chart.weight.row(y);
    if (std::any_of(row + pixels.x0, row + pixels.x1, [](float w) { return w > 0.0F; })) {
      return true;
    }
  }
  return false;
}

}  // namespace

EditReport apply_in_tiles(const Edit& edit, const CoverView& view, const ChartPlan& plan,
                          const TilePlan& tiles, const Mesh& mesh, std::span<const SeamEdge> seams,
                          StorageAtlas& storage) {
  SurfaceCheck check(edit, edit.strokes.size());
  TiledPush push(storage);
  EditReport report;
  bool faces = false;
  bool averted = false;
  for (const ChartTile& tile : tiles.tiles) {
    const ChartGrid grid{view.view, plan.texel, tile.window};
    const Rect own = shift(tile.own, -tile.window.x0, -tile.window.y0);
    const PreparedEdit prepared = prepare_tile(edit, view, mesh, storage, plan, grid, own, check);
    report.times.pull += prepared.report.times.pull;
    report.times.operate += prepared.report.times.operate;
    averted = averted || !prepared.faces;
    if (!prepared.faces || !shows_surface(prepared.chart, own)) continue;
    faces = true;
    Stopwatch watch;
    if (edit.strength > 0.0F) push.add(mesh, prepared.chart, prepared.change(), own, storage);
    report.times.push += watch.lap();
  }
  if (averted && !faces) fail_averted(edit);
  check.demand(plan.place.model);
  Stopwatch watch;
  report.views = 1;
  report.tiles = static_cast<int>(tiles.tiles.size());
  report.chart_width = tiles.grid.width();
  report.chart_height = tiles.grid.height();
  report.pixel = plan.texel;
  report.texels_per_pixel = 1.0F;
  const std::vector<NormalMap> before = copies_of(storage);
  report.pushed = push.write(storage);
  fit_seams(mesh, seams, tiles.grid, changeable_pixels(tiles.grid, plan.place.extent),
            pointers_to(before), storage);
  report.times.push += watch.lap();
  return report;
}

}  // namespace normalshop
