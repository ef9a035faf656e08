#pragma once

#include "normalshop/chart/pull.h"
#include "normalshop/document/edit.h"

namespace normalshop {

/// Throws InvalidInput, naming the field, for points so far outside the view that pixels cannot
/// count them.
void check_near_view(const Edit& edit, const View& view);

/// What messages say about where strokes may lie. `model`: the box around the model in the view.
[[noreturn]] void fail_off_surface(const std::string& field, const Extent& model);

/// Throws InvalidInput, naming the field, when a stroke does not meet surface that the chart's
/// weight shows, or, without strokes, when `region` (pixels) shows none.
void check_on_surface(const Edit& edit, const std::vector<Stroke>& strokes,
                      const EditingChart& chart, const Rect& region, const Extent& model);

/// The pixels that an extent touches.
Rect pixel_rect(const ChartGrid& grid, const Extent& extent);

}  // namespace normalshop
