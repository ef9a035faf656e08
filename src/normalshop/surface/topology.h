#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "normalshop/surface/mesh.h"

namespace normalshop {

/// Edge 3 t + k of triangle t runs from its corner k to its corner (k + 1) % 3, so an edge has the
/// index of its first corner.
inline constexpr std::uint32_t no_edge = 0xFFFFFFFFU;

constexpr std::uint32_t next_corner(std::uint32_t corner) {
  return corner % 3 == 2 ? corner - 2 : corner + 1;
}
constexpr std::uint32_t previous_corner(std::uint32_t corner) {
  return corner % 3 == 0 ? corner + 2 : corner - 1;
}

enum class EdgeKind : std::uint8_t {
  Interior,   ///< the neighbour has the same UVs along the edge and the same texture set
  Seam,       ///< the neighbour's UVs or texture set differ
  Open,       ///< no neighbour
  Degenerate  ///< of a triangle with two corners in one place, which has no neighbours
};

/// How triangles hang together. Corners are one vertex when their positions are equal as numbers,
/// whatever the file's indices and the other attributes say.
struct Topology {
  std::uint32_t vertex_count = 0;
  std::vector<std::uint32_t> vertex;    ///< per corner, numbered in order of first use
  std::vector<std::uint32_t> neighbor;  ///< per edge: the same edge of the triangle across, in the
                                        ///< opposite direction, or no_edge
  std::vector<EdgeKind> kind;           ///< per edge
  /// Edges that more than two triangles share, or two in the same direction; ascending. Such edges
  /// are paired, as far as they can be, in file order, those with equal UVs first (where no more
  /// than 32 lie on each other).
  std::vector<std::uint32_t> irregular_edges;
};

/// Per corner, its vertex, as in Topology.
struct Welding {
  std::uint32_t vertex_count = 0;
  std::vector<std::uint32_t> vertex;
};
Welding weld_positions(const Mesh& mesh);

/// Linear in the size of the mesh. Without UVs every edge with a neighbour in the same texture set
/// is Interior.
Topology make_topology(const Mesh& mesh);

/// Corners of each vertex in ascending order: corners[start[v]] .. corners[start[v + 1] - 1].
struct CornerLists {
  std::vector<std::uint32_t> start;
  std::vector<std::uint32_t> corners;
  std::span<const std::uint32_t> of(std::size_t vertex) const {
    return std::span(corners).subspan(start[vertex], start[vertex + 1] - start[vertex]);
  }
};
CornerLists corners_of_vertices(std::span<const std::uint32_t> vertex, std::uint32_t vertex_count);

/// Whether two edges should rather be paired with each other than with a third.
using PreferPair = std::function<bool(std::uint32_t, std::uint32_t)>;

/// Neighbour of every edge, by the vertices of the corners: the k-th edge from v to w with the k-th
/// from w to v. Triangles with two equal vertices take no part. `irregular`, when given, gets the
/// edges of groups that are neither one edge nor two opposite ones.
std::vector<std::uint32_t> pair_edges(std::span<const std::uint32_t> vertex,
                                      std::uint32_t vertex_count, const PreferPair& prefer = {},
                                      std::vector<std::uint32_t>* irregular = nullptr);

}  // namespace normalshop
