#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "normalshop/surface/mesh.h"

/// Looks at an atlas in the plainest way, as a picture of points, without what the library has for
/// it.
namespace normalshop::test {

/// What a picture of size x size points sees of a mesh's UVs.
struct AtlasPicture {
  std::vector<std::uint32_t> count;  ///< triangles that hold the point well inside
  std::size_t covered = 0;
  std::size_t overlapping = 0;
};

/// A line's distance of points on its left, in plain numbers: sanitizers make vectors slow.
struct EdgeSide {
  double x;
  double y;
  double at_origin;
  EdgeSide(double ax, double ay, double bx, double by) {
    const double length = std::sqrt((bx - ax) * (bx - ax) + (by - ay) * (by - ay));
    x = -(by - ay) / length;
    y = (bx - ax) / length;
    at_origin = -(x * ax + y * ay);
  }
  double at(double px, double py) const { return x * px + y * py + at_origin; }
};

/// visit(x, y) for points that are inside by more than 1e-4 of a point's distance.
template <class Visit>
void for_each_point_inside(const Mesh& mesh, std::size_t triangle, int size, const Visit& visit) {
  double px[3];
  double py[3];
  for (std::size_t k = 0; k < 3; ++k) {
    px[k] = static_cast<double>(mesh.uvs[3 * triangle + k].x()) * size;
    py[k] = static_cast<double>(mesh.uvs[3 * triangle + k].y()) * size;
  }
  if (EdgeSide(px[0], py[0], px[1], py[1]).at(px[2], py[2]) < 0.0) {
    std::swap(px[1], px[2]);
    std::swap(py[1], py[2]);
  }
  const EdgeSide a(px[0], py[0], px[1], py[1]);
  const EdgeSide b(px[1], py[1], px[2], py[2]);
  const EdgeSide c(px[2], py[2], px[0], py[0]);
  const auto first = [](const double* p) {
    return std::max(0, static_cast<int>(std::min({p[0], p[1], p[2]})));
  };
  const auto last = [&](const double* p) {
    return std::min(size - 1, static_cast<int>(std::max({p[0], p[1], p[2]})));
  };
  const int x1 = last(px);
  const int y1 = last(py);
  for (int y = first(py); y <= y1; ++y) {
    for (int x = first(px); x <= x1; ++x) {
      const double at_x = x + 0.5;
      const double at_y = y + 0.5;
      if (a.at(at_x, at_y) > 1e-4 && b.at(at_x, at_y) > 1e-4 && c.at(at_x, at_y) > 1e-4) {
        visit(x, y);
      }
    }
  }
}

inline AtlasPicture picture_of_atlas(const Mesh& mesh, int size) {
  AtlasPicture picture;
  const auto side = static_cast<std::size_t>(size);
  picture.count.assign(side * side, 0);
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    for_each_point_inside(mesh, t, size, [&](int x, int y) {
      ++picture.count[static_cast<std::size_t>(y) * side + static_cast<std::size_t>(x)];
    });
  }
  for (const std::uint32_t count : picture.count) {
    picture.covered += count > 0 ? 1 : 0;
    picture.overlapping += count > 1 ? 1 : 0;
  }
  return picture;
}

/// Signed area in the map, positive where it is not mirrored (v runs down).
inline double atlas_area(const Mesh& mesh, std::size_t triangle) {
  const Vec2d a = mesh.uvs[3 * triangle].cast<double>();
  const Vec2d u = mesh.uvs[3 * triangle + 1].cast<double>() - a;
  const Vec2d v = mesh.uvs[3 * triangle + 2].cast<double>() - a;
  return -0.5 * (u.x() * v.y() - u.y() * v.x());
}

inline double surface_area(const Mesh& mesh, std::size_t triangle) {
  const Vec3d a = mesh.position(3 * triangle).cast<double>();
  const Vec3d u = mesh.position(3 * triangle + 1).cast<double>() - a;
  const Vec3d v = mesh.position(3 * triangle + 2).cast<double>() - a;
  const Vec3d w(u.y() * v.z() - u.z() * v.y(), u.z() * v.x() - u.x() * v.z(),
                u.x() * v.y() - u.y() * v.x());
  return 0.5 * w.norm();
}

/// Area-weighted mean of max(r, 1 / r), r the density relative to the mean one.
inline double mean_area_stretch(const Mesh& mesh) {
  double shown = 0.0;
  double area = 0.0;
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    shown += atlas_area(mesh, t);
    area += surface_area(mesh, t);
  }
  double sum = 0.0;
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    const double own = surface_area(mesh, t);
    const double ratio = atlas_area(mesh, t) / own * (area / shown);
    if (own > 0.0 && ratio > 0.0) sum += own * std::max(ratio, 1.0 / ratio);
  }
  return sum / area;
}

}  // namespace normalshop::test
