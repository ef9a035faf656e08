#pragma once

#include <cstdint>
#include <vector>

#include "normalshop/surface/mesh.h"
#include "normalshop/surface/topology.h"

namespace normalshop {

/// One piece of a seam: an edge on the surface with two places in the atlas. Positions of a0 and
/// b0 are equal, and those of a1 and b1.
struct SeamEdge {
  std::uint32_t triangle_a;
  std::uint32_t triangle_b;
  std::uint32_t a0;  ///< corner indices, 3 * triangle + k
  std::uint32_t a1;
  std::uint32_t b0;
  std::uint32_t b1;
};

/// A seam at which both sides' base normals differ by this many degrees or more is a hard edge:
/// each side shows a surface of its own.
inline constexpr float hard_edge_degrees = 15.0F;

inline constexpr std::uint32_t no_chart = 0xFFFFFFFFU;

struct Seams {
  std::vector<SeamEdge> edges;                 ///< each once, triangle_a < triangle_b, by a0
  std::vector<std::uint32_t> open_edges;       ///< ascending, see topology.h for edge indices
  std::vector<std::uint32_t> irregular_edges;  ///< non-manifold or inconsistently turned
  /// Per triangle: the chart it belongs to (connected in the atlas), numbered in file order;
  /// no_chart for triangles with two corners in one place.
  std::vector<std::uint32_t> chart;
  std::uint32_t chart_count = 0;
};

Seams find_seams(const Topology& topology);
Seams find_seams(const Mesh& mesh);

}  // namespace normalshop
