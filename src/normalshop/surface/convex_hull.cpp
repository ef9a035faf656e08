#include "normalshop/surface/detail/convex_hull.h"

#include <algorithm>

namespace normalshop::unwrapping {

std::vector<Vec2d> convex_hull(std::vector<Vec2d> points) {
  std::sort(points.begin(), points.end(), [](const Vec2d& a, const Vec2d& b) {
    return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y());
  });
  std::vector<Vec2d> hull;
  const auto add = [&](const Vec2d& p, std::size_t least) {
    while (hull.size() > least &&
           cross(Vec2d(hull.back() - hull[hull.size() - 2]), Vec2d(p - hull.back())) <= 0.0) {
      hull.pop_back();
    }
    hull.push_back(p);
  };
  for (const Vec2d& p : points) add(p, 1);
  const std::size_t lower = hull.size();
  for (std::size_t i = points.size(); i-- > 1;) add(points[i - 1], lower);
  if (hull.size() > 1) hull.pop_back();
  return hull;
}

double polygon_area(const std::vector<Vec2d>& corners) {
  double twice = 0.0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    twice += cross(corners[i], corners[(i + 1) % corners.size()]);
  }
  return 0.5 * twice;
}

}  // namespace normalshop::unwrapping
