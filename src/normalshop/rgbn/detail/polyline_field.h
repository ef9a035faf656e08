#pragma once

#include <cstdint>
#include <functional>
#include <optional>
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

  /// Takes those pixels of the cell that begins at (x, y).
  using Write = std::function<void(const Rect& pixels, int x, int y, const FieldCell& cell)>;
  /// Hands over every pixel of `region` once, in parallel. `grid` x `grid` positions a pixel are
  /// averaged. Cells begin at multiples of their side, whatever the region.
  void render(const Rect& region, int grid, const Write& write) const;
  /// The same of whole cells in which this field may be another than `before`, which has the same
  /// profile and height and no pattern.
  void render_changes(const PolylineField& before, const Rect& region, int grid,
                      const Write& write) const;

 private:
  static constexpr int tile_size = 64;
  /// Cells of cells.
  static constexpr int block_size = 32;
  /// Rows that share a list of the segments that may cross them.
  static constexpr float band_rows = 8.0F;
  using List = std::vector<std::uint32_t>;

  /// Some segments in a row, and a circle around them.
  struct Chunk {
    std::uint32_t first;
    std::uint32_t end;
    Vec2f center;
    float radius;
  };

  struct Shape {
    std::uint32_t first = 0;  ///< of its segments
    std::uint32_t end = 0;
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

  /// How a field differs from an earlier one.
  struct Changes {
    const PolylineField& before;
    std::vector<std::uint32_t> first;  ///< by shape: from this segment on they are others
    List gone;                         ///< segments that were others before
  };

  /// The squares that one is looking at within another, from tile to cell.
  struct Level {
    List segments;
    List gone;
  };
  /// What a task needs again and again.
  struct Task;

  void add(const FieldShape& shape);
  void add_contour(const std::vector<FieldVertex>& contour, bool closed);
  void fill_bands(Shape& shape, std::size_t first, float bottom) const;
  void grow_bounds(const LineSegment& segment, float half_width);
  std::vector<Chunk> chunks(std::size_t first) const;
  std::optional<Changes> changes_from(const PolylineField& before) const;
  void render(const Rect& region, int grid, const Changes* changes, const Write& write) const;
  void render_tile(const Rect& tile, Task& task) const;
  void render_cell(const Rect& square, Task& task) const;
  void render_far(const Rect& tile, Task& task) const;
  List near(const Rect& square) const;
  void prune(const List& segments, const Rect& cell, SegmentOffsets& offsets, List& kept) const;
  void prune_gone(const List& gone, const List& kept, const Rect& square, Task& task,
                  List& out) const;
  bool narrow(const Level& from, const Rect& square, Task& task, Level& to) const;
  void look_at(Cell& cell) const;
  void pixels(int x, int y, const Cell& cell, int grid, FieldCell& out) const;
  void sample(const LinePoints& points, const Cell& cell, FieldCell& field) const;
  FieldSample level(const Vec2f& p, const Shape& shape) const;
  void add_beside(const LinePoints& points, const Shape& shape, const LineList& list,
                  FieldCell& field) const;
  void turn_in(const LinePoints& points, const Shape& shape, LinePlaces& places) const;
  FieldSample patterned(const Shape& shape, const LinePlaces& places, std::size_t k) const;
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
