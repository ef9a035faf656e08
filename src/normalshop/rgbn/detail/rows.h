#pragma once

#include "normalshop/core/image.h"
#include "normalshop/core/parallel.h"

/// Loops that small operators share, private to this floor.
namespace normalshop {

/// body(x, y) for all pixels of a rectangle, rows in parallel.
template <class Body>
void for_pixels(const Rect& region, const Body& body) {
  parallel_for(static_cast<std::size_t>(region.height()), 32, [&](std::size_t a, std::size_t b) {
    for (std::size_t i = a; i < b; ++i) {
      const int y = region.y0 + static_cast<int>(i);
      for (int x = region.x0; x < region.x1; ++x) body(x, y);
    }
  });
}

/// An empty mask is 1 everywhere.
inline float mask_at(const MaskView& mask, int x, int y) {
  return mask.empty() ? 1.0F : mask(x, y);
}

}  // namespace normalshop
