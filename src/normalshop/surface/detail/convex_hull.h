#pragma once

#include <vector>

#include "normalshop/core/vec.h"

namespace normalshop::unwrapping {

/// Corners of the convex hull, counter-clockwise (Andrew 1979).
std::vector<Vec2d> convex_hull(std::vector<Vec2d> points);
double polygon_area(const std::vector<Vec2d>& corners);

}  // namespace normalshop::unwrapping
