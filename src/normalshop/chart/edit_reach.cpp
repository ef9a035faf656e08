#include "normalshop/chart/edit_reach.h"

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
  for (int y = around.y0; y < around.y1; ++y) {
    std::fill(blocks_.row(y) + around.x0, blocks_.row(y) + around.x1, 0);
  }
  const Rect sources = intersect(grow(around, 1), exact_.rect());
  for (int y = sources.y0; y < sources.y1; ++y) {
    for (int x = sources.x0; x < sources.x1; ++x) {
      if (exact_(x, y) == 0) continue;
      const Rect marked = intersect({x - 1, y - 1, x + 2, y + 2}, around);
      for (int j = marked.y0; j < marked.y1; ++j) {
        std::fill_n(blocks_.row(j) + marked.x0, marked.width(), 1);
      }
    }
  }
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
