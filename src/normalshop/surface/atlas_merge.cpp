#include <algorithm>
#include <iterator>
#include <queue>
#include <tuple>

#include "normalshop/surface/detail/atlas_chart.h"
#include "normalshop/surface/detail/convex_hull.h"
#include "normalshop/surface/topology.h"

namespace normalshop::unwrapping {

namespace {

/// Of a merged chart in its convex hull.
constexpr double least_solidity = 0.7;

struct Border {
  std::uint32_t chart;
  double length;
};

/// A chart while charts merge.
struct Part {
  AtlasChart chart;
  Vec3d sum = Vec3d::Zero();  ///< of normals by area
  double area = 0.0;
  double border = 0.0;          ///< length of all borders
  std::vector<Border> borders;  ///< with other charts, by chart
  std::uint32_t version = 0;
  bool alive = true;
};

struct MergeCandidate {
  double cost;
  std::uint32_t a;
  std::uint32_t b;
  std::uint32_t version_a;
  std::uint32_t version_b;
  bool operator>(const MergeCandidate& other) const {
    return std::tie(cost, a, b) > std::tie(other.cost, other.a, other.b);
  }
};

class Merger {
 public:
  Merger(const Surface& surface, std::vector<AtlasChart> charts, const ChartLimits& limits)
      : surface_(surface), limits_(limits), parts_(charts.size()), chart_of_(surface.size(), none) {
    for (std::uint32_t i = 0; i < charts.size(); ++i) {
      parts_[i].chart = std::move(charts[i]);
      for (const std::uint32_t t : parts_[i].chart.triangles) chart_of_[t] = i;
    }
    mark_.assign(surface.vertex_count, 0);
    for (std::uint32_t i = 0; i < parts_.size(); ++i) measure(i);
    for (std::uint32_t i = 0; i < parts_.size(); ++i) offer_neighbors(i);
  }

  std::vector<AtlasChart> run() {
    while (!queue_.empty()) {
      const MergeCandidate next = queue_.top();
      queue_.pop();
      const bool fresh = parts_[next.a].alive && parts_[next.b].alive &&
                         parts_[next.a].version == next.version_a &&
                         parts_[next.b].version == next.version_b;
      if (fresh) try_merge(next.a, next.b);
    }
    std::vector<AtlasChart> charts;
    for (Part& part : parts_) {
      if (part.alive) charts.push_back(std::move(part.chart));
    }
    return charts;
  }

 private:
  void measure(std::uint32_t index) {
    Part& part = parts_[index];
    for (const std::uint32_t t : part.chart.triangles) {
      part.sum += surface_.area[t] * surface_.normal[t];
      part.area += surface_.area[t];
      for (std::uint32_t edge = 3 * t; edge < 3 * t + 3; ++edge) {
        const std::uint32_t next = surface_.across[edge];
        const std::uint32_t other = next == none ? none : chart_of_[next];
        if (other == index) continue;
        const double length = (surface_.points[next_corner(edge)] - surface_.points[edge]).norm();
        part.border += length;
        if (other != none) part.borders.push_back({other, length});
      }
    }
    unite_borders(part);
  }

  static void unite_borders(Part& part) {
    auto& borders = part.borders;
    std::stable_sort(borders.begin(), borders.end(),
                     [](const Border& x, const Border& y) { return x.chart < y.chart; });
    std::size_t count = 0;
    for (std::size_t i = 0; i < borders.size(); ++i) {
      if (count > 0 && borders[count - 1].chart == borders[i].chart) {
        borders[count - 1].length += borders[i].length;
      } else {
        borders[count++] = borders[i];
      }
    }
    borders.resize(count);
  }

  void offer_neighbors(std::uint32_t index) {
    for (const Border& border : parts_[index].borders) offer(index, border.chart, border.length);
  }

  /// Flat and compact unions come first.
  void offer(std::uint32_t a, std::uint32_t b, double shared) {
    if (a > b) std::swap(a, b);
    const Part& p = parts_[a];
    const Part& q = parts_[b];
    const double mean = (p.sum + q.sum).norm() / std::max(p.area + q.area, 1e-300);
    const double compact = shared / std::max(std::min(p.border, q.border), 1e-300);
    queue_.push({1.0 - mean - 0.1 * compact, a, b, p.version, q.version});
  }

  void try_merge(std::uint32_t a, std::uint32_t b) {
    AtlasChart merged;
    const auto& first = parts_[a].chart.triangles;
    const auto& second = parts_[b].chart.triangles;
    merged.triangles.resize(first.size() + second.size());
    std::merge(first.begin(), first.end(), second.begin(), second.end(), merged.triangles.begin());
    merged.direction = facing_direction(surface_, merged.triangles, limits_.cosine);
    if (worst_facing(surface_, merged.triangles, merged.direction) < limits_.cosine) return;
    if (mean_stretch(surface_, merged.triangles, merged.direction) > limits_.stretch) return;
    const AtlasChart rim = rim_of(merged, a, b);
    if (is_crooked(merged, rim)) return;
    // A connected picture without folds overlaps itself only where its borders do.
    if (!overlaps_of(surface_, rim).empty()) return;
    unite(a, b, std::move(merged));
  }

  /// It would leave too much of the map around it unused.
  bool is_crooked(const AtlasChart& merged, const AtlasChart& rim) const {
    std::vector<Vec2d> corners;
    for (const FlatTriangle& t : flatten(surface_, rim)) {
      corners.insert(corners.end(), std::begin(t.corner), std::end(t.corner));
    }
    double shown = 0.0;
    for (const std::uint32_t t : merged.triangles) {
      shown += surface_.area[t] * surface_.normal[t].dot(merged.direction);
    }
    return shown < least_solidity * polygon_area(convex_hull(std::move(corners)));
  }

  /// The triangles that touch the border of the union of charts a and b.
  AtlasChart rim_of(const AtlasChart& merged, std::uint32_t a, std::uint32_t b) {
    ++epoch_;
    const auto inside = [&](std::uint32_t t) {
      return t != none && (chart_of_[t] == a || chart_of_[t] == b);
    };
    for (const std::uint32_t t : merged.triangles) {
      for (std::uint32_t edge = 3 * t; edge < 3 * t + 3; ++edge) {
        if (inside(surface_.across[edge])) continue;
        mark_[surface_.vertex[edge]] = epoch_;
        mark_[surface_.vertex[next_corner(edge)]] = epoch_;
      }
    }
    AtlasChart rim;
    rim.direction = merged.direction;
    for (const std::uint32_t t : merged.triangles) {
      const std::uint32_t* v = surface_.vertex.data() + std::size_t{3} * t;
      if (std::any_of(v, v + 3, [&](std::uint32_t x) { return mark_[x] == epoch_; })) {
        rim.triangles.push_back(t);
      }
    }
    return rim;
  }

  void unite(std::uint32_t a, std::uint32_t b, AtlasChart merged) {
    Part& p = parts_[a];
    Part& q = parts_[b];
    for (const std::uint32_t t : q.chart.triangles) chart_of_[t] = a;
    p.chart = std::move(merged);
    p.sum += q.sum;
    p.area += q.area;
    double shared = 0.0;
    for (const Border& border : p.borders) shared += border.chart == b ? border.length : 0.0;
    p.border += q.border - 2.0 * shared;
    p.borders.insert(p.borders.end(), q.borders.begin(), q.borders.end());
    std::erase_if(p.borders, [&](const Border& x) { return x.chart == a || x.chart == b; });
    unite_borders(p);
    q = Part();
    q.alive = false;
    ++p.version;
    for (const Border& border : p.borders) {
      for (Border& back : parts_[border.chart].borders) {
        if (back.chart == b) back.chart = a;
      }
      unite_borders(parts_[border.chart]);
    }
    offer_neighbors(a);
  }

  const Surface& surface_;
  const ChartLimits& limits_;
  std::vector<Part> parts_;
  std::vector<std::uint32_t> chart_of_;
  std::vector<std::uint32_t> mark_;  ///< per vertex: the last epoch in which it lay on a border
  std::uint32_t epoch_ = 0;
  std::priority_queue<MergeCandidate, std::vector<MergeCandidate>, std::greater<>> queue_;
};

}  // namespace

std::vector<AtlasChart> merge(const Surface& surface, std::vector<AtlasChart> charts,
                              const ChartLimits& limits) {
  return Merger(surface, std::move(charts), limits).run();
}

}  // namespace normalshop::unwrapping
