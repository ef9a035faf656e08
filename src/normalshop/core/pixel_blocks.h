#pragma once

#include <algorithm>
#include <cstdint>

#include "normalshop/core/image.h"

namespace normalshop {

/// Which blocks of an image's pixels are marked. Blocks begin at the image's first pixel; those at
/// its right and lower border may be narrower. Different blocks may be marked by different threads
/// at once.
class PixelBlocks {
 public:
  static constexpr int side = 8;

  PixelBlocks(int width, int height)
      : pixels_{0, 0, width, height}, marks_(along(width), along(height), 0) {}

  /// Takes all marks away. Until the next time only blocks that meet these pixels get any.
  void reset(const Rect& pixels) {
    for (int y = blocks_.y0; y < blocks_.y1; ++y) {
      std::fill(marks_.row(y) + blocks_.x0, marks_.row(y) + blocks_.x1, std::uint8_t{0});
    }
    region_ = intersect(pixels, pixels_);
    if (region_.empty()) region_ = {};
    blocks_ = {region_.x0 / side, region_.y0 / side, along(region_.x1), along(region_.y1)};
  }
  void mark(int block_x, int block_y) { marks_(block_x, block_y) = 1; }
  /// Marks all that may be.
  void mark_all() {
    for (int y = blocks_.y0; y < blocks_.y1; ++y) {
      std::fill(marks_.row(y) + blocks_.x0, marks_.row(y) + blocks_.x1, std::uint8_t{1});
    }
  }
  bool marked(int block_x, int block_y) const { return marks_(block_x, block_y) != 0; }

  /// What the marked blocks lie in, in blocks.
  const Rect& blocks() const { return blocks_; }
  /// The pixels of a block that reset() told.
  Rect pixels(int block_x, int block_y) const {
    return intersect({block_x * side, block_y * side, (block_x + 1) * side, (block_y + 1) * side},
                     region_);
  }
  /// Those that reset() told, within the image.
  const Rect& region() const { return region_; }
  /// Is any marked that lies within so many pixels of a box?
  bool any_near(float left, float top, float right, float bottom, float beyond) const {
    const auto block = [](float pixel) {
      return pixel > 0.0F ? static_cast<int>(std::min(pixel, 1e6F)) / side : 0;
    };
    return any({block(left - beyond), block(top - beyond), block(right + beyond) + 1,
                block(bottom + beyond) + 1});
  }

 private:
  bool any(const Rect& blocks) const {
    const Rect near = intersect(blocks, blocks_);
    for (int y = near.y0; y < near.y1; ++y) {
      const std::uint8_t* row = marks_.row(y);
      for (int x = near.x0; x < near.x1; ++x) {
        if (row[x] != 0) return true;
      }
    }
    return false;
  }
  static int along(int pixels) { return (pixels + side - 1) / side; }

  Rect pixels_;
  Rect region_;
  Rect blocks_;
  Image<std::uint8_t> marks_;
};

}  // namespace normalshop
