#pragma once

#include "normalshop/surface/frames.h"
#include "normalshop/surface/mesh.h"
#include "normalshop/surface/topology.h"

namespace normalshop {

/// A straight way on the surface, given in the plane of the triangle that it leaves through `edge`.
struct SurfaceWalk {
  std::uint32_t edge = 0;  ///< edge index, see topology.h
  double start = 0.0;      ///< 0 to 1 along the edge
  /// Where to, seen from the edge's first corner: along the edge and beyond it, in object units.
  Vec2d target{0.0, 0.0};
};

/// The point at t of an edge, 0 to 1 along it.
SurfacePoint point_on_edge(std::uint32_t edge, double t);

/// The end of the way: triangles across edges are unfolded into one plane, over seams too. Stops on
/// an edge where nothing lies across, or only a triangle of another texture set, and after 256
/// triangles.
SurfacePoint walk(const Mesh& mesh, const Topology& topology, const SurfaceWalk& way);

}  // namespace normalshop
