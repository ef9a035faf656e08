#pragma once

#include <vector>

#include "normalshop/core/image.h"

namespace normalshop {

/// Positions in pixels of the chart: (i, j) is the centre of pixel (i, j), y runs DOWN like the
/// rows.
struct StrokePoint {
  Vec2f position;
  float pressure = 1.0F;  ///< 0 to 1
  /// Of a stroke that is the picture of a part of a longer line: that line's length in pixels
  /// before and after this point, which the picture may show shortened. Below 0: the stroke is all
  /// there is.
  float along = -1.0F;
  float rest = -1.0F;
  float across = 1.0F;  ///< lengths across the line are shown that many times as long, above 0
};

/// A polyline. One point is a dot.
using Stroke = std::vector<StrokePoint>;

/// Its points have along and rest. Such a stroke is drawn as it is, never smoothed, and may have
/// ends where the line goes on: there is no taper at these.
inline bool is_part(const Stroke& stroke) {
  return !stroke.empty() && stroke.front().along >= 0.0F;
}

}  // namespace normalshop
