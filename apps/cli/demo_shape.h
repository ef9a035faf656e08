#pragma once

#include "jet.h"

namespace normalshop::demo {

/// Heights on the head that shape and carving share. Front +z, up +y; about 2.3 units tall.
/// Height along the band around the head; the band lies where it is between the two limits.
inline Jet band_level(const JetPoint& p) { return p.y - p.z * 0.12F; }
inline constexpr float band_low = 0.37F;
inline constexpr float band_high = 0.56F;

/// Below 0 inside the stone, above 0 outside, with its gradient: about a distance.
Jet head_distance(const Vec3f& p);

/// The surface point farthest from the origin in that direction, and the unit normal there.
struct HeadPoint {
  Vec3f position;
  Vec3f normal;
};
HeadPoint head_point(const Vec3f& direction);

}  // namespace normalshop::demo
