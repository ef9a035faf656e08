#pragma once

#include "normalshop/core/for_pixels.h"
#include "normalshop/core/image.h"

/// What the loops of small operators share, private to this floor.
namespace normalshop {

/// An empty mask is 1 everywhere.
inline float mask_at(const MaskView& mask, int x, int y) {
  return mask.empty() ? 1.0F : mask(x, y);
}

}  // namespace normalshop
