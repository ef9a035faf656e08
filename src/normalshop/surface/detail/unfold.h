#pragma once

#include "normalshop/surface/mesh.h"
#include "normalshop/surface/topology.h"

/// Triangles in a row laid into one plane, private to this floor. The plane is seen from inside the
/// surface, so that what lies beyond an edge is on its left.
namespace normalshop {

/// An edge of the triangle that is left through it, from its first corner to its second.
struct UnfoldedEdge {
  std::uint32_t edge;
  Vec2d first;
  Vec2d second;
};

/// Third corner of the triangle that has `edge` (from e.second to e.first), in the plane of e.
inline Vec2d unfold_apex(const Mesh& mesh, std::uint32_t edge, const UnfoldedEdge& e) {
  const Vec3d origin = mesh.position(next_corner(edge)).cast<double>();
  const Vec3d along = (mesh.position(edge).cast<double>() - origin).stableNormalized();
  const Vec3d apex = mesh.position(previous_corner(edge)).cast<double>() - origin;
  const double x = apex.dot(along);
  const double y = (apex - x * along).norm();
  const Vec2d axis = (e.second - e.first).stableNormalized();
  return e.first + x * axis + y * Vec2d(-axis.y(), axis.x());
}

}  // namespace normalshop
