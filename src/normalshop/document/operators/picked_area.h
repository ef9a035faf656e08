#pragma once

#include "normalshop/document/operators/filter_area.h"

/// The areas that strokes pick in what is there before the edit: "segments" and "alike".
namespace normalshop {

/// How far each pixel is picked, 0 to 1, times `view` (lengths in pixels). Returns where that is
/// not 0. `mask` is 0 before.
Rect pick_area(const FilterAreaOptions& options, const OperatorInput& input, MaskView view,
               MaskSpan mask);

}  // namespace normalshop
