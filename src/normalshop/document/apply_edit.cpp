#include "normalshop/document/apply_edit.h"

#include <algorithm>
#include <cmath>

#include "normalshop/chart/effective.h"
#include "normalshop/chart/extend.h"
#include "normalshop/chart/point_pull.h"
#include "normalshop/chart/resolution.h"
#include "normalshop/chart/update_storage.h"
#include "normalshop/core/error.h"
#include "normalshop/core/parallel.h"
#include "normalshop/core/stopwatch.h"
#include "normalshop/document/grazing.h"
#include "normalshop/document/operate.h"
#include "normalshop/document/surface_check.h"
#include "normalshop/surface/seam_fit.h"

namespace normalshop {

namespace {

/// Depth steps fade an edit out over this part of the model's size.
constexpr float step_falloff_share = 0.004F;

Extent view_extent(const View& view) {
  return {Vec2f(-0.5F * view.width, -0.5F * view.height),
          Vec2f(0.5F * view.width, 0.5F * view.height)};
}

/// A box in the view that holds the whole model.
Extent model_extent(const Bounds& bounds, const View& view) {
  const Vec3f middle = view.to_chart(bounds.center() - view.center);
  const Vec3f half = 0.5F * (bounds.high - bounds.low);
  const Vec2f reach(view.right.cwiseAbs().dot(half), view.up.cwiseAbs().dot(half));
  return {middle.head<2>() - reach, middle.head<2>() + reach};
}

/// The window that the edit needs. There is nothing to read or write beyond the model, so that a
/// huge brush or sigma costs no more than the whole model does; and rather than let the pixels grow
/// coarser than the texels, an edit reads less far.
ChartGrid choose_grid(const Edit& edit, const View& view, const EditPlace& place, float pixel) {
  const Extent& extent = place.extent;
  const Vec2f spare =
      0.5F * (Vec2f::Constant(pixel * (max_chart_side - 16)) - (extent.high - extent.low));
  const Vec2f reach = spare.cwiseMax(0.0F).cwiseMin(edit.operation->reach(pixel));
  const Extent read = intersect(Extent{extent.low - reach, extent.high + reach}, place.model);
  const Extent window = widened(read, 4.0F * pixel);
  try {
    return make_grid(view, pixel, window.low, window.high);
  } catch (const InvalidInput&) {
    throw InvalidInput(edit.path +
                       ".view must have its centre nearer to the model: its pixels are too many to "
                       "count from there");
  }
}

/// The two numbers that the operator sees, and where they are real.
struct Source {
  SlopeImage slopes;
  SlopeImage base;  ///< may be empty
  SlopeImage seen;  ///< empty: slopes
  MaskImage validity;
  MaskImage grazing;  ///< may be empty
};

Source make_source(const Edit& edit, const EditingChart& chart) {
  const int width = chart.grid.width();
  const int height = chart.grid.height();
  const bool with_base = edit.operation->reads_base();
  const bool ignore = edit.details == DetailsRule::Ignore;
  const bool with_seen = ignore && edit.operation->picks();
  Source source{SlopeImage(width, height), {}, {}, MaskImage(width, height), {}};
  if (with_base) source.base.resize(width, height);
  if (with_seen) source.seen.resize(width, height);
  parallel_for(static_cast<std::size_t>(height), 32, [&](std::size_t a, std::size_t b) {
    for (int y = static_cast<int>(a); y < static_cast<int>(b); ++y) {
      for (int x = 0; x < width; ++x) {
        const Vec3f& base = chart.base_normal(x, y);
        // Steep slopes beside rims and steps would else outweigh the surface around them.
        source.validity(x, y) = chart.weight(x, y);
        const bool valid = chart.weight(x, y) > 0.0F;
        const Vec2f below = valid ? base_gradient(base, edit.mode) : Vec2f(0.0F, 0.0F);
        Vec2f details = below;
        if (valid && (!ignore || with_seen)) {
          details = gradient_from_normal(chart.normal(x, y), base, edit.mode);
        }
        source.slopes(x, y) = ignore ? below : details;
        if (with_base) source.base(x, y) = below;
        if (with_seen) source.seen(x, y) = details;
      }
    }
  });
  if (!ignore && edit.operation->reads()) source.grazing = limit_grazing(source.slopes);
  extend(source.validity, source.slopes);
  if (with_base) extend(source.validity, source.base);
  return source;
}

bool has_colors(const StorageAtlas& storage) {
  return std::any_of(storage.sets.begin(), storage.sets.end(),
                     [](const StorageSet& set) { return !set.albedo.empty(); });
}

/// Pulls what the operator and the update need, and weighs.
EditingChart build_chart(const Edit& edit, const Mesh& mesh, const StorageAtlas& storage,
                         const ChartGrid& grid, float model_size, const TransferOptions& transfer) {
  PullOptions pulled;
  const EditOperator& operation = *edit.operation;
  pulled.normals = operation.picks() || (operation.reads() && edit.details == DetailsRule::Keep) ||
                   transfer.update != Update::Gather;
  pulled.albedo = operation.reads_colors() && has_colors(storage);
  const bool points = transfer.transfer == Transfer::Point;
  EditingChart chart =
      points ? pull_points(mesh, storage, grid, pulled) : pull(mesh, storage, grid, pulled);
  if (!points && transfer.update != Update::Gather) find_texels(mesh, storage, chart);
  EffectiveOptions effective;
  effective.full_angle = edit.effective.full;
  effective.zero_angle = edit.effective.zero;
  effective.step_falloff = step_falloff_share * model_size;
  compute_weight(chart, effective);
  return chart;
}

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

PushResult push_and_fit(const Mesh& mesh, std::span<const SeamEdge> seams,
                        const EditingChart& chart, const ChartEdit& result, StorageAtlas& storage) {
  std::vector<NormalMap*> maps;
  for (StorageSet& set : storage.sets) maps.push_back(&set.normals);
  const std::vector<const NormalMap*> before(maps.begin(), maps.end());
  const SeamFit fit(mesh, seams_near(mesh, seams, chart.grid, result.region), before);
  const PushResult pushed = push(mesh, chart, result, storage);
  fit.apply(maps);
  return pushed;
}

/// An edit in one view before its push.
struct Prepared {
  TransferOptions transfer;
  EditingChart chart;
  OperatorResult result;
  bool replaces = false;  ///< its coverage counts
  EditReport report;
};

EditPlace find_place(const Edit& edit, const View& view, const Bounds& box) {
  EditPlace place{view_extent(view), model_extent(box, view), edit.operation->extent(edit.strokes)};
  if (place.extent.empty()) place.extent = place.view;
  place.extent = intersect(place.extent, widened(place.model, 1e-3F * box.diagonal()));
  if (place.extent.empty()) {
    fail_off_surface(edit.path + (edit.strokes.empty() ? ".view" : ".strokes"), place.model);
  }
  return place;
}

/// Runs the operator and lets go of what push does not need.
void operate(const Edit& edit, const EditPlace& place, Prepared& prepared) {
  EditingChart& chart = prepared.chart;
  OperatorInput input = make_input(edit, chart.grid, place);
  check_on_surface(edit, input.strokes, chart, input.region, place.model);
  Source source;
  if (edit.operation->reads() || edit.operation->picks()) source = make_source(edit, chart);
  const bool gather = prepared.transfer.update == Update::Gather;
  if (gather) chart.normal = {};
  if (edit.operation->reads()) input.source = source.slopes;
  if (edit.operation->picks()) {
    input.seen = source.seen.empty() ? source.slopes.view() : source.seen.view();
  }
  input.colors = chart.albedo;
  input.base = source.base;
  input.validity = source.validity;
  prepared.result = run_operator(edit, input, chart.grid.width(), chart.grid.height());
  prepared.replaces = edit.details == DetailsRule::Ignore || !source.grazing.empty();
  if (!source.grazing.empty()) {
    replace_grazing(source.grazing, source.slopes, chart.base_normal, edit.mode, prepared.result);
  }
  if (gather) chart.base_normal = {};
  chart.albedo = {};
}

Prepared prepare(const Edit& edit, const View& view, const Mesh& mesh, const StorageAtlas& storage,
                 const TransferOptions& transfer) {
  Stopwatch watch;
  const Bounds box = bounds(mesh);
  check_near_view(edit, view);
  const EditPlace place = find_place(edit, view, box);
  const float texel = texel_pixel_size(mesh, storage, view, place.extent.low, place.extent.high);
  Prepared prepared;
  prepared.transfer = transfer;
  prepared.chart = build_chart(edit, mesh, storage, choose_grid(edit, view, place, texel),
                               box.diagonal(), transfer);
  EditReport& report = prepared.report;
  report.transfer = transfer;
  const ChartGrid& grid = prepared.chart.grid;
  report.chart_width = grid.width();
  report.chart_height = grid.height();
  report.pixel = grid.pixel;
  report.coarser_than_texels = grid.pixel > 1.01F * texel;
  report.times.pull = watch.lap();
  operate(edit, place, prepared);
  report.times.operate = watch.lap();
  return prepared;
}

void push_prepared(const Edit& edit, const Mesh& mesh, std::span<const SeamEdge> seams,
                   Prepared& prepared, StorageAtlas& storage) {
  Stopwatch watch;
  ChartEdit change{edit.mode, prepared.result.change, {}, prepared.result.region};
  if (prepared.replaces) change.coverage = prepared.result.coverage;
  const Update update = prepared.transfer.update;
  if (edit.strength > 0.0F && update == Update::Gather) {
    prepared.report.pushed = push_and_fit(mesh, seams, prepared.chart, change, storage);
  } else if (edit.strength > 0.0F) {
    prepared.report.pushed = update_storage(mesh, prepared.chart, change, update, storage);
    prepared.report.lost = lost_texels(mesh, prepared.chart, change.region, storage);
  }
  prepared.report.times.push = watch.lap();
}

/// Both sides of a mirrored edit; the chart is that of the first.
void add(const EditReport& other, EditReport& report) {
  report.coarser_than_texels = report.coarser_than_texels || other.coarser_than_texels;
  report.lost += other.lost;
  report.pushed.visited += other.pushed.visited;
  report.pushed.changed += other.pushed.changed;
  report.pushed.largest_change =
      std::max(report.pushed.largest_change, other.pushed.largest_change);
  report.times.pull += other.times.pull;
  report.times.operate += other.times.operate;
  report.times.push += other.times.push;
}

}  // namespace

EditReport apply_edit(const Edit& edit, const Mesh& mesh, std::span<const SeamEdge> seams,
                      StorageAtlas& storage, const TransferOptions& transfer) {
  const View view = resolve(edit.view, mesh);
  Prepared side = prepare(edit, view, mesh, storage, transfer);
  std::optional<Prepared> other;  // before any push: both see what was there, and throw in time
  if (edit.mirror) {
    const View image = mirrored(view, static_cast<int>(edit.mirror->axis), edit.mirror->at);
    try {
      other = prepare(edit, image, mesh, storage, transfer);
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
