#include <algorithm>
#include <iterator>

#include "normalshop/core/parallel.h"
#include "normalshop/surface/detail/atlas_chart.h"

namespace normalshop::unwrapping {

namespace {

/// Which of a chart's triangles overlap which.
class Conflicts {
 public:
  explicit Conflicts(const std::vector<NamePair>& pairs) {
    for (const NamePair& p : pairs) both_.insert(both_.end(), {p, {p.second, p.first}});
    std::sort(both_.begin(), both_.end());
  }
  bool empty() const { return both_.empty(); }
  template <class Test>
  bool any_of(std::uint32_t triangle, const Test& test) const {
    auto at = std::lower_bound(both_.begin(), both_.end(), NamePair{triangle, 0});
    for (; at != both_.end() && at->first == triangle; ++at) {
      if (test(at->second)) return true;
    }
    return false;
  }

 private:
  std::vector<NamePair> both_;
};

/// Connected parts of a set of triangles, by the lowest triangle of each.
std::vector<std::vector<std::uint32_t>> connected_parts(const Surface& surface,
                                                        std::vector<std::uint32_t> triangles) {
  std::sort(triangles.begin(), triangles.end());
  const auto place = [&](std::uint32_t t) {
    const auto at = std::lower_bound(triangles.begin(), triangles.end(), t);
    const bool found = at != triangles.end() && *at == t;
    return found ? static_cast<std::size_t>(at - triangles.begin()) : triangles.size();
  };
  std::vector<bool> seen(triangles.size(), false);
  std::vector<std::vector<std::uint32_t>> parts;
  for (std::size_t first = 0; first < triangles.size(); ++first) {
    if (seen[first]) continue;
    seen[first] = true;
    std::vector<std::uint32_t> part{triangles[first]};
    for (std::size_t i = 0; i < part.size(); ++i) {
      for (std::size_t edge = std::size_t{3} * part[i], end = edge + 3; edge < end; ++edge) {
        const std::uint32_t next = surface.across[edge];
        const std::size_t at = next == none ? seen.size() : place(next);
        if (at == seen.size() || seen[at]) continue;
        seen[at] = true;
        part.push_back(next);
      }
    }
    std::sort(part.begin(), part.end());
    parts.push_back(std::move(part));
  }
  return parts;
}

class Splitter {
 public:
  Splitter(const Surface& surface, const ChartLimits& limits)
      : surface_(surface), limits_(limits) {}

  /// Valid charts of the same triangles.
  std::vector<AtlasChart> split(const AtlasChart& chart) const {
    std::vector<AtlasChart> done;
    std::vector<std::vector<std::uint32_t>> open = connected_parts(surface_, chart.triangles);
    while (!open.empty()) {
      AtlasChart part;
      part.triangles = std::move(open.back());
      open.pop_back();
      if (std::none_of(part.triangles.begin(), part.triangles.end(),
                       [&](std::uint32_t t) { return surface_.has_area(t); })) {
        continue;
      }
      part.direction = facing_direction(surface_, part.triangles, limits_.cosine);
      std::vector<std::uint32_t> rest = keep_what_fits(part);
      done.push_back(std::move(part));
      for (auto& more : connected_parts(surface_, std::move(rest))) open.push_back(std::move(more));
    }
    return done;
  }

 private:
  /// Cuts the chart down to what grows from its middle without turning away or overlapping, and
  /// returns the rest.
  std::vector<std::uint32_t> keep_what_fits(AtlasChart& chart) const {
    if (std::none_of(chart.triangles.begin(), chart.triangles.end(),
                     [&](std::uint32_t t) { return faces(t, chart); })) {
      chart.direction = surface_.normal[largest(chart)];
    }
    const Conflicts conflicts(overlaps_of(surface_, chart));
    if (conflicts.empty() &&
        worst_facing(surface_, chart.triangles, chart.direction) >= limits_.cosine) {
      return {};
    }
    std::vector<char> state(chart.triangles.size(), 0);  // 1: waits, 2: kept
    const auto place = [&](std::uint32_t t) {
      const auto at = std::lower_bound(chart.triangles.begin(), chart.triangles.end(), t);
      const bool found = at != chart.triangles.end() && *at == t;
      return found ? static_cast<std::size_t>(at - chart.triangles.begin()) : state.size();
    };
    const auto kept = [&](std::uint32_t t) { return state[place(t)] == 2; };
    std::vector<std::uint32_t> queue{middle(chart)};
    state[place(queue[0])] = 1;
    for (std::size_t i = 0; i < queue.size(); ++i) {
      const std::uint32_t t = queue[i];
      if (!faces(t, chart) || conflicts.any_of(t, kept)) continue;
      state[place(t)] = 2;
      for (std::size_t edge = std::size_t{3} * t, end = edge + 3; edge < end; ++edge) {
        const std::uint32_t next = surface_.across[edge];
        const std::size_t at = next == none ? state.size() : place(next);
        if (at == state.size() || state[at] != 0) continue;
        state[at] = 1;
        queue.push_back(next);
      }
    }
    std::vector<std::uint32_t> rest;
    std::vector<std::uint32_t> stay;
    for (std::size_t i = 0; i < state.size(); ++i) {
      (state[i] == 2 ? stay : rest).push_back(chart.triangles[i]);
    }
    chart.triangles = std::move(stay);
    return rest;
  }

  bool faces(std::uint32_t t, const AtlasChart& chart) const {
    return surface_.has_area(t) && surface_.facing(t, chart.direction) >= limits_.cosine;
  }

  std::uint32_t largest(const AtlasChart& chart) const {
    return *std::max_element(
        chart.triangles.begin(), chart.triangles.end(),
        [&](std::uint32_t a, std::uint32_t b) { return surface_.area[a] < surface_.area[b]; });
  }

  /// Of the triangles that face the direction, the one nearest to their middle.
  std::uint32_t middle(const AtlasChart& chart) const {
    const ChartPlane plane(chart.direction);
    const auto centre = [&](std::uint32_t t) {
      const Vec3d* p = surface_.points.data() + std::size_t{3} * t;
      return Vec2d(plane(p[0] + p[1] + p[2]) / 3.0);
    };
    Vec2d sum = Vec2d::Zero();
    double area = 0.0;
    for (const std::uint32_t t : chart.triangles) {
      if (!faces(t, chart)) continue;
      sum += surface_.area[t] * centre(t);
      area += surface_.area[t];
    }
    std::uint32_t best = none;
    double least = 0.0;
    for (const std::uint32_t t : chart.triangles) {
      if (!faces(t, chart)) continue;
      const double distance = (centre(t) - sum / area).squaredNorm();
      if (best != none && distance >= least) continue;
      best = t;
      least = distance;
    }
    return best;
  }

  const Surface& surface_;
  const ChartLimits& limits_;
};

}  // namespace

std::vector<AtlasChart> make_valid(const Surface& surface, std::vector<AtlasChart> charts,
                                   const ChartLimits& limits) {
  std::vector<std::vector<AtlasChart>> parts(charts.size());
  const Splitter splitter(surface, limits);
  parallel_for(charts.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) parts[i] = splitter.split(charts[i]);
  });
  std::vector<AtlasChart> valid;
  for (auto& part : parts) {
    valid.insert(valid.end(), std::make_move_iterator(part.begin()),
                 std::make_move_iterator(part.end()));
  }
  return valid;
}

}  // namespace normalshop::unwrapping
