#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "normalshop/core/vec.h"

/// Private to this floor.
namespace normalshop {

/// A piece of a polyline, in pixels, y down. With bends it is a piece of a curve: the cubic through
/// a and b that leaves and comes in these directions.
struct LineSegment {
  Vec2f a, b;
  Vec2f direction;
  float length;
  float start;  ///< arc length of a
  float rate;   ///< of arc length along the segment
  float half_width, half_width_rate;
  float fade, fade_rate;
  Vec2f start_tangent, end_tangent;  ///< mean direction at the joints
  float start_bend = 0.0F;           ///< slope across the direction, positive clockwise as seen
  float end_bend = 0.0F;
  bool start_cap = false;
  bool end_cap = false;
  bool bends() const { return start_bend != 0.0F || end_bend != 0.0F; }
  bool even = false;  ///< neither width nor fade changes along this and its neighbours
  std::uint32_t shape = 0;
  std::ptrdiff_t previous = 0;  ///< from this to its neighbours in the list of segments
  std::ptrdiff_t next = 0;
};

/// What kernels take from segments, by columns.
struct SegmentColumns {
  std::vector<float> ax, ay, dx, dy, length;
  std::vector<float> share;                           ///< that a pixel has of the length
  std::vector<float> start_x, start_y, end_x, end_y;  ///< tangents
  std::vector<float> start_bend, end_bend;
  std::vector<float> half_width, half_width_rate;
  std::vector<float> fade, fade_rate;
  std::vector<std::int32_t> start_cap, end_cap, even;  ///< -1: yes
  std::vector<std::int32_t> previous, next;

  void append(const LineSegment& segment);
  /// After the last one: room for kernels to read beyond it.
  void pad();
  /// Is segment i, bit for bit, what segment k of the others is?
  bool same(std::size_t i, const SegmentColumns& others, std::size_t k) const;
};

}  // namespace normalshop
