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

inline double edge_side(const Vec2d& a, const Vec2d& b, const Vec2d& p) {
  return ((b.x() - a.x()) * (p.y() - a.y()) - (b.y() - a.y()) * (p.x() - a.x())) / (b - a).norm();
}

/// visit(x, y) for points that are inside by more than 1e-4 of a point's distance.
template <class Visit>
void for_each_point_inside(const Mesh& mesh, std::size_t triangle, int size, const Visit& visit) {
  Vec2d p[3];
  for (std::size_t k = 0; k < 3; ++k) p[k] = mesh.uvs[3 * triangle + k].cast<double>() * size;
  if (edge_side(p[0], p[1], p[2]) < 0.0) std::swap(p[1], p[2]);
  const auto first = [&](int axis) {
    return std::max(0, static_cast<int>(std::min({p[0][axis], p[1][axis], p[2][axis]})));
  };
  const auto last = [&](int axis) {
    return std::min(size - 1, static_cast<int>(std::max({p[0][axis], p[1][axis], p[2][axis]})));
  };
  for (int y = first(1); y <= last(1); ++y) {
    for (int x = first(0); x <= last(0); ++x) {
      const Vec2d at(x + 0.5, y + 0.5);
      const double depth = std::min(
          {edge_side(p[0], p[1], at), edge_side(p[1], p[2], at), edge_side(p[2], p[0], at)});
      if (depth > 1e-4) visit(x, y);
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
