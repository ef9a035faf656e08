#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "normalshop/rgbn/detail/edge_list.h"
#include "normalshop/rgbn/segment.h"

/// The joining of nodes to segments, private to this floor.
namespace normalshop {

/// Nodes with what the criterion asks of them.
struct NodeStates {
  std::vector<std::int32_t> sizes;  ///< pixels
  std::vector<float> internal;      ///< Int: the largest weight that joined the node's pixels
};

/// Disjoint sets of nodes. A root holds the size of its set and the weight up to which it grows.
class SegmentForest {
 public:
  /// `count` single pixels.
  SegmentForest(std::uint32_t count, float coarseness)
      : coarseness_(coarseness), links_(count, -1), thresholds_(count, coarseness) {}
  SegmentForest(const NodeStates& nodes, float coarseness);

  /// Joins what the criterion joins. Returns the edges that did not join although one end had less
  /// than min_size pixels, in order: the only ones that matter to join_small.
  std::vector<EdgeList::Edge> join_alike(const EdgeList& list, std::int32_t min_size);
  void join_small(const std::vector<EdgeList::Edge>& edges, std::int32_t min_size);

  /// Makes those joins of single pixels which every coarseness from this one up makes. (A set stops
  /// growing with the first of its edges that does not join: up to there it holds all that lighter
  /// edges reach, whatever the coarseness, and all its other edges are still to come.) Returns the
  /// states of the sets, in the order of label().
  NodeStates join_certain(const EdgeList& list);

  std::uint32_t count() const { return static_cast<std::uint32_t>(links_.size()); }  ///< nodes
  std::uint32_t find_only(std::uint32_t i) const {
    while (links_[i] >= 0) i = static_cast<std::uint32_t>(links_[i]);
    return i;
  }
  std::int32_t size(std::uint32_t root) const { return -links_[root]; }

 private:
  std::uint32_t find(std::uint32_t i);
  std::uint32_t join(std::uint32_t a, std::uint32_t b);
  bool alike(std::uint32_t a, std::uint32_t b, float weight) const {
    return weight <= thresholds_[a] && weight <= thresholds_[b];
  }
  void grow(std::uint32_t root, float weight) {
    thresholds_[root] = weight + coarseness_ / static_cast<float>(size(root));
  }
  template <class Visit>
  void for_edges(const EdgeList& list, const Visit& visit);

  float coarseness_;
  PixelVector<std::int32_t> links_;  ///< the parent; of a root, minus the number of pixels
  PixelVector<float> thresholds_;    ///< of a root: Int + coarseness / size
};

/// Numbers the sets in the order of their first nodes and tells each pixel's set. Pixels without
/// node stay so.
Segments label(const SegmentForest& forest, const Image<std::uint32_t>& nodes);

}  // namespace normalshop
