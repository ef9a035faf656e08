#include "normalshop/surface/topology.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <mutex>
#include <utility>

#include "normalshop/core/parallel.h"

namespace normalshop {
namespace {

constexpr std::size_t topology_grain = 4096;
/// Larger groups of edges between the same two vertices are paired without looking at UVs.
constexpr std::size_t largest_matched_group = 32;

struct PositionKey {
  std::array<std::uint32_t, 3> bits;
  bool operator==(const PositionKey&) const = default;
};

PositionKey key_of(const Vec3f& p) {
  // Adding zero turns -0 into 0.
  return {{std::bit_cast<std::uint32_t>(p.x() + 0.0F), std::bit_cast<std::uint32_t>(p.y() + 0.0F),
           std::bit_cast<std::uint32_t>(p.z() + 0.0F)}};
}

std::uint64_t hash_of(const PositionKey& key) {
  std::uint64_t h = 0x9E3779B97F4A7C15ULL;
  for (const std::uint32_t word : key.bits) {
    h = (h ^ word) * 0xFF51AFD7ED558CCDULL;
    h ^= h >> 32;
  }
  return h;
}

/// Per index into positions: the first index with an equal position. Open addressing, linear
/// probing, at most half full.
std::vector<std::uint32_t> first_equal_position(const std::vector<Vec3f>& positions) {
  const std::size_t slots = std::bit_ceil(2 * positions.size() + 2);
  std::vector<std::uint32_t> table(slots, no_edge);
  std::vector<std::uint32_t> first(positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const PositionKey key = key_of(positions[i]);
    std::size_t slot = hash_of(key) & (slots - 1);
    while (table[slot] != no_edge && key_of(positions[table[slot]]) != key) {
      slot = (slot + 1) & (slots - 1);
    }
    if (table[slot] == no_edge) table[slot] = static_cast<std::uint32_t>(i);
    first[i] = table[slot];
  }
  return first;
}

class EdgePairing {
 public:
  EdgePairing(std::span<const std::uint32_t> vertex, const PreferPair& prefer,
              std::vector<std::uint32_t>& neighbor)
      : vertex_(vertex), prefer_(prefer), neighbor_(neighbor) {}

  std::uint32_t low(std::uint32_t edge) const { return std::min(from(edge), to(edge)); }
  std::uint32_t high(std::uint32_t edge) const { return std::max(from(edge), to(edge)); }
  bool degenerate(std::uint32_t edge) const {
    return from(edge) == to(edge) || to(edge) == vertex_[previous_corner(edge)] ||
           from(edge) == vertex_[previous_corner(edge)];
  }

  /// Edges of one lower vertex: groups them by the upper one and pairs within the groups.
  void pair_bucket(std::span<std::uint32_t> edges, std::vector<std::uint32_t>* irregular) const {
    std::sort(edges.begin(), edges.end(), [&](std::uint32_t a, std::uint32_t b) {
      return std::pair(high(a), a) < std::pair(high(b), b);
    });
    for (std::size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
      while (end < edges.size() && high(edges[end]) == high(edges[begin])) ++end;
      pair_group(edges.subspan(begin, end - begin), irregular);
    }
  }

 private:
  std::uint32_t from(std::uint32_t edge) const { return vertex_[edge]; }
  std::uint32_t to(std::uint32_t edge) const { return vertex_[next_corner(edge)]; }
  bool forward(std::uint32_t edge) const { return from(edge) < to(edge); }

  void join(std::uint32_t a, std::uint32_t b) const {
    neighbor_[a] = b;
    neighbor_[b] = a;
  }

  void pair_group(std::span<const std::uint32_t> group,
                  std::vector<std::uint32_t>* irregular) const {
    if (group.size() == 1) return;
    if (group.size() == 2 && forward(group[0]) != forward(group[1])) {
      return join(group[0], group[1]);
    }
    if (irregular != nullptr) irregular->insert(irregular->end(), group.begin(), group.end());
    if (prefer_ && group.size() <= largest_matched_group) pair_preferred(group);
    pair_in_order(group);
  }

  void pair_preferred(std::span<const std::uint32_t> group) const {
    for (std::size_t i = 0; i < group.size(); ++i) {
      for (std::size_t j = i + 1; j < group.size() && neighbor_[group[i]] == no_edge; ++j) {
        if (neighbor_[group[j]] == no_edge && forward(group[i]) != forward(group[j]) &&
            prefer_(group[i], group[j])) {
          join(group[i], group[j]);
        }
      }
    }
  }

  void pair_in_order(std::span<const std::uint32_t> group) const {
    const auto next_free = [&](std::size_t i, bool direction) {
      while (i < group.size() &&
             (neighbor_[group[i]] != no_edge || forward(group[i]) != direction)) {
        ++i;
      }
      return i;
    };
    std::size_t i = next_free(0, true);
    std::size_t j = next_free(0, false);
    while (i < group.size() && j < group.size()) {
      join(group[i], group[j]);
      i = next_free(i, true);
      j = next_free(j, false);
    }
  }

  std::span<const std::uint32_t> vertex_;
  const PreferPair& prefer_;
  std::vector<std::uint32_t>& neighbor_;
};

void exclusive_sum(std::vector<std::uint32_t>& counts) {
  std::uint32_t sum = 0;
  for (std::uint32_t& count : counts) {
    const std::uint32_t here = count;
    count = sum;
    sum += here;
  }
}

}  // namespace

Welding weld_positions(const Mesh& mesh) {
  const std::vector<std::uint32_t> first = first_equal_position(mesh.positions);
  std::vector<std::uint32_t> id(mesh.positions.size(), no_edge);
  Welding welding;
  welding.vertex.resize(mesh.corner_count());
  for (std::size_t corner = 0; corner < mesh.corner_count(); ++corner) {
    const std::uint32_t index = mesh.triangles[corner / 3][static_cast<Eigen::Index>(corner % 3)];
    std::uint32_t& vertex = id[first[index]];
    if (vertex == no_edge) vertex = welding.vertex_count++;
    welding.vertex[corner] = vertex;
  }
  return welding;
}

CornerLists corners_of_vertices(std::span<const std::uint32_t> vertex, std::uint32_t vertex_count) {
  CornerLists lists;
  lists.start.assign(static_cast<std::size_t>(vertex_count) + 1, 0);
  for (const std::uint32_t v : vertex) ++lists.start[v];
  exclusive_sum(lists.start);
  lists.corners.resize(vertex.size());
  std::vector<std::uint32_t> cursor(lists.start);
  for (std::size_t corner = 0; corner < vertex.size(); ++corner) {
    lists.corners[cursor[vertex[corner]]++] = static_cast<std::uint32_t>(corner);
  }
  return lists;
}

std::vector<std::uint32_t> pair_edges(std::span<const std::uint32_t> vertex,
                                      std::uint32_t vertex_count, const PreferPair& prefer,
                                      std::vector<std::uint32_t>* irregular) {
  std::vector<std::uint32_t> neighbor(vertex.size(), no_edge);
  const EdgePairing pairing(vertex, prefer, neighbor);
  // Edges by their lower vertex; those of degenerate triangles go to a list of their own.
  std::vector<std::uint32_t> owner(vertex.size());
  parallel_for(vertex.size(), topology_grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto edge = static_cast<std::uint32_t>(i);
      owner[i] = pairing.degenerate(edge) ? vertex_count : pairing.low(edge);
    }
  });
  CornerLists buckets = corners_of_vertices(owner, vertex_count + 1);
  std::mutex mutex;
  parallel_for(vertex_count, topology_grain, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> found;
    for (std::size_t v = begin; v < end; ++v) {
      const std::span<std::uint32_t> bucket(buckets.corners.data() + buckets.start[v],
                                            buckets.start[v + 1] - buckets.start[v]);
      pairing.pair_bucket(bucket, irregular != nullptr ? &found : nullptr);
    }
    if (found.empty()) return;
    const std::scoped_lock lock(mutex);
    irregular->insert(irregular->end(), found.begin(), found.end());
  });
  if (irregular != nullptr) std::sort(irregular->begin(), irregular->end());
  return neighbor;
}

Topology make_topology(const Mesh& mesh) {
  Topology topology;
  Welding welding = weld_positions(mesh);
  topology.vertex = std::move(welding.vertex);
  topology.vertex_count = welding.vertex_count;
  const auto same_chart = [&](std::uint32_t a, std::uint32_t b) {
    const bool same_set =
        mesh.texture_sets.empty() || mesh.texture_sets[a / 3] == mesh.texture_sets[b / 3];
    return same_set && (mesh.uvs.empty() || (mesh.uvs[a] == mesh.uvs[next_corner(b)] &&
                                             mesh.uvs[next_corner(a)] == mesh.uvs[b]));
  };
  topology.neighbor =
      pair_edges(topology.vertex, topology.vertex_count, same_chart, &topology.irregular_edges);
  topology.kind.resize(mesh.corner_count());
  const PreferPair no_preference;
  const EdgePairing pairing(topology.vertex, no_preference, topology.neighbor);
  parallel_for(mesh.corner_count(), topology_grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto edge = static_cast<std::uint32_t>(i);
      const std::uint32_t across = topology.neighbor[edge];
      topology.kind[edge] = pairing.degenerate(edge)   ? EdgeKind::Degenerate
                            : across == no_edge        ? EdgeKind::Open
                            : same_chart(edge, across) ? EdgeKind::Interior
                                                       : EdgeKind::Seam;
    }
  });
  return topology;
}

}  // namespace normalshop
