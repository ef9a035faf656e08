#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "normalshop/core/image.h"
#include "normalshop/rgbn/detail/polyline_kernels.h"
#include "normalshop/rgbn/profile.h"

/// Height fields around polylines: what pen and emboss have in common. Private to this floor.
/// Positions are in pixels, y down.
namespace normalshop {

/// Between vertices half width and fade change linearly.
struct FieldVertex {
  Vec2f position;
  float half_width;
  float fade;           ///< multiplies the height, 0 to 1; 1 where the profile changes the level
  float along = -1.0F;  ///< arc length; below 0: as measured from the first vertex
  bool smooth = false;  ///< a point of a curve: pieces bend where they hardly turn
};

/// An open polyline, or closed contours that share one inside (winding number not 0).
struct FieldShape {
  std::vector<std::vector<FieldVertex>> contours;
  bool closed = false;
  float length = -1.0F;  ///< of the whole line, where the vertices have arc lengths
};

struct FieldSample {
  float height = 0.0F;
  Vec2f slope = Vec2f::Zero();  ///< y up
  float coverage = 0.0F;
};

enum class FieldCoverage { Band, Inside };

/// Where a point lies beside a line: the coordinates (u, v) of thesis 2.4.1 and their gradients.
struct FieldPlace {
  float u;              ///< signed distance / half width, positive to the left or inside
  float v;              ///< arc length from the line's start
  float length;         ///< of the whole line
  float half_width;     ///< here
  float width_change;   ///< of the half width along v
  Vec2f grad_distance;  ///< of the signed distance; y down, as that of v
  Vec2f grad_v;
};
/// What a pattern makes of a place; the sample's height says which of several lines counts.
using FieldPattern = std::function<FieldSample(const FieldPlace&)>;

class PolylineField {
 public:
  PolylineField(const std::vector<FieldShape>& shapes, const Profile& profile, float height,
                FieldCoverage coverage);
  /// A pattern along lines with cut ends, instead of a profile.
  PolylineField(const std::vector<FieldShape>& shapes, FieldPattern pattern);
  PolylineField(const PolylineField&) = delete;
  PolylineField& operator=(const PolylineField&) = delete;

  /// Pixels outside of which slopes and coverage are 0 (and the height too).
  const Rect& bounds() const { return bounds_; }

  /// Samples of the pixels (x, y), (x + 1, y) ... of a part of one row.
  using Write = std::function<void(int x, int y, std::span<const FieldSample>)>;
  /// Hands over every pixel of `region` once, in parallel. `grid` x `grid` positions a pixel are
  /// averaged.
  void render(const Rect& region, int grid, const Write& write) const;

 private:
  static constexpr int tile_size = 64;
  /// Rows that share a list of the segments that may cross them.
  static constexpr float band_rows = 8.0F;
  using List = std::vector<std::uint32_t>;
  using Samples = LineLanes<FieldSample>;

  /// Some segments in a row, and a circle around them.
  struct Chunk {
    std::uint32_t first;
    std::uint32_t end;
    Vec2f center;
    float radius;
  };

  struct Shape {
    bool closed = false;
    float length = 0.0F;
    float largest_half_width = 0.0F;
    float orientation = 1.0F;  ///< 1: inside is to the left
    float top = 0.0F;
    std::vector<Chunk> chunks;
    std::vector<List> bands;  ///< of segments by rows, for winding numbers
  };

  /// What matters in a few pixels by a few.
  struct Cell {
    List segments;
    bool even = false;   ///< all of them, and where along them doesn't matter
    bool bends = false;  ///< any of them
  };

  void add(const FieldShape& shape);
  void add_contour(const std::vector<FieldVertex>& contour, bool closed);
  void fill_bands(Shape& shape, std::size_t first, float bottom) const;
  void grow_bounds(const LineSegment& segment, float half_width);
  std::vector<Chunk> chunks(std::size_t first) const;
  void render_tile(const Rect& tile, int grid, const Write& write) const;
  List near(const Rect& square) const;
  void prune(const List& segments, const Rect& cell, SegmentOffsets& offsets, List& kept) const;
  void look_at(Cell& cell) const;
  Samples pixels(int x, int y, const Cell& cell, int grid) const;
  Samples sample(const LinePoints& points, const Cell& cell) const;
  Samples levels(const LinePoints& points, const Shape& shape) const;
  FieldSample level(const Vec2f& p, const Shape& shape) const;
  Samples beside(const LinePoints& points, const Shape& shape, const LineList& list) const;
  void turn_in(const Vec2f& p, const Shape& shape, std::size_t k, LinePlaces& places) const;
  FieldSample profiled(const LinePlaces& places, std::size_t k) const;
  FieldSample patterned(const Shape& shape, const LinePlaces& places, std::size_t k) const;
  FieldSample cap(const LinePlaces& places, std::size_t k) const;
  float coverage(float u, float fade) const;
  bool inside(const Vec2f& p, const Shape& shape) const;
  const LineSegment& segment_of(const LinePlaces& places, std::size_t k) const {
    return segments_[static_cast<std::size_t>(places.segment[k])];
  }

  Profile profile_;
  FieldPattern pattern_;
  float height_;
  FieldCoverage coverage_;
  std::vector<LineSegment> segments_;
  SegmentColumns columns_;  // of the same
  std::vector<Shape> shapes_;
  Rect bounds_;
};

}  // namespace normalshop
