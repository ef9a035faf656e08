#pragma once

#include <cstdint>

#include "normalshop/core/image.h"
#include "normalshop/core/random.h"

namespace normalshop {

/// A square of slopes from 0 to 1, each independent of its neighbours.
inline SlopeImage noise_image(int side) {
  SlopeImage image(side, side);
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      const auto bits = hash(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y), 1U);
      image(x, y) = {static_cast<float>(bits & 0xffffU) * 0x1p-16F,
                     static_cast<float>(bits >> 16U) * 0x1p-16F};
    }
  }
  return image;
}

}  // namespace normalshop
