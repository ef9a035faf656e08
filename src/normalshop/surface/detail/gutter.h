#pragma once

#include <vector>

#include "normalshop/surface/detail/texel_bands.h"
#include "normalshop/surface/texel_map.h"
#include "normalshop/surface/topology.h"

namespace normalshop {

/// What the gutter grows from.
struct GutterGround {
  const Mesh& mesh;
  const Topology& topology;
  const std::vector<TexelAffine>& affines;
  const Image<std::uint32_t>& owner;
  bool repeats;   ///< what lies beyond the map's border is its other side
  bool overlaps;  ///< charts lie on each other: borders may too
};

/// The gutter of a texel map whose owners are known, by texel; see TexelMap::gutter(). Internal to
/// the texel map.
std::vector<GutterTexel> grow_gutter(const GutterGround& ground, int reach);

}  // namespace normalshop
