#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "normalshop/core/image.h"
#include "normalshop/rgbn/detail/polyline_segment.h"
#include "normalshop/rgbn/profile.h"

/// The inner loops of fields around polylines, for a square cell of pixels at a time. Private to
/// this floor. Positions are in pixels, y down.
namespace normalshop {

inline constexpr int cell_side = 8;
/// Values that a kernel works on at once.
inline constexpr std::size_t most_lanes = 16;
/// A value of each of a cell's pixels, row after row.
template <class T>
struct alignas(64) CellLanes : std::array<T, cell_side * cell_side> {};

struct LinePoints {
  CellLanes<float> x;
  CellLanes<float> y;
};

/// What a place is; beyond the line there is nothing.
inline constexpr std::int32_t line_beyond = 0;
inline constexpr std::int32_t line_beside = 1;
inline constexpr std::int32_t line_cap = 2;

/// Where points lie beside a line.
struct LinePlaces {
  CellLanes<std::int32_t> place;
  CellLanes<std::int32_t> segment;  ///< that it is beside, or whose end is near
  CellLanes<float> at;              ///< where along the segment
  CellLanes<float> half_width;      ///< there
  CellLanes<float> distance;        ///< from the nearest place of the line
  CellLanes<float> x;  ///< away from the line, of length 1; at caps: from the end to the point
  CellLanes<float> y;
  CellLanes<float> side;     ///< 1 to the left, -1 to the right; of points beside
  CellLanes<float> along_x;  ///< gradient of the arc length; of points beside
  CellLanes<float> along_y;
};

/// Some segments, all of one shape.
struct LineList {
  std::span<const std::uint32_t> segments;
  float largest_half_width;  ///< of the shape
  bool even;                 ///< no width changes here and nobody asks for arc lengths: these are 0
  bool bends;                ///< some segment does
};

/// Places of points beside the segments of a list. Arc lengths grow with directions that turn
/// evenly along each segment instead of at its ends: the s with (p - q(s)) . t(s) = 0. They are
/// continuous beside a bend, where the nearest point jumps in speed.
void line_places(const SegmentColumns& segments, const LineList& list, const LinePoints& points,
                 LinePlaces& out);

/// What a field is at a cell's pixels.
struct FieldCell {
  CellLanes<float> height;
  CellLanes<float> slope_x;
  CellLanes<float> slope_y;  ///< up
  CellLanes<float> coverage;
};

/// Over a band beside the line, or over all that it encloses; 0 where nobody asks for it.
enum class FieldCoverage { None, Band, Inside };

/// Slope jumps of profiles are spread over this many pixels on each side, but not over more of the
/// profile than this share.
inline constexpr float jump_radius = 1.5F;
inline constexpr float largest_jump_share = 0.25F;

/// A field with a profile across lines.
struct LineProfile {
  const Profile& profile;
  float height;
  FieldCoverage coverage;
};

/// Adds the field at places beside a line and at its round ends, where the odd part of the profile
/// turns over smoothly from one side to the other, h = even(d) + sin(angle) odd(d): where its
/// |height| is larger it counts, and the larger coverage. `even`: all segments are, as in LineList.
void add_line(const SegmentColumns& segments, const LineProfile& profile, bool even,
              const LinePlaces& places, FieldCell& field);

/// Puts pixels of a field's cell that begins at (x, y) into images; coverage may be empty.
void write_cell(const Rect& pixels, int x, int y, const FieldCell& cell, SlopeSpan details,
                MaskSpan coverage);

/// From the nearest places on a list's segments to a point.
struct SegmentOffsets {
  std::vector<float> x, y, squared;

  Vec2f at(std::size_t i) const { return {x[i], y[i]}; }
};

void segment_offsets(const SegmentColumns& segments, std::span<const std::uint32_t> list,
                     const Vec2f& point, SegmentOffsets& out);

struct Circle {
  Vec2f center;
  float radius;
};

/// Appends those of a list, all of one shape, that can be the nearest anywhere in the circle,
/// unless all are further away than a half width. The gradient of a distance d to a segment turns
/// by at most 1 / d a pixel: seen from afar, the difference of two distances changes little within
/// the circle.
void nearest_segments(const SegmentColumns& segments, std::span<const std::uint32_t> list,
                      const Circle& circle, float half_width, SegmentOffsets& offsets,
                      std::vector<std::uint32_t>& kept);

}  // namespace normalshop
