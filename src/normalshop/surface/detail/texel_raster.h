#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "normalshop/surface/detail/texel_bands.h"

namespace normalshop {

/// A triangle in the atlas as ranges of texels, row by row: exactly the texels whose centre it
/// holds. A centre on an edge goes to the triangle right of or below it. Both triangles of a shared
/// edge compute the same crossing (from the edge's upper to its lower end), so that no texel is
/// lost or taken twice. Internal to the texel map.
class TexelTriangle {
 public:
  explicit TexelTriangle(std::array<Vec2d, 3> p) {
    std::sort(p.begin(), p.end(), [](const Vec2d& a, const Vec2d& b) { return a.y() < b.y(); });
    const Vec2d along = p[2] - p[0];
    const Vec2d middle = p[1] - p[0];
    middle_right_ = cross(along, middle) < 0.0;
    middle_y_ = p[1].y();
    rows_ = {first_centre(p[0].y()), first_centre(p[2].y())};
    whole_ = Edge(p[0], p[2]);
    upper_ = Edge(p[0], p[1]);
    lower_ = Edge(p[1], p[2]);
  }

  /// First index i with i + 0.5 >= x.
  static std::int64_t first_centre(double x) {
    return static_cast<std::int64_t>(std::ceil(x - 0.5));
  }

  const GridRange& rows() const { return rows_; }
  /// Columns of a row in rows(); may be empty or reversed.
  GridRange columns(std::int64_t row) const {
    const double y = static_cast<double>(row) + 0.5;
    const std::int64_t a = first_centre(whole_.crossing(y));
    const std::int64_t b = first_centre((y < middle_y_ ? upper_ : lower_).crossing(y));
    return middle_right_ ? GridRange{a, b} : GridRange{b, a};
  }

 private:
  struct Edge {
    Edge() = default;
    Edge(const Vec2d& top, const Vec2d& bottom) : origin(top) {
      if (bottom.y() > top.y()) slope = (bottom.x() - top.x()) / (bottom.y() - top.y());
    }
    double crossing(double y) const { return origin.x() + (y - origin.y()) * slope; }
    Vec2d origin{0.0, 0.0};
    double slope = 0.0;
  };

  GridRange rows_;
  Edge whole_;
  Edge upper_;
  Edge lower_;
  double middle_y_ = 0.0;
  bool middle_right_ = false;
};

}  // namespace normalshop
