#pragma once

#include <span>

#include "normalshop/chart/pull.h"

namespace normalshop {

/// What masks in the layout of the atlas say where the chart sees surface, bilinear between their
/// pixels; 0 elsewhere. `masks`: one of any size a texture set; an empty one is 0 everywhere. Reads
/// chart.ids, which have the grid's size.
MaskImage pull_masks(const Mesh& mesh, std::span<const MaskView> masks, const EditingChart& chart);

}  // namespace normalshop
