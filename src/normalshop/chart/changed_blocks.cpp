#include "normalshop/chart/changed_blocks.h"

#include <algorithm>
#include <cstring>

#include "normalshop/core/parallel.h"

namespace normalshop {

namespace {

int blocks_along(int pixels) { return (pixels + edit_block - 1) / edit_block; }

/// Makes a row of one image that of another. Was it different?
template <class T>
bool copy_row(const T* from, int count, T* to) {
  const std::size_t bytes = static_cast<std::size_t>(count) * sizeof(T);
  if (std::memcmp(from, to, bytes) == 0) return false;
  std::copy_n(from, count, to);
  return true;
}

}  // namespace

ChangedBlocks::ChangedBlocks(SlopeView change, MaskView coverage)
    : change_(change),
      coverage_(coverage),
      last_change_(change.width(), change.height(), Vec2f(0.0F, 0.0F)),
      last_coverage_(coverage.width(), coverage.height(), 0.0F),
      blocks_(blocks_along(change.width()), blocks_along(change.height()), 0) {}

void ChangedBlocks::update(const Rect& pixels) {
  constexpr int side = edit_block;
  for (int y = looked_at_.y0; y < looked_at_.y1; ++y) {
    std::fill(blocks_.row(y) + looked_at_.x0, blocks_.row(y) + looked_at_.x1, std::uint8_t{0});
  }
  looked_at_ = {};
  const Rect all = intersect(pixels, change_.rect());
  if (all.empty()) return;
  looked_at_ = {all.x0 / side, all.y0 / side, blocks_along(all.x1), blocks_along(all.y1)};
  parallel_for(static_cast<std::size_t>(looked_at_.height()), 4, [&](std::size_t a, std::size_t b) {
    for (int y = looked_at_.y0 + static_cast<int>(a); y < looked_at_.y0 + static_cast<int>(b);
         ++y) {
      for (int x = looked_at_.x0; x < looked_at_.x1; ++x) {
        const Rect block{x * side, y * side, (x + 1) * side, (y + 1) * side};
        blocks_(x, y) = take(intersect(block, change_.rect())) ? 1 : 0;
      }
    }
  });
}

/// Was the block different? It is the last one from now on.
bool ChangedBlocks::take(const Rect& block) {
  bool different = false;
  for (int y = block.y0; y < block.y1; ++y) {
    if (copy_row(change_.row(y) + block.x0, block.width(), last_change_.row(y) + block.x0)) {
      different = true;
    }
    if (coverage_.empty()) continue;
    if (copy_row(coverage_.row(y) + block.x0, block.width(), last_coverage_.row(y) + block.x0)) {
      different = true;
    }
  }
  return different;
}

bool ChangedBlocks::meet(float left, float top, float right, float bottom) const {
  constexpr int beyond = 3;  // pixels, of a bicubic kernel
  const auto block = [](float pixel) {
    return static_cast<int>(std::max(pixel, 0.0F)) / edit_block;
  };
  const Rect near = intersect({block(left - beyond), block(top - beyond), block(right + beyond) + 1,
                               block(bottom + beyond) + 1},
                              looked_at_);
  for (int y = near.y0; y < near.y1; ++y) {
    const std::uint8_t* row = blocks_.row(y);
    if (std::find(row + near.x0, row + near.x1, std::uint8_t{1}) != row + near.x1) return true;
  }
  return false;
}

}  // namespace normalshop
