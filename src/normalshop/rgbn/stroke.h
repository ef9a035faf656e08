#pragma once

#include <vector>

#include "normalshop/core/image.h"

namespace normalshop {

/// Positions in pixels of the chart: (i, j) is the centre of pixel (i, j), y runs DOWN like the
/// rows.
struct StrokePoint {
  Vec2f position;
  float pressure = 1.0F;  ///< 0 to 1
};

/// A polyline. One point is a dot.
using Stroke = std::vector<StrokePoint>;

}  // namespace normalshop
