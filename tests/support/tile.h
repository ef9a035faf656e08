#pragma once

#include "normalshop/core/vec.h"

namespace normalshop::test {

/// From one pixel of a tile to another, the short way round its sides.
inline Vec2i way_in_tile(const Vec2i& from, const Vec2i& to, int width, int height) {
  return {(to.x() - from.x() + width + width / 2) % width - width / 2,
          (to.y() - from.y() + height + height / 2) % height - height / 2};
}

}  // namespace normalshop::test
