#include "normalshop/surface/geodesic.h"

#include <cassert>
#include <string>

#include "normalshop/core/error.h"
#include "normalshop/surface/detail/strip.h"
#include "normalshop/surface/surface_walk.h"

namespace normalshop {

namespace {

Vec3d place_of(const Mesh& mesh, const SurfacePoint& point) {
  return position_at(mesh, point).cast<double>();
}

/// Appends a point; the later one stays where two are one place, as its triangle is that of what
/// follows.
void add_point(const SurfacePoint& point, const Vec3d& position, SurfacePath& path) {
  const double step = path.points.empty() ? 0.0 : (position - path.positions.back()).norm();
  // Edges that meet in a vertex are crossed in one place, but for rounding, and weights are floats.
  constexpr double rounding = 1e-7;
  if (!path.points.empty() && !(step > rounding * position.cwiseAbs().maxCoeff())) {
    path.points.back() = point;
    return;
  }
  path.points.push_back(point);
  path.lengths.push_back(path.length() + step);
  path.positions.push_back(position);
}

Vec3d place_on_edge(const Mesh& mesh, std::uint32_t edge, double t) {
  return (1.0 - t) * mesh.position(edge).cast<double>() +
         t * mesh.position(next_corner(edge)).cast<double>();
}

void add_leg(const Mesh& mesh, const Crossings& crossings, const SurfacePoint& start,
             const SurfacePoint& end, SurfacePath& path) {
  Strip strip{start, end, {}};
  if (!find_strip(mesh, crossings, strip)) {
    const std::size_t from = path.given.size() - 1;
    throw InvalidInput("no way on the surface leads from point " + std::to_string(from) +
                       " to point " + std::to_string(from + 1) +
                       ": both must lie on one connected part of the model");
  }
  const StripPath way = straighten(mesh, crossings, strip);
  path.points.back() = start;
  for (std::size_t i = 0; i < strip.edges.size(); ++i) {
    const double t = way.crossings[i];
    add_point(point_on_edge(crossings.across(strip.edges[i]), 1.0 - t),
              place_on_edge(mesh, strip.edges[i], t), path);
  }
  add_point(end, place_of(mesh, end), path);
}

}  // namespace

SurfacePath geodesic(const Mesh& mesh, const Topology& topology,
                     std::span<const SurfacePoint> points) {
  if (points.empty()) throw InvalidInput("a way on the surface needs at least one point");
  const Crossings crossings(topology);
  SurfacePath path;
  for (const SurfacePoint& point : points) {
    assert(point.triangle < mesh.triangle_count());
    if (path.points.empty()) {
      add_point(point, place_of(mesh, point), path);
    } else {
      add_leg(mesh, crossings, *(&point - 1), point, path);
    }
    path.given.push_back(path.points.size() - 1);
  }
  return path;
}

}  // namespace normalshop
