#pragma once

#include <cstddef>
#include <cstdint>

#include "normalshop/surface/mesh.h"
#include "normalshop/surface/texel_map.h"

namespace normalshop {

/// How large a texel is on the surface, in object units a side (the root of its area), over the
/// triangles of one texture set that have area on the surface and in the map. All 0 without any.
struct TexelDensity {
  std::size_t triangles = 0;
  double min = 0.0;
  double max = 0.0;
  double median = 0.0;       ///< of triangles
  double p05 = 0.0;          ///< 5 % of the surface's area has smaller texels
  double area_median = 0.0;  ///< half of the surface's area has
  double p95 = 0.0;          ///< 95 % of the surface's area has
};
TexelDensity texel_density(const Mesh& mesh, std::uint32_t texture_set, int width, int height);

/// How a map's texels are used.
struct TexelUse {
  std::size_t covered = 0;  ///< texels with an owner
  std::size_t shared = 0;   ///< of these, texels of several triangles
  double coverage = 0.0;    ///< covered share of the map
  double overlap = 0.0;     ///< shared share of the covered texels
};
TexelUse texel_use(const TexelMap& map);

}  // namespace normalshop
