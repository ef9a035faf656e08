#pragma once

#include <vector>

#include "normalshop/core/rect.h"
#include "normalshop/rgbn/stroke.h"

/// Strokes by arc length, internal to rgbn.
namespace normalshop {

/// A polyline, or with `closed` the outline of a polygon. At least one point.
class PolylineByLength {
 public:
  PolylineByLength(const Stroke& stroke, bool closed);

  double length() const { return lengths_.back(); }
  /// The point at a part (0 to 1) of the length; of an outline, parts count on.
  Vec2d at(double part) const;
  /// Positive when it runs clockwise as seen (y down); of an outline.
  double enclosed_area() const;
  /// The pixels around it.
  Rect bounds() const;
  /// Inside by the winding number; of an outline.
  bool has_inside(const Vec2d& p) const;
  /// To the nearest point on it.
  double distance(const Vec2d& p) const;
  /// Points inside that are `depth` away from it, about `spacing` apart; of an outline. None where
  /// it is narrower than that.
  std::vector<Vec2d> inset(double depth, double spacing) const;

 private:
  bool closed_;
  std::vector<Vec2d> points_;    ///< of an outline, the first again at the end
  std::vector<double> lengths_;  ///< up to each point
};

/// Which part of a source outline belongs to a part of the target outline.
struct OutlineMatch {
  double shift = 0.0;
  bool reversed = false;
  double source_part(double target_part) const {
    return reversed ? shift - target_part : shift + target_part;
  }
};

/// The direction and start that bring the outlines closest, compared about their centres at `count`
/// points, the start to an eighth of their distance.
OutlineMatch match_outlines(const PolylineByLength& source, const PolylineByLength& target,
                            int count);

}  // namespace normalshop
