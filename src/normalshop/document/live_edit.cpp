#include "normalshop/document/live_edit.h"

#include <cassert>
#include <cmath>

#include "normalshop/chart/push_colors.h"
#include "normalshop/core/error.h"
#include "normalshop/core/for_pixels.h"
#include "normalshop/core/stopwatch.h"
#include "normalshop/document/apply_edit.h"
#include "normalshop/document/prepare_edit.h"
#include "normalshop/document/region_before.h"
#include "normalshop/document/surface_check.h"
#include "normalshop/surface/seam_fit.h"

namespace normalshop {

namespace {

View one_view(const Edit& edit, const Mesh& mesh) {
  if (std::holds_alternative<SurfaceView>(edit.view)) {
    throw InvalidInput(edit.path +
                       ".view must be one view, not \"surface\", where strokes are drawn");
  }
  return resolve(edit.view, mesh);
}

OpenChart open_facing(const Edit& edit, const View& view, const Document& document) {
  OpenChart open = open_chart(edit, view, document.mesh(), document.storage());
  if (!open.faces) fail_averted(edit);
  return open;
}

/// Nothing is drawn yet.
Edit without_strokes(Edit edit) {
  edit.window = ChartWindow::View;
  edit.strokes.clear();
  return edit;
}

}  // namespace

struct LiveEdit::State {
  State(Document& owner, Edit begun)
      : document(owner),
        edit(without_strokes(std::move(begun))),
        view(one_view(edit, owner.mesh())),
        open(open_facing(edit, view, owner)),
        result(empty_result(open.chart.grid.width(), open.chart.grid.height())),
        push(owner.mesh(), owner.storage(), open.chart, open.direction, result.change,
             open.source.replaces ? result.coverage.view() : MaskView()),
        drawn(open.chart.grid.width(), open.chart.grid.height()) {
    if (owner.file()) maps.emplace(owner.storage(), edit.operation->moves_colors());
  }

  Document& document;
  Edit edit;
  View view;
  OpenChart open;
  OperatorResult result;
  LivePush push;
  PixelBlocks drawn;  // by the last draw()
  RegionBefore before;
  std::optional<MapsBefore> maps;  // before the edit, of a document on file
};

LiveEdit::LiveEdit(Document& document, Edit edit)
    : state_(std::make_unique<State>(document, std::move(edit))) {
  document.live_ = true;
}

LiveEdit::~LiveEdit() { cancel(); }

const Edit& LiveEdit::edit() const {
  assert(state_);
  return state_->edit;
}

const ChartGrid& LiveEdit::grid() const {
  assert(state_);
  return state_->open.chart.grid;
}

/// Where strokes that have taken the place of others may have changed something.
Rect LiveEdit::changed_region(const std::vector<UnitStroke>& before) const {
  const EditOperator& operation = *state_->edit.operation;
  const std::vector<UnitStroke>& after = state_->edit.strokes;
  const float back = operation.looks_back();
  std::vector<UnitStroke> parts = changed_parts(before, after, back);
  if (parts.empty()) return {};
  if (std::isinf(back)) {
    parts = before;
    parts.insert(parts.end(), after.begin(), after.end());
  }
  return region_of(operation.bounds(parts));
}

/// The pixels of an extent; an empty one is the whole view.
Rect LiveEdit::region_of(const Extent& extent) const {
  const Extent& view = state_->open.place.view;
  return changeable_pixels(state_->open.chart.grid,
                           extent.empty() ? view : intersect(extent, view));
}

/// Makes the result anew in the region of `drawn`, and marks where it may have become different.
/// `before`: the strokes that it was made of; null where that is not known.
void LiveEdit::redraw(const std::vector<UnitStroke>* before) {
  State& state = *state_;
  const ChartGrid& grid = state.open.chart.grid;
  if (before != nullptr && !state.edit.strokes.empty() &&
      operate_again(state.edit, state.open, operator_input(state.edit, state.open),
                    to_pixels(*before, grid), state.result, state.drawn)) {
    return;
  }
  redraw_all();
}

void LiveEdit::redraw_all() {
  State& state = *state_;
  OperatorResult& result = state.result;
  const Rect& region = state.drawn.region();
  state.before.take(region, result);
  for_pixels(region, [&](int x, int y) {
    result.change(x, y) = Vec2f(0.0F, 0.0F);
    result.coverage(x, y) = 0.0F;
  });
  if (!state.edit.strokes.empty()) {
    OperatorInput input = operator_input(state.edit, state.open);
    input.region = region;
    operate(state.edit, state.open, input, result);
  }
  state.before.mark_different(result, state.drawn);
}

const std::vector<MapTile>& LiveEdit::push(const Rect& region,
                                           const std::vector<UnitStroke>* before) {
  State& state = *state_;
  EditTimes& times = state.open.report.times;
  Stopwatch watch;
  state.drawn.reset(region);
  redraw(before);
  times.operate += watch.lap();
  const std::vector<MapTile>& tiles = state.push.update(state.drawn, state.document.storage_);
  times.push += watch.lap();
  return tiles;
}

const std::vector<MapTile>& LiveEdit::draw(std::vector<UnitStroke> strokes) {
  assert(state_);
  Edit& edit = state_->edit;
  edit.operation->check_strokes(strokes, edit.path + ".strokes");
  std::swap(edit.strokes, strokes);
  const Rect region = changed_region(strokes);
  if (region.empty()) return none_;
  try {
    check_near_view(edit, state_->view);
    return push(region, &strokes);
  } catch (...) {
    std::swap(edit.strokes, strokes);
    push(region, nullptr);
    throw;
  }
}

/// What apply() does after its push. Whatever can fail for want of memory comes first.
EditReport LiveEdit::complete() {
  State& state = *state_;
  const OpenChart& open = state.open;
  Document& document = state.document;
  Stopwatch watch;
  EditReport report = open.report;
  const OperatorInput input = operator_input(state.edit, open);
  const Rect region = region_of(state.edit.operation->extent(state.edit.strokes));
  check_on_surface(state.edit, input.strokes, open.chart, region, open.place.model);
  const ColorResult colors = operate_on_colors(state.edit, open, input);
  if (state.edit.mode == EditMode::Base) {
    report.relief = CurvatureTerm(open.chart.base_normal, open.chart.weight)
                        .measure(region, state.result.change);
  }
  report.times.operate += watch.lap();
  document.log_.reserve(document.log_.size() + 1);
  if (!colors.change.empty()) prepare_colors(document.mesh_, document.storage_);
  report.pushed = state.push.result(document.storage_);
  fit_seams(document.mesh_, document.seams_, open.chart.grid, region, state.push.before(),
            document.storage_);
  if (!colors.change.empty()) {
    report.colors_changed =
        push_colors(document.mesh_, open.chart, {colors.change, colors.region}, document.storage_)
            .changed;
  }
  report.times.push += watch.lap();
  document.record(std::move(state.edit), report, state.maps ? &*state.maps : nullptr);
  return report;
}

EditReport LiveEdit::finish() {
  assert(state_);
  State& state = *state_;
  Document& document = state.document;
  const bool whole = state.edit.mirror || state.edit.curvature == CurvatureRule::Keep ||
                     !document.shows_active_layer();
  if (whole || state.edit.strokes.empty() || state.edit.strength == 0.0F) {
    const Edit edit = state.edit;
    cancel();
    return document.apply(edit);
  }
  EditReport report;
  try {
    report = complete();
  } catch (...) {
    cancel();
    throw;
  }
  document.live_ = false;
  state_.reset();
  return report;
}

void LiveEdit::cancel() {
  if (!state_) return;
  state_->push.restore(state_->document.storage_);
  state_->document.live_ = false;
  state_.reset();
}

}  // namespace normalshop
