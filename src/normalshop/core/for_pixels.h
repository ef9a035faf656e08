#pragma once

#include "normalshop/core/parallel.h"
#include "normalshop/core/rect.h"

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

}  // namespace normalshop
