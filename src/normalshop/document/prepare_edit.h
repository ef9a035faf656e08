#pragma once

#include "normalshop/chart/cover.h"
#include "normalshop/document/document.h"
#include "normalshop/document/operate.h"

namespace normalshop {

/// What an operator adds to the colours of a chart.
struct ColorResult {
  ColorImage change;  ///< empty: nothing
  Rect region;
};

/// An edit in one view before its push: pulled and operated on, nothing stored.
struct PreparedEdit {
  EditingChart chart;  ///< what the update needs
  OperatorResult result;
  ColorResult colors;
  bool replaces = false;  ///< the result's coverage counts
  EditReport report;

  ChartEdit change(EditMode mode) const {
    ChartEdit edit{mode, result.change, {}, result.region};
    if (replaces) edit.coverage = result.coverage;
    return edit;
  }
};

/// Throws InvalidInput, naming the field, for what does not fit the surface that the view shows.
PreparedEdit prepare_edit(const Edit& edit, const View& view, const Mesh& mesh,
                          const StorageAtlas& storage, const TransferOptions& transfer = {});
/// An edit of the whole view, made in its part and on what it shows of the mesh.
PreparedEdit prepare_edit(const Edit& edit, const CoverView& view, const Mesh& mesh,
                          const StorageAtlas& storage, const TransferOptions& transfer = {});

/// The effective chart that an edit asks for, on a model of that size.
EffectiveOptions effective_options(const EffectiveAngles& angles, float model_size);

}  // namespace normalshop
