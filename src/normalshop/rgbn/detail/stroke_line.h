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

/// Arc length at each point.
inline std::vector<float> lengths_along(const Stroke& stroke) {
  std::vector<float> along;
  for (std::size_t i = 0; i < stroke.size(); ++i) {
    if (is_part(stroke)) {
      along.push_back(stroke[i].along);
    } else {
      along.push_back(i == 0 ? 0.0F
                             : along.back() + (stroke[i].position - stroke[i - 1].position).norm());
    }
  }
  return along;
}

/// Of the whole line, of which the stroke may be a part.
inline float whole_length(const Stroke& stroke, const std::vector<float>& along) {
  return is_part(stroke) ? stroke.front().along + stroke.front().rest : along.back();
}

/// A curve cut finely, without points between which it turns little: pieces become no longer than
/// `longest` and turn by 1/64 at most, which is little for fields whose lines bend between their
/// points. Where pressure does not change evenly, and at corners, points stay.
inline Stroke without_flat_points(const Stroke& curve, float longest) {
  constexpr float turn = 1.0F / 64.0F;
  constexpr float uneven = 1.0F / 512.0F;
  if (curve.size() < 3) return curve;
  Stroke out{curve.front()};
  const auto way = [&](std::size_t i) -> Vec2f {
    return curve[i + 1].position - curve[i].position;
  };
  const auto rate = [&](std::size_t i) {
    return (curve[i + 1].pressure - curve[i].pressure) / std::max(way(i).norm(), 1e-6F);
  };
  std::size_t first = 0;
  for (std::size_t i = 1; i + 1 < curve.size(); ++i) {
    const Vec2f from = way(first);
    const Vec2f next = way(i);
    const float size = from.norm() * next.norm();
    const float length = (curve[i + 1].position - out.back().position).norm();
    const bool flat = from.dot(next) > 0.0F && std::abs(cross(from, next)) <= turn * size;
    if (flat && std::abs(rate(i) - rate(first)) * length <= uneven && length <= longest) continue;
    out.push_back(curve[i]);
    first = i;
  }
  out.push_back(curve.back());
  return out;
}

/// The line that a stroke of this width follows, for options with `smooth` and `closed`.
template <class Options>
Stroke line_of(const Stroke& stroke, const Options& options) {
  if (!options.smooth || is_part(stroke)) return stroke;
  const float spacing = std::clamp(options.width / 8.0F, 1.0F, 3.0F);
  const StrokeEnds ends = options.closed ? StrokeEnds::Closed : StrokeEnds::Open;
  constexpr float longest = 64.0F;  // pixels, so that bends stay well below one
  return without_flat_points(smooth_stroke(stroke, spacing, ends),
                             std::min(options.width / 8.0F, longest));
}

}  // namespace normalshop
