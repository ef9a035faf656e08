#pragma once

#include <cstdint>

#include "normalshop/chart/pull.h"
#include "normalshop/core/parallel.h"
#include "normalshop/core/pixel_blocks.h"

/// Where in its chart an edit acts, private to floor 4.
namespace normalshop {

/// Side of a block of pixels.
inline constexpr int edit_block = PixelBlocks::side;

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
    PixelBlocks all(chart.weight.width(), chart.weight.height());
    all.reset(region_);
    all.mark_all();
    update(all, acts);
  }

  /// Asks anew in marked blocks.
  template <class Acts>
  void update(const PixelBlocks& changed, const Acts& acts);

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
  /// The same of all points within such a box.
  enum class Marks { None, Some, All };
  Marks marks(float left, float top, float right, float bottom) const;
  /// Can any point within this box of chart pixels be changed?
  bool reaches(float x0, float y0, float x1, float y1) const;

 private:
  using Blocks = Image<std::uint8_t>;
  template <class Acts>
  bool any_acts(int block_x, int block_y, const Acts& acts) const;
  void dilate(const Rect& blocks);

  const EditingChart& chart_;
  Rect region_;
  Blocks exact_;
  Image<std::int32_t> blocks_;  // exact_ and what lies beside
};

template <class Acts>
void EditReach::update(const PixelBlocks& changed, const Acts& acts) {
  const Rect& blocks = changed.blocks();
  parallel_for(static_cast<std::size_t>(blocks.height()), 4, [&](std::size_t a, std::size_t b) {
    for (int y = blocks.y0 + static_cast<int>(a); y < blocks.y0 + static_cast<int>(b); ++y) {
      for (int x = blocks.x0; x < blocks.x1; ++x) {
        if (changed.marked(x, y)) exact_(x, y) = any_acts(x, y, acts) ? 1 : 0;
      }
    }
  });
  dilate(blocks);
}

template <class Acts>
bool EditReach::any_acts(int block_x, int block_y, const Acts& acts) const {
  const int x0 = block_x * edit_block;
  const int y0 = block_y * edit_block;
  const Rect pixels = intersect({x0, y0, x0 + edit_block, y0 + edit_block}, region_);
  for (int y = pixels.y0; y < pixels.y1; ++y) {
    for (int x = pixels.x0; x < pixels.x1; ++x) {
      if (chart_.weight(x, y) > 0.0F && acts(x, y)) return true;
    }
  }
  return false;
}

}  // namespace normalshop
