#pragma once

#include "normalshop/chart/pull.h"

namespace normalshop {

/// 1 where a depth step lies between the pixel and its neighbour to the right, below, left or
/// above, relative to the pixel size and the slope of the base surface. Reads chart.ids and
/// chart.base_normal, which have the grid's size.
void find_depth_steps(const EditingChart& chart, Image<std::uint8_t>& steps);

}  // namespace normalshop
