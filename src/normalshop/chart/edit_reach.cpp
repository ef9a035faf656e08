#include "normalshop/chart/edit_reach.h"

#include "normalshop/core/sample.h"

namespace normalshop {

void EditReach::dilate(const Blocks& exact) {
  blocks_ = Image<std::int32_t>(exact.width(), exact.height(), 0);
  for (int y = 0; y < exact.height(); ++y) {
    for (int x = 0; x < exact.width(); ++x) {
      if (exact(x, y) == 0) continue;
      const Rect around = intersect({x - 1, y - 1, x + 2, y + 2}, exact.rect());
      for (int j = around.y0; j < around.y1; ++j) {
        std::fill_n(blocks_.row(j) + around.x0, around.width(), 1);
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
