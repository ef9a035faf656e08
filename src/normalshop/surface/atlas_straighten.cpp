#include <algorithm>
#include <array>

#include "normalshop/surface/detail/atlas_chart.h"
#include "normalshop/surface/topology.h"

namespace normalshop::unwrapping {

namespace {

constexpr int most_passes = 20;

/// Moves triangles to where more of their border lies, which shortens the borders each time.
class Straightener {
 public:
  Straightener(const Surface& surface, const std::vector<AtlasChart>& charts,
               const ChartLimits& limits)
      : surface_(surface), limits_(limits), chart_of_(surface.size(), none) {
    for (const AtlasChart& chart : charts) {
      for (const std::uint32_t t : chart.triangles) {
        chart_of_[t] = static_cast<std::uint32_t>(directions_.size());
      }
      directions_.push_back(chart.direction);
    }
  }

  std::vector<AtlasChart> run() {
    for (int pass = 0; pass < most_passes && pass_once(); ++pass) {
    }
    std::vector<AtlasChart> charts(directions_.size());
    for (std::size_t i = 0; i < charts.size(); ++i) charts[i].direction = directions_[i];
    for (std::uint32_t t = 0; t < chart_of_.size(); ++t) {
      if (chart_of_[t] != none) charts[chart_of_[t]].triangles.push_back(t);
    }
    std::erase_if(charts, [](const AtlasChart& chart) { return chart.triangles.empty(); });
    return charts;
  }

 private:
  bool pass_once() {
    bool moved = false;
    for (std::uint32_t t = 0; t < chart_of_.size(); ++t) {
      const std::uint32_t better = better_chart(t);
      if (better == chart_of_[t]) continue;
      chart_of_[t] = better;
      moved = true;
    }
    return moved;
  }

  std::uint32_t better_chart(std::uint32_t t) const {
    const std::uint32_t own = chart_of_[t];
    std::array<std::uint32_t, 3> chart{};
    std::array<double, 3> length{};
    double inside = 0.0;
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t edge = 3 * t + k;
      const std::uint32_t next = surface_.across[edge];
      chart[k] = next == none ? none : chart_of_[next];
      if (chart[k] == none) continue;
      length[k] = (surface_.points[next_corner(edge)] - surface_.points[edge]).norm();
      if (chart[k] == own) inside += length[k];
    }
    if (own == none) return own;
    for (std::size_t k = 0; k < 3; ++k) {
      if (chart[k] == none || chart[k] == own) continue;
      double shared = 0.0;
      for (std::size_t j = 0; j < 3; ++j) shared += chart[j] == chart[k] ? length[j] : 0.0;
      // The margin keeps equal lengths from going back and forth.
      if (shared > 1.000001 * inside &&
          surface_.facing(t, directions_[chart[k]]) >= limits_.cosine) {
        return chart[k];
      }
    }
    return own;
  }

  const Surface& surface_;
  const ChartLimits& limits_;
  std::vector<std::uint32_t> chart_of_;
  std::vector<Vec3d> directions_;
};

}  // namespace

std::vector<AtlasChart> straighten(const Surface& surface, const std::vector<AtlasChart>& charts,
                                   const ChartLimits& limits) {
  return Straightener(surface, charts, limits).run();
}

}  // namespace normalshop::unwrapping
