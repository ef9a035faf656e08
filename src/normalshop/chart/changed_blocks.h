#pragma once

#include <cstdint>

#include "normalshop/chart/edit_reach.h"
#include "normalshop/core/image.h"
#include "normalshop/core/rect.h"

/// What has become different in a growing edit, private to floor 4.
namespace normalshop {

/// Remembers an edit's pixels, to tell in which blocks of them (of edit_block pixels a side) it has
/// changed since the last time.
class ChangedBlocks {
 public:
  /// Both are 0 now and read by each update(); coverage may be empty.
  ChangedBlocks(SlopeView change, MaskView coverage);

  /// Looks at these pixels again, given that no others are different.
  void update(const Rect& pixels);
  /// Was anything different the last time in or near this box of chart pixels?
  bool meet(float left, float top, float right, float bottom) const;

 private:
  bool take(const Rect& block);

  SlopeView change_;
  MaskView coverage_;
  SlopeImage last_change_;
  MaskImage last_coverage_;
  Rect looked_at_;  // blocks
  Image<std::uint8_t> blocks_;
};

}  // namespace normalshop
