#pragma once

#include <algorithm>
#include <cstdint>

#include "normalshop/chart/pull.h"
#include "normalshop/core/parallel.h"

/// Where in its chart an edit acts, private to floor 4.
namespace normalshop {

/// Side of a block of pixels.
inline constexpr int edit_block = 8;

/// The blocks of a chart within which an edit changes something, to skip all others.
class EditReach {
 public:
  /// acts(x, y) tells the pixels of the region that the edit changes; it is asked from many
  /// threads. The chart has its weight: where that is 0 nothing acts.
  template <class Acts>
  EditReach(const EditingChart& chart, const Rect& region, const Acts& acts);

  const ChartGrid& grid() const { return chart_.grid; }
  const EditingChart& chart() const { return chart_; }
  /// Within the chart.
  const Rect& region() const { return region_; }
  /// Not 0 for blocks in or beside which the edit acts: bicubic kernels reach two pixels.
  const Image<std::int32_t>& blocks() const { return blocks_; }
  /// Can any point within this box of chart pixels be changed?
  bool reaches(float x0, float y0, float x1, float y1) const;

 private:
  using Blocks = Image<std::uint8_t>;
  void dilate(const Blocks& exact);

  const EditingChart& chart_;
  Rect region_;
  Image<std::int32_t> blocks_;
};

template <class Acts>
EditReach::EditReach(const EditingChart& chart, const Rect& region, const Acts& acts)
    : chart_(chart), region_(intersect(region, chart.weight.rect())) {
  constexpr int side = edit_block;
  Blocks exact((chart.grid.width() + side - 1) / side, (chart.grid.height() + side - 1) / side, 0);
  parallel_for(static_cast<std::size_t>(exact.height()), 4, [&](std::size_t a, std::size_t b) {
    const int first = std::max(static_cast<int>(a) * side, region_.y0);
    const int last = std::min(static_cast<int>(b) * side, region_.y1);
    for (int y = first; y < last; ++y) {
      std::uint8_t* row = exact.row(y / side);
      for (int x = region_.x0; x < region_.x1; ++x) {
        if (row[x / side] == 0 && chart.weight(x, y) > 0.0F && acts(x, y)) row[x / side] = 1;
      }
    }
  });
  dilate(exact);
}

}  // namespace normalshop
