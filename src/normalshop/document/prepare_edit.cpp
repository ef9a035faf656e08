#include "normalshop/document/prepare_edit.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>

#include "normalshop/chart/curvature_term.h"
#include "normalshop/chart/extend.h"
#include "normalshop/chart/point_pull.h"
#include "normalshop/chart/resolution.h"
#include "normalshop/chart/update_storage.h"
#include "normalshop/core/error.h"
#include "normalshop/core/for_pixels.h"
#include "normalshop/core/parallel.h"
#include "normalshop/core/stopwatch.h"
#include "normalshop/document/grazing.h"
#include "normalshop/document/surface_check.h"

namespace normalshop {

namespace {

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

/// How far an edit looks beyond what it changes, in a chart whose pixels are that long.
float reach_of(const Edit& edit, float pixel) {
  const float feather = edit.part ? edit.part->feather : 0.0F;
  return std::max(edit.operation->reach(pixel), feather);
}

/// The window that the edit needs. There is nothing to read or write beyond the model, so that a
/// huge brush or sigma costs no more than the whole model does; and rather than let the pixels grow
/// coarser than the texels, an edit reads less far.
ChartGrid choose_grid(const Edit& edit, const View& view, const Extent& extent, const Extent& model,
                      float pixel) {
  const Vec2f spare =
      0.5F * (Vec2f::Constant(pixel * (max_chart_side - 16)) - (extent.high - extent.low));
  const Vec2f reach = spare.cwiseMax(0.0F).cwiseMin(reach_of(edit, pixel));
  const Extent read = intersect(Extent{extent.low - reach, extent.high + reach}, model);
  const Extent window = widened(read, 4.0F * pixel);
  try {
    return make_grid(view, pixel, window.low, window.high);
  } catch (const InvalidInput&) {
    throw InvalidInput(edit.path +
                       ".view must have its centre nearer to the model: its pixels are too many to "
                       "count from there");
  }
}

bool bends(const Edit& edit) {
  return edit.mode == EditMode::Base && edit.curvature == CurvatureRule::Keep;
}

/// The base surface's numbers, continued past its borders.
SlopeImage base_slopes(const EditingChart& chart, const EditDirection& direction) {
  SlopeImage base(chart.grid.width(), chart.grid.height());
  for_pixels(base.rect(),
             [&](int x, int y) { base(x, y) = base_gradient(chart.base_normal(x, y), direction); });
  extend(chart.weight, base);
  return base;
}

void read_details(const Edit& edit, const EditingChart& chart, const EditDirection& direction,
                  ChartSource& source) {
  const int width = chart.grid.width();
  const int height = chart.grid.height();
  const bool ignore = edit.details == DetailsRule::Ignore;
  const bool with_seen = ignore && edit.operation->picks();
  source.slopes.resize(width, height);
  source.validity.resize(width, height);
  if (with_seen) source.seen.resize(width, height);
  parallel_for(static_cast<std::size_t>(height), 32, [&](std::size_t a, std::size_t b) {
    for (int y = static_cast<int>(a); y < static_cast<int>(b); ++y) {
      for (int x = 0; x < width; ++x) {
        const Vec3f& base = chart.base_normal(x, y);
        // Steep slopes beside rims and steps would else outweigh the surface around them.
        source.validity(x, y) = chart.weight(x, y);
        const bool valid = chart.weight(x, y) > 0.0F;
        const Vec2f below = valid ? base_gradient(base, direction) : Vec2f(0.0F, 0.0F);
        Vec2f details = below;
        if (valid && (!ignore || with_seen)) {
          details = gradient_from_normal(chart.normal(x, y), base, direction);
        }
        source.slopes(x, y) = ignore ? below : details;
        if (with_seen) source.seen(x, y) = details;
      }
    }
  });
  if (!ignore && edit.operation->reads()) source.grazing = limit_grazing(source.slopes);
  extend(source.validity, source.slopes);
}

MaskImage spray_shares(const EditingChart& chart, const EffectiveAngles& angles) {
  MaskImage shares(chart.grid.width(), chart.grid.height());
  const SprayShare share(angles);
  for_pixels(shares.rect(), [&](int x, int y) { shares(x, y) = share(chart.normal(x, y).z()); });
  return shares;
}

ChartSource make_source(const Edit& edit, const EditingChart& chart,
                        const EditDirection& direction) {
  ChartSource source;
  const bool ignore = edit.details == DetailsRule::Ignore;
  const EditOperator& operation = *edit.operation;
  if (operation.reads() || operation.picks() || bends(edit))
    read_details(edit, chart, direction, source);
  source.finer = ignore ? 0.0F : operation.removes_finer(chart.grid.pixel);
  const bool turns = source.finer > 0.0F || !source.grazing.empty();
  source.replaces = ignore || turns;
  if (operation.reads_base() || turns) source.base = base_slopes(chart, direction);
  if (edit.spray) source.spray = spray_shares(chart, *edit.spray);
  return source;
}

bool has_colors(const StorageAtlas& storage) {
  return std::any_of(storage.sets.begin(), storage.sets.end(),
                     [](const StorageSet& set) { return !set.albedo.empty(); });
}

/// Pulls what the operator and the update need, and weighs.
EditingChart build_chart(const Edit& edit, const CoverView& cover, const Mesh& mesh,
                         const StorageAtlas& storage, const ChartGrid& grid, float model_size,
                         const TransferOptions& transfer) {
  EditingChart chart;
  chart.grid = grid;
  PullOptions pulled;
  const EditOperator& operation = *edit.operation;
  const bool keeps = edit.details == DetailsRule::Keep;
  pulled.normals = operation.picks() || ((operation.reads() || bends(edit)) && keeps) ||
                   edit.spray || transfer.update != Update::Gather;
  pulled.albedo = operation.reads_colors() && has_colors(storage);
  pulled.means = transfer.update == Update::Gather;  // the thesis' updates write what was pulled
  if (transfer.transfer == Transfer::Point) {
    pull_points(mesh, storage, grid, pulled, chart);
  } else {
    cover.rasterize(mesh, chart.grid, chart.ids);
    pull_attributes(mesh, storage, chart, pulled);
    if (transfer.update != Update::Gather) find_texels(mesh, storage, chart);
  }
  compute_weight(chart, effective_options(edit.effective, model_size));
  return chart;
}

EditPlace find_place(const Edit& edit, const CoverView& cover, const Bounds& box) {
  const View& view = cover.view;
  EditPlace place{view_extent(view), model_extent(box, view), edit.operation->extent(edit.strokes)};
  if (place.extent.empty()) place.extent = {cover.low, cover.high};
  place.extent = intersect(place.extent, widened(place.model, 1e-3F * box.diagonal()));
  if (edit.window == ChartWindow::View) place.extent = intersect(place.extent, place.view);
  if (place.extent.empty()) {
    fail_off_surface(edit.path + (edit.strokes.empty() ? ".view" : ".strokes"), place.model);
  }
  return place;
}

/// In chart axes.
EditDirection direction_of(const Edit& edit, const View& view) {
  if (edit.mode != EditMode::Along) return edit.mode;
  return EditDirection(view.to_chart(edit.along));
}

/// Reads what the operator needs, and lets go of the rest.
void open_source(const Edit& edit, OpenChart& open) {
  EditingChart& chart = open.chart;
  open.source = make_source(edit, chart, open.direction);
  if (open.report.transfer.update == Update::Gather) {
    chart.normal = {};
    if (edit.mode != EditMode::Base) chart.base_normal = {};
  }
  // What moves may come from beyond the border, and bicubic reads there need it.
  if (edit.operation->moves_colors() && !chart.albedo.empty()) extend(chart.weight, chart.albedo);
}

/// The chart of that grid.
OpenChart open_grid(const Edit& edit, const CoverView& cover, const Mesh& mesh,
                    const StorageAtlas& storage, const TransferOptions& transfer,
                    const ChartPlan& plan, const ChartGrid& grid) {
  Stopwatch watch;
  OpenChart open;
  open.place = plan.place;
  open.chart = build_chart(edit, cover, mesh, storage, grid, plan.model_size, transfer);
  open.direction = direction_of(edit, cover.view);
  if (edit.mode == EditMode::Along) {
    open.faces = limit_weight(open.chart, effective_options(edit.effective, plan.model_size),
                              open.direction.along, make_input(edit, grid, open.place).region);
  }
  EditReport& report = open.report;
  report.transfer = transfer;
  report.views = 1;
  report.chart_width = grid.width();
  report.chart_height = grid.height();
  report.pixel = grid.pixel;
  report.texels_per_pixel = grid.pixel / plan.texel;
  report.times.pull = watch.lap();
  if (!open.faces) return open;
  open_source(edit, open);
  report.times.operate = watch.lap();
  return open;
}

OpenChart open_planned(const Edit& edit, const CoverView& cover, const Mesh& mesh,
                       const StorageAtlas& storage, const TransferOptions& transfer,
                       const ChartPlan& plan) {
  return open_grid(edit, cover, mesh, storage, transfer, plan,
                   choose_grid(edit, cover.view, plan.shown, plan.place.model, plan.texel));
}

/// Restores the curvature term in the change of the normals, or measures what that would do.
void bend(const EditingChart& chart, const std::optional<CurvatureTerm>& term,
          PreparedEdit& prepared) {
  OperatorResult& result = prepared.result;
  ReliefReach& relief = prepared.report.relief;
  if (!term) {
    relief = CurvatureTerm(chart.base_normal, chart.weight).measure(result.region, result.change);
    return;
  }
  const MaskView coverage = prepared.replaces ? result.coverage.view() : MaskView();
  relief = term->convert(result.region, coverage, result.change);
}

PreparedEdit finish(const Edit& edit, OpenChart open, SurfaceCheck& check) {
  Stopwatch watch;
  PreparedEdit prepared;
  prepared.direction = open.direction;
  prepared.faces = open.faces;
  if (!open.faces) return prepared;
  const OperatorInput input = operator_input(edit, open);
  EditingChart& chart = open.chart;
  // Strokes on the surface need no search for it; what a view shows of them may be its rim alone.
  if (edit.surface_strokes.empty()) {
    check.look(input.strokes, chart, input.region);
    if (open.own.empty()) check.demand(open.place.model);
  }
  std::optional<CurvatureTerm> term;
  if (bends(edit)) {
    term.emplace(chart.base_normal, chart.weight);
    term->restore(open.source.slopes, input.region);
  }
  prepared.result = empty_result(chart.grid.width(), chart.grid.height());
  operate(edit, open, input, prepared.result);
  prepared.replaces = open.source.replaces;
  prepared.colors = operate_on_colors(edit, open, input);
  prepared.report = open.report;
  if (edit.mode == EditMode::Base) bend(chart, term, prepared);
  chart.albedo = {};
  if (open.report.transfer.update == Update::Gather) chart.base_normal = {};
  prepared.chart = std::move(chart);
  prepared.report.times.operate += watch.lap();
  return prepared;
}

}  // namespace

EffectiveOptions effective_options(const EffectiveAngles& angles, float model_size) {
  EffectiveOptions options = effective_on(model_size);
  options.full_angle = angles.full;
  options.zero_angle = angles.zero;
  return options;
}

CoverView whole_view(const View& view) {
  const Extent all = view_extent(view);
  return {view, all.low, all.high, nullptr};
}

ChartPlan plan_chart(const Edit& edit, const CoverView& cover, const Mesh& mesh,
                     const StorageAtlas& storage) {
  const Bounds box = bounds(mesh);
  const View& view = cover.view;
  check_near_view(edit, view);
  ChartPlan plan;
  plan.model_size = box.diagonal();
  plan.place = find_place(edit, cover, box);
  plan.shown = edit.window == ChartWindow::View
                   ? intersect(plan.place.view, widened(plan.place.model, 1e-3F * plan.model_size))
                   : plan.place.extent;
  const CountedTexels counted =
      edit.operation->moves_colors() ? CountedTexels::All : CountedTexels::Normals;
  // What reads no details loses none to pixels that are longer than texels seen at an angle.
  const bool facing = edit.window == ChartWindow::View && !edit.operation->reads() &&
                      !edit.operation->picks() && !edit.operation->moves_colors();
  plan.texel = texel_pixel_size(mesh, storage, view, plan.shown.low, plan.shown.high, counted,
                                facing ? TexelLength::Facing : TexelLength::Seen);
  return plan;
}

OpenChart open_chart(const Edit& edit, const View& view, const Mesh& mesh,
                     const StorageAtlas& storage, const TransferOptions& transfer) {
  Stopwatch watch;
  const CoverView cover = whole_view(view);
  const ChartPlan plan = plan_chart(edit, cover, mesh, storage);
  const double planned = watch.lap();
  OpenChart open = open_planned(edit, cover, mesh, storage, transfer, plan);
  open.report.times.pull += planned;
  return open;
}

void fail_averted(const Edit& edit) {
  throw InvalidInput(edit.path +
                     ".mode.along must point out of surface that the edit's view shows, as from "
                     "inside the model towards the eye: none there faces it");
}

OperatorInput operator_input(const Edit& edit, const OpenChart& open) {
  constexpr int kernel = 4;  // pixels around a point that push may read
  OperatorInput input = make_input(edit, open.chart.grid, open.place);
  if (!open.own.empty()) input.region = intersect(input.region, grow(open.own, kernel));
  const ChartSource& source = open.source;
  const EditOperator& operation = *edit.operation;
  if (operation.reads()) input.source = source.slopes;
  if (operation.picks()) {
    input.seen = source.seen.empty() ? source.slopes.view() : source.seen.view();
  }
  if (operation.reads_base()) input.base = source.base;
  input.colors = open.chart.albedo;
  if (operation.reads() || operation.picks()) input.validity = source.validity;
  return input;
}

void operate(const Edit& edit, const OpenChart& open, const OperatorInput& input,
             OperatorResult& result) {
  run_operator(edit, input, result);
  const ChartSource& source = open.source;
  if (source.finer > 0.0F || !source.grazing.empty()) {
    replace_details(source.grazing, source.finer, source.slopes, source.base, result);
  }
  if (!source.spray.empty()) multiply(source.spray, result);
}

bool operate_again(const Edit& edit, const OpenChart& open, const OperatorInput& input,
                   const std::vector<Stroke>& before, OperatorResult& result, PixelBlocks& drawn) {
  const ChartSource& source = open.source;
  if (!rerun_operator(edit, input, before, source.replaces, result, drawn)) return false;
  assert(!(source.finer > 0.0F) && source.grazing.empty());
  if (!source.spray.empty()) multiply(source.spray, drawn, result);
  return true;
}

ColorResult operate_on_colors(const Edit& edit, const OpenChart& open, const OperatorInput& input) {
  const ColorView before = open.chart.albedo;
  if (!edit.operation->moves_colors() || before.empty()) return {};
  ColorResult result{ColorImage(before.width(), before.height()), {}};
  result.region = edit.operation->run_colors(input, result.change);
  for_pixels(result.region, [&](int x, int y) {
    const float spray = open.source.spray.empty() ? 1.0F : open.source.spray(x, y);
    result.change(x, y) = (edit.strength * spray) * (result.change(x, y) - before(x, y));
  });
  return result;
}

PreparedEdit prepare_edit(const Edit& edit, const CoverView& cover, const Mesh& mesh,
                          const StorageAtlas& storage, const ChartPlan& plan,
                          const TransferOptions& transfer) {
  SurfaceCheck check(edit, edit.strokes.size());
  return finish(edit, open_planned(edit, cover, mesh, storage, transfer, plan), check);
}

PreparedEdit prepare_edit(const Edit& edit, const CoverView& cover, const Mesh& mesh,
                          const StorageAtlas& storage, const TransferOptions& transfer) {
  Stopwatch watch;
  const ChartPlan plan = plan_chart(edit, cover, mesh, storage);
  const double planned = watch.lap();
  PreparedEdit prepared = prepare_edit(edit, cover, mesh, storage, plan, transfer);
  prepared.report.times.pull += planned;
  return prepared;
}

PreparedEdit prepare_tile(const Edit& edit, const CoverView& view, const Mesh& mesh,
                          const StorageAtlas& storage, const ChartPlan& plan, const ChartGrid& grid,
                          const Rect& own, SurfaceCheck& check) {
  OpenChart open = open_grid(edit, view, mesh, storage, {}, plan, grid);
  open.own = own;
  return finish(edit, std::move(open), check);
}

PreparedEdit prepare_edit(const Edit& edit, const View& view, const Mesh& mesh,
                          const StorageAtlas& storage, const TransferOptions& transfer) {
  return prepare_edit(edit, whole_view(view), mesh, storage, transfer);
}

}  // namespace normalshop
