#include "normalshop/document/apply_edit.h"

#include <algorithm>

#include "normalshop/chart/cover.h"
#include "normalshop/chart/push_colors.h"
#include "normalshop/chart/surface_blend.h"
#include "normalshop/core/error.h"
#include "normalshop/core/stopwatch.h"
#include "normalshop/document/prepare_edit.h"
#include "normalshop/surface/seam_fit.h"

namespace normalshop {

namespace {

/// The seams that may lie among the texels that an edit in the region changes.
std::vector<SeamEdge> seams_near(const Mesh& mesh, std::span<const SeamEdge> seams,
                                 const ChartGrid& grid, const Rect& region) {
  constexpr int margin = 32;  // texels beside a seam may be much larger than pixels
  const Rect reach = grow(region, margin);
  const auto low = Vec2f(static_cast<float>(reach.x0), static_cast<float>(reach.y0));
  const auto high = Vec2f(static_cast<float>(reach.x1), static_cast<float>(reach.y1));
  std::vector<SeamEdge> near;
  for (const SeamEdge& edge : seams) {
    const Vec2f a = grid.project(mesh.position(edge.a0)).head<2>();
    const Vec2f b = grid.project(mesh.position(edge.a1)).head<2>();
    const bool meets = (a.cwiseMin(b).array() <= high.array()).all() &&
                       (a.cwiseMax(b).array() >= low.array()).all();
    if (meets) near.push_back(edge);
  }
  return near;
}

/// push() as the edit's `change`, and both sides of the seams kept together.
template <class Push>
PushResult push_and_fit(const Mesh& mesh, std::span<const SeamEdge> seams, StorageAtlas& storage,
                        const Push& push_all) {
  std::vector<NormalMap*> maps;
  for (StorageSet& set : storage.sets) maps.push_back(&set.normals);
  const std::vector<const NormalMap*> before(maps.begin(), maps.end());
  const SeamFit fit(mesh, seams, before);
  const PushResult pushed = push_all();
  fit.apply(maps);
  return pushed;
}

void push_prepared(const Edit& edit, const Mesh& mesh, std::span<const SeamEdge> seams,
                   PreparedEdit& prepared, StorageAtlas& storage) {
  Stopwatch watch;
  if (edit.strength > 0.0F) {
    const EditingChart& chart = prepared.chart;
    const std::vector<SeamEdge> near = seams_near(mesh, seams, chart.grid, prepared.result.region);
    prepared.report.pushed = push_and_fit(mesh, near, storage, [&] {
      return push(mesh, chart, prepared.change(edit.mode), storage);
    });
    const ColorResult& colors = prepared.colors;
    if (!colors.change.empty()) {
      prepared.report.colors_changed =
          push_colors(mesh, chart, {colors.change, colors.region}, storage).changed;
    }
  }
  prepared.report.times.push = watch.lap();
}

/// Of several views of an edit; the chart that is told is the largest.
void add(const EditReport& other, EditReport& report) {
  const auto pixels = [](const EditReport& r) {
    return double{1} * r.chart_width * r.chart_height;
  };
  if (pixels(other) > pixels(report)) {
    report.chart_width = other.chart_width;
    report.chart_height = other.chart_height;
    report.pixel = other.pixel;
  }
  report.views += other.views;
  report.coarser_than_texels = report.coarser_than_texels || other.coarser_than_texels;
  report.pushed.visited += other.pushed.visited;
  report.pushed.changed += other.pushed.changed;
  report.pushed.largest_change =
      std::max(report.pushed.largest_change, other.pushed.largest_change);
  report.colors_changed += other.colors_changed;
  report.times.pull += other.times.pull;
  report.times.operate += other.times.operate;
  report.times.push += other.times.push;
}

/// All views see what was there before any of them; their mean is stored at once.
EditReport apply_to_surface(const Edit& edit, const SurfaceView& surface, const Mesh& mesh,
                            std::span<const SeamEdge> seams, StorageAtlas& storage) {
  Stopwatch watch;
  CoverOptions cover;
  cover.views = surface.views;
  cover.effective = effective_options(edit.effective, bounds(mesh).diagonal());
  const std::vector<CoverView> views = cover_surface(mesh, cover);
  EditReport report;
  report.times.pull = watch.lap();
  SurfaceBlend blend(storage);
  for (const CoverView& view : views) {
    const Extent part{view.low, view.high};
    PreparedEdit prepared = prepare_edit(edit, view.view, mesh, storage, part);
    watch.lap();
    if (edit.strength > 0.0F) blend.add(mesh, prepared.chart, prepared.change(edit.mode), storage);
    prepared.report.times.push = watch.lap();
    add(prepared.report, report);
  }
  report.pushed = push_and_fit(mesh, seams, storage, [&] { return blend.write(storage); });
  report.times.push += watch.lap();
  return report;
}

}  // namespace

EditReport apply_edit(const Edit& edit, const Mesh& mesh, std::span<const SeamEdge> seams,
                      StorageAtlas& storage) {
  if (const auto* surface = std::get_if<SurfaceView>(&edit.view)) {
    return apply_to_surface(edit, *surface, mesh, seams, storage);
  }
  const View view = resolve(edit.view, mesh);
  PreparedEdit side = prepare_edit(edit, view, mesh, storage);
  std::optional<PreparedEdit> other;  // before any push: both see what was there, and throw in time
  if (edit.mirror) {
    const View image = mirrored(view, static_cast<int>(edit.mirror->axis), edit.mirror->at);
    try {
      other = prepare_edit(edit, image, mesh, storage);
    } catch (const InvalidInput& error) {
      throw InvalidInput(edit.path + ".mirror: on the other side, " + error.what());
    }
  }
  push_prepared(edit, mesh, seams, side, storage);
  if (!other) return side.report;
  push_prepared(edit, mesh, seams, *other, storage);
  add(other->report, side.report);
  return side.report;
}

}  // namespace normalshop
