#pragma once

#include <algorithm>
#include <cstdint>

#include "normalshop/chart/pull.h"
#include "normalshop/core/parallel.h"

/// Where in its chart an edit acts, private to floor 4.
namespace normalshop {

/// Side of a block of pixels.
inline constexpr int edit_block = 8;

/// The blocks of a chart within which an edit changes something, to skip all others. The chart has
/// its weight: where that is 0 nothing acts.
class EditReach {
 public:
  /// Nothing acts yet.
  explicit EditReach(const EditingChart& chart);
  /// acts(x, y) tells the pixels of the region that the edit changes; it is asked from many
  /// threads.
  template <class Acts>
  EditReach(const EditingChart& chart, const Rect& region, const Acts& acts) : EditReach(chart) {
    region_ = intersect(region, chart.weight.rect());
    update(region_, acts);
  }

  /// Asks anew in all blocks that meet `changed`.
  template <class Acts>
  void update(const Rect& changed, const Acts& acts);

  const ChartGrid& grid() const { return chart_.grid; }
  const EditingChart& chart() const { return chart_; }
  /// Within the chart; nothing acts outside.
  const Rect& region() const { return region_; }
  /// Not 0 for blocks in or beside which the edit acts: bicubic kernels reach two pixels.
  const Image<std::int32_t>& blocks() const { return blocks_; }
  /// May the point of chart pixels, one that the chart sees, be changed?
  bool marked(float x, float y) const {
    // Towards zero: what lies half a pixel outside belongs to the first block.
    return blocks_(static_cast<int>(x) / edit_block, static_cast<int>(y) / edit_block) != 0;
  }
  /// Can any point within this box of chart pixels be changed?
  bool reaches(float x0, float y0, float x1, float y1) const;

 private:
  using Blocks = Image<std::uint8_t>;
  void dilate(const Rect& blocks);

  const EditingChart& chart_;
  Rect region_;
  Blocks exact_;
  Image<std::int32_t> blocks_;  // exact_ and what lies beside
};

template <class Acts>
void EditReach::update(const Rect& changed, const Acts& acts) {
  constexpr int side = edit_block;
  const Rect pixels = intersect(changed, region_);
  if (pixels.empty()) return;
  const Rect blocks{pixels.x0 / side, pixels.y0 / side, (pixels.x1 - 1) / side + 1,
                    (pixels.y1 - 1) / side + 1};
  parallel_for(static_cast<std::size_t>(blocks.height()), 4, [&](std::size_t a, std::size_t b) {
    for (int by = blocks.y0 + static_cast<int>(a); by < blocks.y0 + static_cast<int>(b); ++by) {
      std::uint8_t* row = exact_.row(by);
      std::fill(row + blocks.x0, row + blocks.x1, std::uint8_t{0});
      const Rect part =
          intersect({blocks.x0 * side, by * side, blocks.x1 * side, (by + 1) * side}, region_);
      for (int y = part.y0; y < part.y1; ++y) {
        for (int x = part.x0; x < part.x1; ++x) {
          if (row[x / side] == 0 && chart_.weight(x, y) > 0.0F && acts(x, y)) row[x / side] = 1;
        }
      }
    }
  });
  dilate(blocks);
}

}  // namespace normalshop
