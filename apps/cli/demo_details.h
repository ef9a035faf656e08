#pragma once

#include "normalshop/core/vec.h"

namespace normalshop::demo {

/// What is carved into the demo's head, and its colour, at a point of the surface.
struct Detail {
  Vec3f gradient;  ///< of the height over the surface, in space
  Vec3f color;     ///< linear RGB
};
Detail detail_at(const Vec3f& position, const Vec3f& base_normal);

}  // namespace normalshop::demo
