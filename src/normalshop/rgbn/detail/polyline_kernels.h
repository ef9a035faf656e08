#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "normalshop/rgbn/detail/polyline_segment.h"

/// The inner loops of fields around polylines, eight pixels at a time. Private to this floor.
/// Positions are in pixels, y down.
namespace normalshop {

/// A value of each of eight points.
inline constexpr int line_lanes = 8;
template <class T>
using LineLanes = std::array<T, line_lanes>;

struct LinePoints {
  LineLanes<float> x;
  LineLanes<float> y;
};

enum class LinePlace : std::int32_t { Beyond, Beside, Cap };

/// Where points lie beside a line.
struct LinePlaces {
  LineLanes<LinePlace> place;
  LineLanes<std::int32_t> segment;  ///< that it is beside, or whose end is near
  LineLanes<float> at;              ///< where along the segment
  LineLanes<float> half_width;      ///< there
  LineLanes<float> distance;        ///< from the nearest place of the line
  LineLanes<float> x;  ///< away from the line, of length 1; at caps: from the end to the point
  LineLanes<float> y;
  LineLanes<float> side;     ///< 1 to the left, -1 to the right; of points beside
  LineLanes<float> along_x;  ///< gradient of the arc length; of points beside
  LineLanes<float> along_y;
};

/// Some segments, all of one shape.
struct LineList {
  std::span<const std::uint32_t> segments;
  float largest_half_width;  ///< of the shape
  bool even;                 ///< no width changes here and nobody asks for arc lengths: these are 0
  bool bends;                ///< some segment does
};

/// Places of points beside the segments of a list. Arc
/// lengths grow with directions that turn evenly along each segment instead of at its ends: the s
/// with (p - q(s)) . t(s) = 0. They are continuous beside a bend, where the nearest point jumps in
/// speed.
void line_places(const SegmentColumns& segments, const LineList& list, const LinePoints& points,
                 LinePlaces& out);

/// From the nearest places on a list's segments to a point.
struct SegmentOffsets {
  std::vector<float> x, y, squared;

  Vec2f at(std::size_t i) const { return {x[i], y[i]}; }
};

void segment_offsets(const SegmentColumns& segments, std::span<const std::uint32_t> list,
                     const Vec2f& point, SegmentOffsets& out);

}  // namespace normalshop
