#pragma once

#include <span>
#include <vector>

#include "normalshop/surface/frames.h"
#include "normalshop/surface/topology.h"

namespace normalshop {

/// A way on the surface in straight pieces. Piece i leads from points[i] to points[i + 1] and lies
/// in the triangle of points[i]; no piece is empty, unless the whole way is one point.
struct SurfacePath {
  std::vector<SurfacePoint> points;  ///< where it crosses edges, and the given points
  std::vector<Vec3d> positions;      ///< of the points
  std::vector<double> lengths;       ///< of the way up to each point, in object units
  std::vector<std::size_t> given;    ///< which of the points are the ones asked for, in order

  double length() const { return lengths.empty() ? 0.0 : lengths.back(); }
};

/// The straight way on the surface through several points: from each to the next a geodesic, which
/// no small change shortens. It crosses seams of the atlas, but no open edge and none that more
/// than two triangles share; beside these it bends where it must. One point gives itself.
///
/// A first way along the midpoints of edges (A*) is straightened: the triangles that it runs
/// through are laid into a plane, the shortest way through them is found (the funnel algorithm, Lee
/// and Preparata 1984), and where that bends around a vertex with an angle below pi on its other
/// side, it goes round there instead, until it does so nowhere. That is the result of FlipOut
/// (Sharp and Crane 2020) in strips of triangles instead of intrinsic edges. Where several such
/// ways exist, the first one decides; it is not always the shortest of all.
///
/// Throws InvalidInput without points, and where no way leads from one to the next: it must not lie
/// in a triangle with two corners in one place, either (see nearest_surface_point()).
SurfacePath geodesic(const Mesh& mesh, const Topology& topology,
                     std::span<const SurfacePoint> points);

}  // namespace normalshop
