#include "normalshop/surface/seams.h"

#include <algorithm>
#include <cstddef>
#include <numeric>

namespace normalshop {
namespace {

std::uint32_t root_of(std::vector<std::uint32_t>& parent, std::uint32_t i) {
  while (parent[i] != i) {
    parent[i] = parent[parent[i]];
    i = parent[i];
  }
  return i;
}

void number_charts(const Topology& topology, Seams& seams) {
  std::vector<std::uint32_t> parent(topology.vertex.size() / 3);
  std::iota(parent.begin(), parent.end(), 0U);
  for (std::uint32_t edge = 0; edge < topology.neighbor.size(); ++edge) {
    if (topology.kind[edge] != EdgeKind::Interior) continue;
    const std::uint32_t a = root_of(parent, edge / 3);
    const std::uint32_t b = root_of(parent, topology.neighbor[edge] / 3);
    // The smaller index stays the root, so that charts are numbered in file order.
    parent[std::max(a, b)] = std::min(a, b);
  }
  seams.chart.resize(parent.size());
  for (std::uint32_t t = 0; t < parent.size(); ++t) {
    if (topology.kind[std::size_t{3} * t] == EdgeKind::Degenerate) {
      seams.chart[t] = no_chart;
      continue;
    }
    const std::uint32_t root = root_of(parent, t);
    seams.chart[t] = root == t ? seams.chart_count++ : seams.chart[root];
  }
}

SeamEdge seam_edge(std::uint32_t a, std::uint32_t b) {
  return {a / 3, b / 3, a, next_corner(a), next_corner(b), b};
}

}  // namespace

Seams find_seams(const Topology& topology) {
  Seams seams;
  seams.irregular_edges = topology.irregular_edges;
  for (std::uint32_t edge = 0; edge < topology.kind.size(); ++edge) {
    if (topology.kind[edge] == EdgeKind::Open) seams.open_edges.push_back(edge);
    if (topology.kind[edge] == EdgeKind::Seam && edge / 3 < topology.neighbor[edge] / 3) {
      seams.edges.push_back(seam_edge(edge, topology.neighbor[edge]));
    }
  }
  number_charts(topology, seams);
  return seams;
}

Seams find_seams(const Mesh& mesh) { return find_seams(make_topology(mesh)); }

}  // namespace normalshop
