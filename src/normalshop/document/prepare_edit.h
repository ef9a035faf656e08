#pragma once

#include "normalshop/chart/cover.h"
#include "normalshop/document/document.h"
#include "normalshop/document/operate.h"
#include "normalshop/document/surface_check.h"

namespace normalshop {

/// What an operator adds to the colours of a chart.
struct ColorResult {
  ColorImage change;  ///< empty: nothing
  Rect region;
};

/// The two numbers that an operator sees, and where they are real.
struct ChartSource {
  SlopeImage slopes;
  SlopeImage base;  ///< empty unless needed
  SlopeImage seen;  ///< empty: slopes
  MaskImage validity;
  MaskImage grazing;      ///< may be empty
  MaskImage spray;        ///< of Edit::spray; else empty
  float finer = 0.0F;     ///< EditOperator::removes_finer()
  bool replaces = false;  ///< the result's coverage counts
};

/// What the chart of an edit in one view has to show.
struct ChartPlan {
  EditPlace place;
  Extent shown;             ///< what the edit may change, or all of the view: Edit::window
  float texel = 0.0F;       ///< object units: pixels of this length are as fine as the texels
  float model_size = 0.0F;  ///< likewise, across the whole model
};
/// Throws InvalidInput, naming the field, when strokes and model are apart.
ChartPlan plan_chart(const Edit& edit, const CoverView& view, const Mesh& mesh,
                     const StorageAtlas& storage);
/// A view as a whole.
CoverView whole_view(const View& view);

/// A view's chart for an edit: pulled, and what the operator reads of it.
struct OpenChart {
  EditingChart chart;
  EditPlace place;
  ChartSource source;
  /// The pixels that this chart is made for, of one that is cut into tiles; else empty.
  Rect own;
  EditDirection direction;  ///< in chart axes
  /// False: nothing that the view shows faces edit.along. Then there is no source.
  bool faces = true;
  EditReport report;
};

/// Throws InvalidInput, naming the field, for what does not fit the surface that the view shows.
OpenChart open_chart(const Edit& edit, const View& view, const Mesh& mesh,
                     const StorageAtlas& storage, const TransferOptions& transfer = {});
/// Says that an edit's direction meets no surface that faces it.
[[noreturn]] void fail_averted(const Edit& edit);
/// All that the operator gets to see.
OperatorInput operator_input(const Edit& edit, const OpenChart& open);
/// Fills the result, which is 0 there, in input.region.
void operate(const Edit& edit, const OpenChart& open, const OperatorInput& input,
             OperatorResult& result);
/// Makes a result of the strokes `before` one of input.strokes in drawn.region(), and marks where
/// it may have become different. False: the operator makes it anew or not at all; nothing has
/// changed.
bool operate_again(const Edit& edit, const OpenChart& open, const OperatorInput& input,
                   const std::vector<Stroke>& before, OperatorResult& result, PixelBlocks& drawn);
/// What becomes of the chart's colours, all of them; of operators that move colours.
ColorResult operate_on_colors(const Edit& edit, const OpenChart& open, const OperatorInput& input);

/// An edit in one view before its push: pulled and operated on, nothing stored.
struct PreparedEdit {
  EditingChart chart;  ///< what the update needs
  OperatorResult result;
  ColorResult colors;
  EditDirection direction;
  bool replaces = false;  ///< the result's coverage counts
  /// False: nothing that the view shows faces edit.along. Then there is no result.
  bool faces = true;
  EditReport report;

  ChartEdit change() const {
    ChartEdit edit{direction, result.change, {}, result.region};
    if (replaces) edit.coverage = result.coverage;
    return edit;
  }
};

/// Throws as open_chart().
PreparedEdit prepare_edit(const Edit& edit, const View& view, const Mesh& mesh,
                          const StorageAtlas& storage, const TransferOptions& transfer = {});
/// An edit of the whole view, made in its part and on what it shows of the mesh.
PreparedEdit prepare_edit(const Edit& edit, const CoverView& view, const Mesh& mesh,
                          const StorageAtlas& storage, const TransferOptions& transfer = {});
/// The same with the chart planned.
PreparedEdit prepare_edit(const Edit& edit, const CoverView& view, const Mesh& mesh,
                          const StorageAtlas& storage, const ChartPlan& plan,
                          const TransferOptions& transfer = {});

/// A tile of a view that is cut: `grid` is the tile's with its margin on the view's lattice of
/// pixels, `own` are its pixels that this tile is for. Looks with `check` instead of throwing.
PreparedEdit prepare_tile(const Edit& edit, const CoverView& view, const Mesh& mesh,
                          const StorageAtlas& storage, const ChartPlan& plan, const ChartGrid& grid,
                          const Rect& own, SurfaceCheck& check);

/// The effective chart that an edit asks for, on a model of that size.
EffectiveOptions effective_options(const EffectiveAngles& angles, float model_size);

}  // namespace normalshop
