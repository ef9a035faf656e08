#pragma once

#include "normalshop/core/pixel_blocks.h"
#include "normalshop/document/operate.h"

/// Private to this floor.
namespace normalshop {

/// A part of a result before it is made anew.
class RegionBefore {
 public:
  void take(const Rect& region, const OperatorResult& result);
  /// Marks the blocks of the same region that are not what they were.
  void mark_different(const OperatorResult& result, PixelBlocks& drawn) const;

 private:
  SlopeImage change_;
  MaskImage coverage_;
};

}  // namespace normalshop
