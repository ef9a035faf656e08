#pragma once

#include "normalshop/chart/pull.h"

namespace normalshop {

/// 1 where a depth step lies between the pixel and its neighbour to the right, below, left or
/// above: where the depths of two triangles differ from what the slopes of the base surface say by
/// more than `least` (object units) where that faces the viewer, and 2 pixels at least, and as much
/// again as the slopes say. On steep surface (`least` is gone at a slope of 2) walls count, whose
/// depths per pixel go with the pixels; elsewhere gaps, which do not: so charts with pixels up to
/// half of `least` agree about steps. Reads chart.ids and chart.base_normal, which have the grid's
/// size.
void find_depth_steps(const EditingChart& chart, float least, Image<std::uint8_t>& steps);

}  // namespace normalshop
