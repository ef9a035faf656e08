#pragma once

#include <cstdint>

#include "normalshop/core/image.h"

/// Filling the holes between points, private to floor 4.
namespace normalshop {

/// What a pixel of a chart of points shows.
enum class Shown : std::uint8_t {
  Nothing,
  Point,  ///< a texel's own point
  Hole    ///< surface, but no point: the nearest shows
};

/// Per pixel the index (y * width + x) of the point that it shows: its own, or in a hole the
/// nearest by the larger of both coordinate differences (L-infinity; of equal ones by the Euclidean
/// distance, then the first), on paths through holes. -1 where there is nothing, and where no path
/// leads to a point. A breadth-first search (thesis 5.3.2), whose result does not depend on
/// threads.
Image<std::int32_t> nearest_points(const Image<Shown>& shown);

}  // namespace normalshop
