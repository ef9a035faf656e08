#include "normalshop/chart/edit_reach.h"

#include <algorithm>
#include <vector>

#include "normalshop/core/rect.h"
#include "normalshop/core/sample.h"

namespace normalshop {

EditReach::EditReach(const EditingChart& chart)
    : chart_(chart),
      region_(chart.weight.rect()),
      exact_((chart.grid.width() + edit_block - 1) / edit_block,
             (chart.grid.height() + edit_block - 1) / edit_block, 0),
      blocks_(exact_.width(), exact_.height(), 0) {}

/// Brings blocks_ up to date where the blocks of exact_ have changed.
void EditReach::dilate(const Rect& blocks) {
  const Rect around = intersect(grow(blocks, 1), exact_.rect());
  std::vector<std::uint8_t> column(static_cast<std::size_t>(exact_.width()) + 2, 0);
  for (int y = around.y0; y < around.y1; ++y) {
    const std::uint8_t* above = exact_.row(std::max(y - 1, 0));
    const std::uint8_t* here = exact_.row(y);
    const std::uint8_t* below = exact_.row(std::min(y + 1, exact_.height() - 1));
    const int first = std::max(around.x0 - 1, 0);
    const int end = std::min(around.x1 + 1, exact_.width());
    std::uint8_t* any = column.data() + 1;
    for (int x = first; x < end; ++x) {
      any[x] = static_cast<std::uint8_t>(above[x] | here[x] | below[x]);
    }
    std::int32_t* marks = blocks_.row(y);
    for (int x = around.x0; x < around.x1; ++x) marks[x] = any[x - 1] | any[x] | any[x + 1];
  }
}

EditReach::Marks EditReach::marks(float left, float top, float right, float bottom) const {
  const auto block = [](float pixel) { return static_cast<int>(pixel) / edit_block; };
  int count = 0;
  int marked = 0;
  for (int y = block(top); y <= block(bottom); ++y) {
    for (int x = block(left); x <= block(right); ++x) {
      ++count;
      marked += blocks_(x, y) != 0 ? 1 : 0;
    }
  }
  return marked == 0 ? Marks::None : marked == count ? Marks::All : Marks::Some;
}

bool EditReach::reaches(float x0, float y0, float x1, float y1) const {
  // Whatever a stray vertex gives stays within what int holds.
  const auto bounded = [](float v) { return v > -1.0F ? std::min(v, 1e6F) : -1.0F; };
  const Rect pixels =
      intersect({floor_to_int(bounded(x0)), floor_to_int(bounded(y0)),
                 static_cast<int>(bounded(x1)) + 1, static_cast<int>(bounded(y1)) + 1},
                chart_.ids.depth.rect());
  if (pixels.empty()) return false;
  for (int y = pixels.y0 / edit_block; y <= (pixels.y1 - 1) / edit_block; ++y) {
    for (int x = pixels.x0 / edit_block; x <= (pixels.x1 - 1) / edit_block; ++x) {
      if (blocks_(x, y) != 0) return true;
    }
  }
  return false;
}

}  // namespace normalshop
