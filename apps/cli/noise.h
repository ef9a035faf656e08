#pragma once

#include <cstdint>

#include "jet.h"

/// Procedural noise with its gradient. The same numbers on every machine and in any order.
namespace normalshop::demo {

/// Gradient noise (Perlin 2002), about -1 to 1, one feature per unit.
Jet noise(const JetPoint& p, std::uint32_t seed);
/// Octaves of it, each twice as fine and `gain` times as strong as the one before.
Jet fractal_noise(const JetPoint& p, int octaves, float gain, std::uint32_t seed);

/// Round pits, at most one in each unit cell, in a part `share` of the cells: 0 on the surface, to
/// -1 at the bottom of the deepest.
Jet pits(const JetPoint& p, float share, std::uint32_t seed);

/// Dishes side by side, as an adze leaves them: squared distance to the nearest of scattered
/// points, one per unit cell; 0 at a dish's bottom.
Jet dishes(const JetPoint& p, std::uint32_t seed);

}  // namespace normalshop::demo
