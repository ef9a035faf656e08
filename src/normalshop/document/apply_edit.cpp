#include "normalshop/document/apply_edit.h"

#include <algorithm>

#include "normalshop/chart/cover.h"
#include "normalshop/chart/push_colors.h"
#include "normalshop/chart/surface_blend.h"
#include "normalshop/chart/update_storage.h"
#include "normalshop/core/error.h"
#include "normalshop/core/stopwatch.h"
#include "normalshop/document/prepare_edit.h"
#include "normalshop/document/stroke_views.h"
#include "normalshop/document/surface_part.h"
#include "normalshop/document/tiled_edit.h"
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

void fit(const Mesh& mesh, std::span<const SeamEdge> seams, float kept, NormalMaps before,
         StorageAtlas& storage) {
  std::vector<NormalMap*> maps;
  for (StorageSet& set : storage.sets) maps.push_back(&set.normals);
  SeamFit(mesh, seams, before, kept).apply(maps);
}

/// The normals, by whatever way the transfer says.
void push_normals(const Mesh& mesh, std::span<const SeamEdge> seams, PreparedEdit& prepared,
                  StorageAtlas& storage) {
  const EditingChart& chart = prepared.chart;
  EditReport& report = prepared.report;
  const ChartEdit change = prepared.change();
  if (report.transfer.update == Update::Gather) {
    const std::vector<NormalMap> before = copies_of(storage);
    report.pushed = push(mesh, chart, change, storage);
    fit_seams(mesh, seams, chart.grid, change.region, pointers_to(before), storage);
    return;
  }
  report.pushed = update_storage(mesh, chart, change, report.transfer.update, storage);
  report.lost = lost_texels(mesh, chart, change.region, storage);
}

void push_prepared(const Edit& edit, const Mesh& mesh, std::span<const SeamEdge> seams,
                   PreparedEdit& prepared, StorageAtlas& storage) {
  Stopwatch watch;
  if (edit.strength > 0.0F) {
    push_normals(mesh, seams, prepared, storage);
    const ColorResult& colors = prepared.colors;
    if (!colors.change.empty()) {
      prepared.report.colors_changed =
          push_colors(mesh, prepared.chart, {colors.change, colors.region}, storage).changed;
    }
  }
  prepared.report.times.push = watch.lap();
}

/// Of several views of an edit; the chart that is told is the largest.
void add(const EditReport& other, EditReport& report) {
  const auto pixels = [](const EditReport& r) {
    return std::int64_t{r.chart_width} * r.chart_height;
  };
  if (pixels(other) > pixels(report)) {
    report.chart_width = other.chart_width;
    report.chart_height = other.chart_height;
    report.pixel = other.pixel;
    report.tiles = other.tiles;
  }
  report.views += other.views;
  report.lost += other.lost;
  report.texels_per_pixel = std::max(report.texels_per_pixel, other.texels_per_pixel);
  report.pushed.visited += other.pushed.visited;
  report.pushed.changed += other.pushed.changed;
  report.pushed.shared += other.pushed.shared;
  report.pushed.largest_change =
      std::max(report.pushed.largest_change, other.pushed.largest_change);
  report.colors_changed += other.colors_changed;
  report.relief.add(other.relief);
  report.times.pull += other.times.pull;
  report.times.operate += other.times.operate;
  report.times.push += other.times.push;
}

PreparedEdit facing(const Edit& edit, PreparedEdit prepared) {
  if (!prepared.faces) fail_averted(edit);
  return prepared;
}

/// All views see what was there before any of them; their mean is stored at once.
class SurfaceEdit {
 public:
  SurfaceEdit(const Edit& edit, const Mesh& mesh, StorageAtlas& storage)
      : mesh_(mesh), storage_(storage), part_(edit, mesh), blend_(storage, part_.triangles()) {}

  void add(const Edit& edit, const CoverView& whole) {
    const CoverView view = part_.narrowed(whole, mesh_);
    if (!(view.low.x() < view.high.x() && view.low.y() < view.high.y())) return;
    shown_ = true;
    PreparedEdit prepared = prepare_edit(edit, view, mesh_, storage_);
    if (!prepared.faces) return;
    faces_ = true;
    Stopwatch watch;
    limit(prepared);
    if (edit.strength > 0.0F) blend_.add(mesh_, prepared.chart, prepared.change(), storage_);
    prepared.report.times.push = watch.lap();
    normalshop::add(prepared.report, report);
  }
  /// What reaches all of the surface leaves no seam, either.
  void store(const Edit& edit, std::span<const SeamEdge> seams, float kept) {
    if (!shown_) {
      throw InvalidInput(edit.path + ".part must hold surface with a front side that " +
                         (edit.surface_strokes.empty() ? "faces a view" : "the strokes come near"));
    }
    if (!faces_) fail_averted(edit);
    if (part_.weighs() && !weighs_) {
      throw InvalidInput(edit.path + ".part.mask must be above 0 on some of the edited surface");
    }
    Stopwatch watch;
    const std::vector<NormalMap> before = copies_of(storage_);
    report.pushed = blend_.write(storage_);
    fit(mesh_, part_.seams_within(seams), kept, pointers_to(before), storage_);
    report.times.push += watch.lap();
  }

  EditReport report;

 private:
  /// To what the part's mask says.
  void limit(PreparedEdit& prepared) {
    if (!part_.weighs()) return;
    const MaskImage weights = part_.weights(mesh_, prepared.chart);
    multiply(weights, prepared.result);
    const Rect& region = prepared.result.region;
    for (int y = region.y0; y < region.y1 && !weighs_; ++y) {
      const float* row = weights.row(y);
      weighs_ = std::any_of(row + region.x0, row + region.x1, [](float w) { return w > 0.0F; });
    }
  }

  const Mesh& mesh_;
  StorageAtlas& storage_;
  PartMask part_;
  SurfaceBlend blend_;
  bool shown_ = false;   // does any view show the part?
  bool faces_ = false;   // does the edit's direction see any of the surface?
  bool weighs_ = false;  // does its mask let any of the edit through?
};

void check_transfer(const Edit& edit, const TransferOptions& transfer) {
  if (transfer.transfer != Transfer::Triangle || transfer.update != Update::Gather) {
    throw InvalidInput(edit.path +
                       ".view must be one view, not \"surface\", with --transfer point or with "
                       "--update point or area");
  }
}

EditReport apply_along_strokes(const Edit& given, const Mesh& mesh, std::span<const SeamEdge> seams,
                               StorageAtlas& storage) {
  Stopwatch watch;
  const Edit edit = with_feather_in_units(given, mesh, storage);
  const std::vector<StrokeView> views = view_strokes(edit, mesh);
  if (views.empty()) {
    throw InvalidInput(edit.path +
                       ".strokes must follow surface with a front side: the model's normals must "
                       "point outwards there");
  }
  SurfaceEdit all(edit, mesh, storage);
  all.report.times.pull = watch.lap();
  Edit part = edit;
  for (const StrokeView& view : views) {
    part.strokes = view.strokes;
    all.add(part, view.cover(mesh));
  }
  all.store(edit, seams, 1.0F);
  return all.report;
}

EditReport apply_to_surface(const Edit& given, const SurfaceView& surface, const Mesh& mesh,
                            std::span<const SeamEdge> seams, SurfaceCover& cover,
                            StorageAtlas& storage) {
  Stopwatch watch;
  const Edit edit = with_feather_in_units(given, mesh, storage);
  const CoverOptions options{surface.views,
                             effective_options(edit.effective, bounds(mesh).diagonal())};
  if (cover.views.empty() || !(options == cover.options)) {
    cover = {options, cover_surface(mesh, options)};
  }
  if (cover.views.empty()) {
    throw InvalidInput(edit.path +
                       ".view: no view shows a front side of the surface; the model's " +
                       "normals must point outwards");
  }
  SurfaceEdit all(edit, mesh, storage);
  all.report.times.pull = watch.lap();
  for (const CoverView& view : cover.views) all.add(edit, view);
  all.store(edit, seams, 1.0F - edit.strength);
  return all.report;
}

}  // namespace

std::vector<NormalMap> copies_of(const StorageAtlas& storage) {
  std::vector<NormalMap> maps;
  maps.reserve(storage.sets.size());
  for (const StorageSet& set : storage.sets) maps.push_back(set.normals);
  return maps;
}

std::vector<const NormalMap*> pointers_to(const std::vector<NormalMap>& maps) {
  std::vector<const NormalMap*> out;
  out.reserve(maps.size());
  for (const NormalMap& map : maps) out.push_back(&map);
  return out;
}

void fit_seams(const Mesh& mesh, std::span<const SeamEdge> seams, const ChartGrid& grid,
               const Rect& region, NormalMaps before, StorageAtlas& storage) {
  fit(mesh, seams_near(mesh, seams, grid, region), 1.0F, before, storage);
}

EditReport apply_edit(const Edit& edit, const Mesh& mesh, std::span<const SeamEdge> seams,
                      SurfaceCover& cover, StorageAtlas& storage, const TransferOptions& transfer) {
  if (const auto* surface = std::get_if<SurfaceView>(&edit.view)) {
    check_transfer(edit, transfer);
    if (!edit.surface_strokes.empty()) return apply_along_strokes(edit, mesh, seams, storage);
    return apply_to_surface(edit, *surface, mesh, seams, cover, storage);
  }
  if (edit.mirror && transfer.update != Update::Gather) {
    throw InvalidInput(edit.path +
                       ".mirror must be left out with --update point or area: each side would "
                       "write its values over the other's");
  }
  const View view = resolve(edit.view, mesh);
  const CoverView shown = whole_view(view);
  Stopwatch watch;
  const ChartPlan plan = plan_chart(edit, shown, mesh, storage);
  const TilePlan tiles = plan_tiles(edit, view, plan, transfer);
  const double planned = watch.lap();
  if (!tiles.tiles.empty()) return apply_in_tiles(edit, shown, plan, tiles, mesh, seams, storage);
  PreparedEdit side = facing(edit, prepare_edit(edit, shown, mesh, storage, plan, transfer));
  side.report.times.pull += planned;
  std::optional<PreparedEdit> other;  // before any push: both see what was there, and throw in time
  if (edit.mirror) {
    const View image = mirrored(view, static_cast<int>(edit.mirror->axis), edit.mirror->at);
    Edit opposite = edit;
    opposite.along[static_cast<int>(edit.mirror->axis)] *= -1.0F;
    try {
      other = facing(opposite, prepare_edit(opposite, image, mesh, storage, transfer));
    } catch (const InvalidInput& error) {
      throw InvalidInput(edit.path + ".mirror: on the other side, " + error.what());
    }
  }
  // What needs memory comes before anything changes.
  if (!side.colors.change.empty()) prepare_colors(mesh, storage);
  push_prepared(edit, mesh, seams, side, storage);
  if (!other) return side.report;
  push_prepared(edit, mesh, seams, *other, storage);
  add(other->report, side.report);
  return side.report;
}

}  // namespace normalshop
