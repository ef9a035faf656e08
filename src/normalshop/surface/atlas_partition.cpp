#include <algorithm>
#include <array>
#include <cmath>

#include "normalshop/surface/detail/atlas_chart.h"

namespace normalshop::unwrapping {

namespace {

constexpr int most_rounds = 16;
constexpr int steps_a_round = 3;
constexpr int last_steps = 6;

/// A region grows from its seed and takes what faces its direction best.
struct Region {
  std::uint32_t seed = none;
  Vec3d direction{0.0, 0.0, 1.0};
};

/// Smallest cost first, in steps of 1/4096; first in, first out within a step.
class CostQueue {
 public:
  struct Entry {
    std::uint32_t triangle;
    std::uint32_t region;
  };
  void push(double cost, Entry entry) {
    const auto step =
        std::min(buckets_.size() - 1, static_cast<std::size_t>(std::max(0.0, cost) * 4096.0));
    buckets_[step].push_back(entry);
    lowest_ = std::min(lowest_, step);
  }
  bool pop(Entry& entry) {
    while (lowest_ < buckets_.size() && heads_[lowest_] == buckets_[lowest_].size()) {
      buckets_[lowest_].clear();
      heads_[lowest_] = 0;
      ++lowest_;
    }
    if (lowest_ == buckets_.size()) return false;
    entry = buckets_[lowest_][heads_[lowest_]++];
    return true;
  }

 private:
  std::array<std::vector<Entry>, 4097> buckets_;
  std::array<std::size_t, 4097> heads_{};
  std::size_t lowest_ = 0;
};

class Partition {
 public:
  Partition(const Surface& surface, const ChartLimits& limits)
      : surface_(surface), limits_(limits), region_of_(surface.size(), none) {}

  std::vector<AtlasChart> run() {
    for (int round = 0; round < most_rounds; ++round) {
      const bool added = add_regions();
      if (!added) break;
      for (int step = 0; step < steps_a_round; ++step) settle();
    }
    for (int step = 0; step < last_steps; ++step) settle();
    // What nothing reaches has charts of its own.
    seed_uncovered();
    grow();
    return charts();
  }

 private:
  double facing(std::uint32_t t, const Region& region) const {
    return surface_.has_area(t) ? surface_.smooth[t].dot(region.direction) : 1.0;
  }

  void offer(std::uint32_t t, std::uint32_t region) {
    const double cosine = facing(t, regions_[region]);
    if (cosine >= limits_.cosine) queue_.push(1.0 - cosine, {t, region});
  }

  void grow() {
    std::fill(region_of_.begin(), region_of_.end(), none);
    for (std::uint32_t r = 0; r < regions_.size(); ++r) {
      if (regions_[r].seed != none) queue_.push(0.0, {regions_[r].seed, r});
    }
    CostQueue::Entry entry{};
    while (queue_.pop(entry)) {
      if (region_of_[entry.triangle] != none) continue;
      region_of_[entry.triangle] = entry.region;
      for (std::size_t edge = std::size_t{3} * entry.triangle, end = edge + 3; edge < end; ++edge) {
        const std::uint32_t next = surface_.across[edge];
        if (next != none && region_of_[next] == none) offer(next, entry.region);
      }
    }
  }

  /// Directions become the means of what they have grown over, seeds the triangles that face best.
  void settle() {
    std::vector<Vec3d> sums(regions_.size(), Vec3d::Zero());
    for (std::size_t t = 0; t < surface_.size(); ++t) {
      if (region_of_[t] != none) sums[region_of_[t]] += surface_.area[t] * surface_.smooth[t];
    }
    std::vector<double> best(regions_.size(), -2.0);
    for (std::uint32_t r = 0; r < regions_.size(); ++r) {
      const double length = sums[r].norm();
      if (length > 0.0) regions_[r].direction = sums[r] / length;
      regions_[r].seed = none;
    }
    for (std::uint32_t t = 0; t < surface_.size(); ++t) {
      const std::uint32_t r = region_of_[t];
      if (r == none) continue;
      const double cosine = surface_.has_area(t) ? facing(t, regions_[r]) : -1.0;
      if (cosine <= best[r]) continue;
      best[r] = cosine;
      regions_[r].seed = t;
    }
    grow();
  }

  /// A new seed in each region that stretches too much, at the triangle that faces it least, and in
  /// each part that no region reaches.
  bool add_regions() {
    const std::vector<AtlasChart> now = charts();
    const auto count = static_cast<std::uint32_t>(regions_.size());
    bool added = false;
    for (std::uint32_t r = 0; r < count; ++r) {
      const auto& triangles = now[r].triangles;
      if (triangles.empty() ||
          mean_stretch(surface_, triangles, regions_[r].direction) <= limits_.stretch) {
        continue;
      }
      const std::uint32_t worst = *std::min_element(
          triangles.begin(), triangles.end(), [&](std::uint32_t a, std::uint32_t b) {
            return facing(a, regions_[r]) < facing(b, regions_[r]);
          });
      if (worst == regions_[r].seed) continue;
      regions_.push_back({worst, surface_.smooth[worst]});
      added = true;
    }
    if (seed_uncovered()) added = true;
    if (added) grow();
    return added;
  }

  /// One in each connected part, where it faces its mean.
  bool seed_uncovered() {
    bool found = false;
    std::vector<bool> seen(surface_.size(), false);
    for (std::uint32_t first = 0; first < surface_.size(); ++first) {
      if (region_of_[first] != none || seen[first]) continue;
      const std::vector<std::uint32_t> part = uncovered_part(first, seen);
      Vec3d sum = Vec3d::Zero();
      for (const std::uint32_t t : part) sum += surface_.area[t] * surface_.smooth[t];
      const std::uint32_t seed =
          *std::max_element(part.begin(), part.end(), [&](std::uint32_t a, std::uint32_t b) {
            return surface_.smooth[a].dot(sum) < surface_.smooth[b].dot(sum);
          });
      const Vec3d& direction = surface_.smooth[seed];
      regions_.push_back({seed, direction.isZero() ? Vec3d(Vec3d::UnitZ()) : direction});
      found = true;
    }
    return found;
  }

  std::vector<std::uint32_t> uncovered_part(std::uint32_t first, std::vector<bool>& seen) const {
    std::vector<std::uint32_t> part{first};
    seen[first] = true;
    for (std::size_t i = 0; i < part.size(); ++i) {
      for (std::size_t edge = std::size_t{3} * part[i], end = edge + 3; edge < end; ++edge) {
        const std::uint32_t next = surface_.across[edge];
        if (next == none || seen[next] || region_of_[next] != none) continue;
        seen[next] = true;
        part.push_back(next);
      }
    }
    return part;
  }

  std::vector<AtlasChart> charts() const {
    std::vector<AtlasChart> charts(regions_.size());
    for (std::size_t r = 0; r < charts.size(); ++r) charts[r].direction = regions_[r].direction;
    for (std::uint32_t t = 0; t < surface_.size(); ++t) {
      if (region_of_[t] != none) charts[region_of_[t]].triangles.push_back(t);
    }
    // By hand of a seed that lies in another region now, some are empty.
    return charts;
  }

  const Surface& surface_;
  const ChartLimits& limits_;
  std::vector<std::uint32_t> region_of_;
  std::vector<Region> regions_;
  CostQueue queue_;
};

}  // namespace

std::vector<AtlasChart> partition(const Surface& surface, const ChartLimits& limits) {
  std::vector<AtlasChart> charts = Partition(surface, limits).run();
  std::erase_if(charts, [](const AtlasChart& chart) { return chart.triangles.empty(); });
  return charts;
}

}  // namespace normalshop::unwrapping
