#include "normalshop/rgbn/detail/segment_forest.h"

#include <algorithm>

#include "normalshop/core/parallel.h"

namespace normalshop {

namespace {

struct Numbers {
  PixelVector<std::uint32_t> of_node;
  std::uint32_t count = 0;
};

Numbers number_sets(const SegmentForest& forest) {
  constexpr std::uint32_t none = no_label;
  Numbers out{PixelVector<std::uint32_t>(forest.count(), none), 0};
  for (std::uint32_t i = 0; i < forest.count(); ++i) {
    const std::uint32_t root = forest.find_only(i);
    if (out.of_node[root] == none) out.of_node[root] = out.count++;
    out.of_node[i] = out.of_node[root];
  }
  return out;
}

}  // namespace

SegmentForest::SegmentForest(const NodeStates& nodes, float coarseness)
    : coarseness_(coarseness), links_(nodes.sizes.size()), thresholds_(nodes.sizes.size()) {
  for (std::size_t i = 0; i < links_.size(); ++i) {
    links_[i] = -nodes.sizes[i];
    thresholds_[i] = nodes.internal[i] + coarseness / static_cast<float>(nodes.sizes[i]);
  }
}

/// Halves the way to the root for those who come after.
std::uint32_t SegmentForest::find(std::uint32_t i) {
  for (;;) {
    const std::int32_t parent = links_[i];
    if (parent < 0) return i;
    const std::int32_t next = links_[static_cast<std::uint32_t>(parent)];
    if (next < 0) return static_cast<std::uint32_t>(parent);
    links_[i] = next;
    i = static_cast<std::uint32_t>(next);
  }
}

/// Joins two roots and returns the one that stays.
std::uint32_t SegmentForest::join(std::uint32_t a, std::uint32_t b) {
  if (size(a) < size(b)) std::swap(a, b);
  links_[a] += links_[b];
  links_[b] = static_cast<std::int32_t>(a);
  return a;
}

/// visit(root, other root, weight, edge) for the edges between different sets.
template <class Visit>
void SegmentForest::for_edges(const EdgeList& list, const Visit& visit) {
  constexpr std::uint32_t ahead = 16;  // sorted edges are all over the image: fetch links early
  const auto count = static_cast<std::uint32_t>(list.edges.size());
  for (std::uint32_t code = 0; code < no_edge; ++code) {
    const float weight = weight_of_code(code);
    for (std::uint32_t i = list.starts[code]; i < list.starts[code + 1]; ++i) {
      const EdgeList::Edge later = list.edges[std::min(i + ahead, count - 1)];
      __builtin_prefetch(links_.data() + later.a);
      __builtin_prefetch(links_.data() + later.b);
      const std::uint32_t a = find(list.edges[i].a);
      const std::uint32_t b = find(list.edges[i].b);
      if (a != b) visit(a, b, weight);
    }
  }
}

std::vector<EdgeList::Edge> SegmentForest::join_alike(const EdgeList& list, std::int32_t min_size) {
  std::vector<EdgeList::Edge> left;
  for_edges(list, [&](std::uint32_t a, std::uint32_t b, float weight) {
    if (alike(a, b, weight)) {
      grow(join(a, b), weight);
    } else if (size(a) < min_size || size(b) < min_size) {
      left.push_back({a, b});
    }
  });
  return left;
}

void SegmentForest::join_small(const std::vector<EdgeList::Edge>& edges, std::int32_t min_size) {
  for (const EdgeList::Edge& edge : edges) {
    const std::uint32_t a = find(edge.a);
    const std::uint32_t b = find(edge.b);
    if (a != b && (size(a) < min_size || size(b) < min_size)) join(a, b);
  }
}

NodeStates SegmentForest::join_certain(const EdgeList& list) {
  constexpr float closed = -1.0F;  // below every weight
  std::vector<float> internal(links_.size(), 0.0F);
  for_edges(list, [&](std::uint32_t a, std::uint32_t b, float weight) {
    if (alike(a, b, weight)) {
      const std::uint32_t root = join(a, b);
      grow(root, weight);
      internal[root] = weight;
    } else {
      thresholds_[a] = thresholds_[b] = closed;
    }
  });
  const Numbers numbers = number_sets(*this);
  NodeStates states{std::vector<std::int32_t>(numbers.count), std::vector<float>(numbers.count)};
  for (std::uint32_t i = 0; i < count(); ++i) {
    if (links_[i] >= 0) continue;
    states.sizes[numbers.of_node[i]] = size(i);
    states.internal[numbers.of_node[i]] = internal[i];
  }
  return states;
}

Segments label(const SegmentForest& forest, const Image<std::uint32_t>& nodes) {
  const Numbers numbers = number_sets(forest);
  Segments out{Image<std::uint32_t>(nodes.width(), nodes.height()), numbers.count};
  parallel_for(nodes.size(), std::size_t{1} << 16U, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint32_t node = nodes.data()[i];
      out.labels.data()[i] = node == no_label ? no_label : numbers.of_node[node];
    }
  });
  return out;
}

}  // namespace normalshop
