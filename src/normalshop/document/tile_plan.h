#pragma once

#include <vector>

#include "normalshop/document/prepare_edit.h"

namespace normalshop {

/// A part of a chart, in lattice pixels (ChartGrid).
struct ChartTile {
  Rect own;     ///< what it is made for
  Rect window;  ///< with what the operator and the weight of the chart read around that
};

/// How an edit's view is cut.
struct TilePlan {
  ChartGrid grid;                ///< of the chart in one piece
  std::vector<ChartTile> tiles;  ///< empty: it fits, or the edit needs it in one piece
};

/// The tiles of a chart that would have more than transfer.largest_side pixels a side; they have at
/// most half of that, or, with an operator that reads far, all of it. Together their own pixels are
/// all that the edit may change.
///
/// The chart stays in one piece, with larger pixels, for operators that are not local, pick their
/// place, move colours or read further than a quarter of a tile; along base normals, whose relief
/// is measured as a whole; for mirrored edits, for other transfers than the usual one, and for
/// ChartWindow::View, the chart of strokes that are being drawn.
///
/// Tiles start at multiples of 64 pixels from where the whole chart does, so that what operators do
/// on every second to 64th pixel meets the same ones.
TilePlan plan_tiles(const Edit& edit, const View& view, const ChartPlan& plan,
                    const TransferOptions& transfer);

}  // namespace normalshop
