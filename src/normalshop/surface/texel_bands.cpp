#include "normalshop/surface/detail/texel_bands.h"

#include <algorithm>

namespace normalshop {
namespace {

/// visit(band) once for every band that a range of rows touches.
template <class F>
void for_each_band(const GridRange& rows, int height, const F& visit) {
  if (rows.size() <= 0) return;
  const auto bands = static_cast<std::int64_t>(band_count(height));
  const std::int64_t first_row = rows.size() >= height ? 0 : wrap(rows.begin, height);
  const std::int64_t last_row = first_row + std::min<std::int64_t>(rows.size(), height) - 1;
  const std::int64_t first = first_row / band_rows;
  const std::int64_t last = std::min<std::int64_t>(last_row / band_rows, bands - 1);
  for (std::int64_t band = first; band <= last; ++band) visit(static_cast<std::size_t>(band));
  if (last_row < height) return;
  const std::int64_t last_wrapped = std::min((last_row - height) / band_rows, first - 1);
  for (std::int64_t band = 0; band <= last_wrapped; ++band) visit(static_cast<std::size_t>(band));
}

}  // namespace

Bands::Bands(std::span<const GridRange> rows, int height) : start_(band_count(height) + 1, 0) {
  for (const GridRange& range : rows) {
    for_each_band(range, height, [&](std::size_t band) { ++start_[band + 1]; });
  }
  for (std::size_t band = 1; band < start_.size(); ++band) start_[band] += start_[band - 1];
  items_.resize(start_.back());
  std::vector<std::size_t> cursor(start_.begin(), start_.end() - 1);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for_each_band(rows[i], height, [&](std::size_t band) {
      items_[cursor[band]++] = static_cast<std::uint32_t>(i);
    });
  }
}

}  // namespace normalshop
