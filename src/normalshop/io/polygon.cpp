#include "normalshop/io/detail/polygon.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <Eigen/Geometry>

namespace normalshop {

namespace {

using Triangles = std::vector<std::array<int, 3>>;

Vec3d area_vector(std::span<const Vec3f> p) {
  Vec3d sum = Vec3d::Zero();
  const Vec3d origin = p[0].cast<double>();
  for (std::size_t i = 1; i + 1 < p.size(); ++i) {
    sum += (p[i].cast<double>() - origin).cross(p[i + 1].cast<double>() - origin);
  }
  return sum;
}

bool uses_first_diagonal(std::span<const Vec3f> p, std::span<const Vec2f> uvs) {
  // A half that turns the other way lies outside the quad.
  const Vec3d area = area_vector(p);
  const auto turns_back = [&](std::size_t a, std::size_t b, std::size_t c) {
    const Vec3d origin = p[a].cast<double>();
    return (p[b].cast<double>() - origin).cross(p[c].cast<double>() - origin).dot(area) < 0.0;
  };
  const bool first_outside = turns_back(0, 1, 2) || turns_back(0, 2, 3);
  const bool second_outside = turns_back(0, 1, 3) || turns_back(1, 2, 3);
  if (first_outside != second_outside) return second_outside;
  const float uv_first = (uvs[2] - uvs[0]).squaredNorm();
  const float uv_second = (uvs[3] - uvs[1]).squaredNorm();
  if (uv_first != uv_second) return uv_first < uv_second;
  return (p[2] - p[0]).squaredNorm() <= (p[3] - p[1]).squaredNorm();
}

/// Plain numbers: what crafted polygons wait for, above all under sanitizers.
struct Point {
  double x;
  double y;
  bool operator==(const Point&) const = default;
};

/// Twice the area of a, b, p: above 0 where p lies left of the edge from a to b.
double side(const Point& a, const Point& b, const Point& p) {
  return (b.x - a.x) * (p.y - b.y) - (b.y - a.y) * (p.x - b.x);
}

/// Corners in a ring of those that are left.
class EarClipper {
 public:
  explicit EarClipper(std::span<const Vec3f> positions) : size_(positions.size()) {
    const Vec3d normal = area_vector(positions);
    Eigen::Index axis = 0;
    normal.cwiseAbs().maxCoeff(&axis);
    const double sign = normal[axis] < 0.0 ? -1.0 : 1.0;
    for (std::size_t i = 0; i < size_; ++i) {
      const Vec3d p = positions[i].cast<double>();
      points_.push_back({sign * p[(axis + 1) % 3], p[(axis + 2) % 3]});
      before_.push_back(i == 0 ? size_ - 1 : i - 1);
      after_.push_back(i + 1 == size_ ? 0 : i + 1);
    }
    const std::size_t tested = std::min(size_, largest_tested);
    patience_ = 64 * size_ + 4 * tested * tested;
  }

  Triangles run() {
    Triangles triangles;
    while (size_ > 3) {
      const std::size_t ear = find_ear();
      triangles.push_back(triangle(ear));
      after_[before_[ear]] = after_[ear];
      before_[after_[ear]] = before_[ear];
      --size_;
      next_ = ear == first_ ? after_[ear] : before_[ear];
      if (ear == first_) first_ = after_[ear];
    }
    triangles.push_back(triangle(after_[first_]));
    return triangles;
  }

 private:
  static constexpr std::size_t largest_tested = 4096;

  std::array<int, 3> triangle(std::size_t i) const {
    return {static_cast<int>(before_[i]), static_cast<int>(i), static_cast<int>(after_[i])};
  }

  double turn(std::size_t i) const {
    return side(points_[before_[i]], points_[i], points_[after_[i]]);
  }

  /// Counts what it looks at as steps.
  bool is_ear(std::size_t i, std::size_t& steps) const {
    if (!(turn(i) > 0.0)) return false;
    const Point a = points_[before_[i]];
    const Point b = points_[i];
    const Point c = points_[after_[i]];
    for (std::size_t k = after_[after_[i]]; k != before_[i]; k = after_[k], ++steps) {
      const Point p = points_[k];
      if (p == a || p == b || p == c) continue;
      if (side(a, b, p) >= 0.0 && side(b, c, p) >= 0.0 && side(c, a, p) >= 0.0) return false;
    }
    return true;
  }

  /// A self-crossing polygon may have none: then its most convex corner, as far as patience goes.
  std::size_t find_ear() {
    std::size_t best = next_;
    double best_turn = -INFINITY;
    std::size_t i = next_;
    for (std::size_t k = 0; k < size_; ++k, i = after_[i]) {
      std::size_t steps = 1;
      // Very large polygons: what is left of quadratic time is not worth the wait.
      const bool ear = size_ <= largest_tested ? is_ear(i, steps) : turn(i) > 0.0;
      patience_ -= std::min(patience_, steps);
      if (ear) return i;
      if (turn(i) > best_turn) best = i, best_turn = turn(i);
      if (patience_ == 0) break;
    }
    return best;
  }

  std::vector<Point> points_;
  std::vector<std::size_t> before_;
  std::vector<std::size_t> after_;
  std::size_t size_;
  std::size_t first_ = 0;
  std::size_t next_ = 0;
  std::size_t patience_ = 0;  ///< steps until any corner will do: crafted polygons end too
};

}  // namespace

Triangles triangulate(std::span<const Vec3f> positions, std::span<const Vec2f> uvs) {
  if (positions.size() < 3) return {};
  if (positions.size() == 3) return {{0, 1, 2}};
  if (positions.size() > 4) return EarClipper(positions).run();
  if (uses_first_diagonal(positions, uvs)) return {{0, 1, 2}, {0, 2, 3}};
  return {{0, 1, 3}, {1, 2, 3}};
}

}  // namespace normalshop
