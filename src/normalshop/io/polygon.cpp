#include "normalshop/io/detail/polygon.h"

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

double cross(const Vec2d& a, const Vec2d& b) { return a.x() * b.y() - a.y() * b.x(); }

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

class EarClipper {
 public:
  explicit EarClipper(std::span<const Vec3f> positions) {
    const Vec3d normal = area_vector(positions);
    Eigen::Index axis = 0;
    normal.cwiseAbs().maxCoeff(&axis);
    const double sign = normal[axis] < 0.0 ? -1.0 : 1.0;
    for (std::size_t i = 0; i < positions.size(); ++i) {
      const Vec3d p = positions[i].cast<double>();
      points_.emplace_back(sign * p[(axis + 1) % 3], p[(axis + 2) % 3]);
      left_.push_back(static_cast<int>(i));
    }
  }

  Triangles run() {
    Triangles triangles;
    while (left_.size() > 3) {
      const std::size_t ear = find_ear();
      const std::size_t n = left_.size();
      triangles.push_back({left_[(ear + n - 1) % n], left_[ear], left_[(ear + 1) % n]});
      left_.erase(left_.begin() + static_cast<std::ptrdiff_t>(ear));
      next_ = ear == 0 ? 0 : ear - 1;
    }
    triangles.push_back({left_[0], left_[1], left_[2]});
    return triangles;
  }

 private:
  const Vec2d& point(std::size_t i) const {
    return points_[static_cast<std::size_t>(left_[i % left_.size()])];
  }

  double turn(std::size_t i) const {
    const std::size_t n = left_.size();
    return cross(point(i) - point(i + n - 1), point(i + 1) - point(i));
  }

  bool is_ear(std::size_t i) const {
    if (!(turn(i) > 0.0)) return false;
    const std::size_t n = left_.size();
    const Vec2d& a = point(i + n - 1);
    const Vec2d& b = point(i);
    const Vec2d& c = point(i + 1);
    for (std::size_t k = 2; k + 1 < n; ++k) {
      const Vec2d& p = point(i + k);
      if (p == a || p == b || p == c) continue;
      if (cross(b - a, p - a) >= 0.0 && cross(c - b, p - b) >= 0.0 && cross(a - c, p - c) >= 0.0) {
        return false;
      }
    }
    return true;
  }

  /// A self-crossing polygon may have none: then its most convex corner.
  std::size_t find_ear() const {
    const std::size_t n = left_.size();
    std::size_t best = 0;
    double best_turn = -INFINITY;
    for (std::size_t k = 0; k < n; ++k) {
      const std::size_t i = (next_ + k) % n;
      // Very large polygons: what is left of quadratic time is not worth the wait.
      if (n <= 4096 ? is_ear(i) : turn(i) > 0.0) return i;
      if (turn(i) > best_turn) best = i, best_turn = turn(i);
    }
    return best;
  }

  std::vector<Vec2d> points_;
  std::vector<int> left_;
  std::size_t next_ = 0;
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
