#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <string>

#include "normalshop/core/error.h"
#include "normalshop/rgbn/pen.h"

/// What pen and trim do with strokes before they become fields. Private to this floor.
namespace normalshop {

/// Throws InvalidInput, with the operator's name in front, for closed strokes of fewer than 3
/// points and for points that are not numbers.
inline void check_strokes(const std::string& name, std::span<const Stroke> strokes, bool closed) {
  for (const Stroke& stroke : strokes) {
    if (closed && !stroke.empty() && stroke.size() < 3) {
      throw InvalidInput(name + ": a closed stroke needs at least 3 points");
    }
    for (const StrokePoint& p : stroke) {
      if (p.position.allFinite() && std::isfinite(p.pressure)) continue;
      throw InvalidInput(name + ": a stroke's points must be numbers");
    }
  }
}

/// The line that a stroke of this width follows, for options with `smooth` and `closed`.
template <class Options>
Stroke line_of(const Stroke& stroke, const Options& options) {
  if (!options.smooth) return stroke;
  const float spacing = std::clamp(options.width / 8.0F, 1.0F, 3.0F);
  return smooth_stroke(stroke, spacing, options.closed ? StrokeEnds::Closed : StrokeEnds::Open);
}

}  // namespace normalshop
