#include "normalshop/rgbn/detail/edge_list.h"

#include <utility>

#include "normalshop/core/parallel.h"

namespace normalshop {

namespace {

/// Counting sort of bands of rows: how many edges of each code a band has tells where it puts them.
class EdgeSorter {
 public:
  EdgeSorter(const EdgeCodes& codes, const Image<std::uint32_t>& nodes)
      : codes_(codes),
        nodes_(nodes),
        bands_(std::clamp(codes.height() / 64, 1, 16)),
        counts_(static_cast<int>(no_edge) + 1, bands_, 0) {}

  EdgeList sort() {
    EdgeList list;
    for_bands([&](std::uint32_t* counts, std::uint16_t code, EdgeList::Edge) { ++counts[code]; });
    turn_into_starts(list.starts);
    list.edges.resize(list.starts.back());
    for_bands([&](std::uint32_t* next, std::uint16_t code, EdgeList::Edge edge) {
      list.edges[next[code]++] = edge;
    });
    return list;
  }

 private:
  /// visit(counts of the band, code, edge) for all edges of each band, in scan order.
  template <class Visit>
  void for_bands(const Visit& visit) {
    const auto height = static_cast<std::int64_t>(codes_.height());
    parallel_for(static_cast<std::size_t>(bands_), 1, [&](std::size_t begin, std::size_t end) {
      for (auto i = static_cast<int>(begin); i < static_cast<int>(end); ++i) {
        const auto y1 = static_cast<int>((i + 1) * height / bands_);
        for (auto y = static_cast<int>(i * height / bands_); y < y1; ++y) {
          visit_row(y, counts_.row(i), visit);
        }
      }
    });
  }

  template <class Visit>
  void visit_row(int y, std::uint32_t* counts, const Visit& visit) const {
    const std::uint16_t* codes = codes_.row(y);
    const std::uint32_t* nodes = nodes_.row(y);
    const std::uint32_t* below = nodes_.row(y + 1 < nodes_.height() ? y + 1 : 0);
    const int width = nodes_.width();
    for (int x = 0; x < width; ++x) {
      for (std::size_t way = 0; way < 4; ++way) {
        const std::uint16_t code = *codes++;
        if (code == no_edge) continue;
        int x1 = x + edge_dx[way];  // beyond a side: on the other one
        if (x1 == width) x1 = 0;
        if (x1 < 0) x1 = width - 1;
        const std::uint32_t other = (edge_dy[way] == 0 ? nodes : below)[x1];
        if (other != nodes[x]) visit(counts, code, {nodes[x], other});
      }
    }
  }

  void turn_into_starts(std::vector<std::uint32_t>& starts) {
    starts.resize(no_edge + 1);
    std::uint32_t sum = 0;
    for (std::uint32_t code = 0; code < no_edge; ++code) {
      starts[code] = sum;
      for (int band = 0; band < bands_; ++band) {
        sum += std::exchange(counts_(static_cast<int>(code), band), sum);
      }
    }
    starts[no_edge] = sum;
  }

  const EdgeCodes& codes_;
  const Image<std::uint32_t>& nodes_;
  int bands_;
  Image<std::uint32_t> counts_;
};

/// For each edge whether it is the first between its nodes.
std::vector<std::uint8_t> find_firsts(const PixelVector<EdgeList::Edge>& edges,
                                      std::uint32_t count) {
  std::vector<std::uint32_t> starts(count + std::size_t{1}, 0);
  for (const EdgeList::Edge& edge : edges) ++starts[std::min(edge.a, edge.b)];
  std::uint32_t sum = 0;
  for (std::uint32_t& start : starts) sum += std::exchange(start, sum);
  std::vector<std::uint32_t> by_node(edges.size());
  for (std::uint32_t i = 0; i < edges.size(); ++i) {
    by_node[starts[std::min(edges[i].a, edges[i].b)]++] = i;
  }
  std::vector<std::uint8_t> first(edges.size());
  std::vector<std::uint32_t> seen_from(count, no_label);
  for (const std::uint32_t i : by_node) {
    const std::uint32_t low = std::min(edges[i].a, edges[i].b);
    std::uint32_t& seen = seen_from[std::max(edges[i].a, edges[i].b)];
    first[i] = seen != low ? 1 : 0;
    seen = low;
  }
  return first;
}

}  // namespace

EdgeList sort_edges(const EdgeCodes& codes, const Image<std::uint32_t>& nodes) {
  return EdgeSorter(codes, nodes).sort();
}

EdgeList without_parallels(const EdgeList& list, std::uint32_t count) {
  const std::vector<std::uint8_t> first = find_firsts(list.edges, count);
  EdgeList out;
  out.starts.reserve(list.starts.size());
  std::uint32_t i = 0;
  for (const std::uint32_t start : list.starts) {
    for (; i < start; ++i) {
      if (first[i] != 0) out.edges.push_back(list.edges[i]);
    }
    out.starts.push_back(static_cast<std::uint32_t>(out.edges.size()));
  }
  return out;
}

}  // namespace normalshop
