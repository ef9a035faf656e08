#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "normalshop/core/vec.h"

/// Internal to the texel map: a map's texels as a grid without borders, of which the map is one
/// period. Work on it is split into bands of rows, each of which one thread fills in the order of
/// the items, so that the result does not depend on threads.
namespace normalshop {

inline constexpr int band_rows = 32;

struct Period {
  int width = 0;
  int height = 0;
  Vec2d texels(const Vec2f& uv) const {
    return {static_cast<double>(uv.x()) * width, static_cast<double>(uv.y()) * height};
  }
};

/// Half-open range of rows or columns of the grid.
struct GridRange {
  std::int64_t begin = 0;
  std::int64_t end = 0;
  std::int64_t size() const { return end - begin; }
};

constexpr std::int64_t wrap(std::int64_t i, std::int64_t period) {
  const std::int64_t r = i % period;
  return r < 0 ? r + period : r;
}

/// Smallest i >= from with i == row modulo period.
constexpr std::int64_t first_at_or_after(std::int64_t from, std::int64_t row, std::int64_t period) {
  return from + wrap(row - from, period);
}

inline std::size_t band_count(int height) {
  return static_cast<std::size_t>((height + band_rows - 1) / band_rows);
}

/// Which items (by their rows) touch which band, ascending within each.
class Bands {
 public:
  Bands(std::span<const GridRange> rows, int height);
  std::span<const std::uint32_t> items(std::size_t band) const {
    return std::span(items_).subspan(start_[band], start_[band + 1] - start_[band]);
  }

 private:
  std::vector<std::size_t> start_;
  std::vector<std::uint32_t> items_;
};

}  // namespace normalshop
