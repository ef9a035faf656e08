#include <algorithm>
#include <functional>
#include <limits>
#include <queue>

#include "normalshop/surface/detail/strip.h"

namespace normalshop {

namespace {

constexpr double never = std::numeric_limits<double>::infinity();

struct Candidate {
  double estimate;  ///< of the whole way
  std::uint32_t edge;
  bool operator>(const Candidate& other) const {
    return estimate != other.estimate ? estimate > other.estimate : edge > other.edge;
  }
};

Vec3d midpoint(const Mesh& mesh, std::uint32_t edge) {
  return 0.5 * (mesh.position(edge) + mesh.position(next_corner(edge))).cast<double>();
}

/// A* over edges; an edge stands for its midpoint, reached in the triangle that has the edge.
class StripSearch {
 public:
  StripSearch(const Mesh& mesh, const Crossings& crossings, const Strip& strip)
      : mesh_(mesh),
        crossings_(crossings),
        goal_(position_at(mesh, strip.end).cast<double>()),
        cost_(mesh.corner_count(), never),
        from_(mesh.corner_count(), no_edge) {
    const Vec3d start = position_at(mesh, strip.start).cast<double>();
    for (std::uint32_t k = 0; k < 3; ++k) leave(3 * strip.start.triangle + k, start, 0.0, no_edge);
  }

  bool run(Strip& strip) {
    double best = never;
    std::uint32_t last = no_edge;
    while (!open_.empty()) {
      const Candidate next = open_.top();
      open_.pop();
      if (!(next.estimate < best)) break;
      const std::uint32_t edge = next.edge;
      if (done(next)) continue;
      const Vec3d here = midpoint(mesh_, edge);
      if (edge / 3 == strip.end.triangle) {
        best = cost_[edge] + (goal_ - here).norm();
        last = edge;
        continue;
      }
      leave(next_corner(edge), here, cost_[edge], edge);
      leave(previous_corner(edge), here, cost_[edge], edge);
    }
    if (last == no_edge) return false;
    strip.edges.clear();
    for (std::uint32_t e = last; e != no_edge; e = from_[e]) {
      strip.edges.push_back(crossings_.across(e));
    }
    std::reverse(strip.edges.begin(), strip.edges.end());
    return true;
  }

 private:
  double estimate(std::uint32_t edge) const {
    return cost_[edge] + (goal_ - midpoint(mesh_, edge)).norm();
  }
  bool done(const Candidate& c) const { return c.estimate > estimate(c.edge); }

  void leave(std::uint32_t edge, const Vec3d& here, double cost, std::uint32_t from) {
    const std::uint32_t entered = crossings_.across(edge);
    if (entered == no_edge) return;
    const double reached = cost + (midpoint(mesh_, edge) - here).norm();
    if (!(reached < cost_[entered])) return;
    cost_[entered] = reached;
    from_[entered] = from;
    open_.push({estimate(entered), entered});
  }

  const Mesh& mesh_;
  const Crossings& crossings_;
  Vec3d goal_;
  std::vector<double> cost_;
  std::vector<std::uint32_t> from_;
  std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> open_;
};

}  // namespace

Crossings::Crossings(const Topology& topology)
    : topology_(topology), closed_(topology.neighbor.size(), false) {
  for (const std::uint32_t edge : topology.irregular_edges) {
    closed_[edge] = true;
    if (topology.neighbor[edge] != no_edge) closed_[topology.neighbor[edge]] = true;
  }
}

bool find_strip(const Mesh& mesh, const Crossings& crossings, Strip& strip) {
  strip.edges.clear();
  if (strip.start.triangle == strip.end.triangle) return true;
  return StripSearch(mesh, crossings, strip).run(strip);
}

}  // namespace normalshop
