#pragma once

#include <vector>

#include "normalshop/surface/detail/texel_bands.h"
#include "normalshop/surface/texel_map.h"
#include "normalshop/surface/topology.h"

namespace normalshop {

/// The gutter of a texel map whose owners are known, by texel; see GutterTexel. Internal to the
/// texel map.
std::vector<GutterTexel> grow_gutter(const Mesh& mesh, const Topology& topology,
                                     const std::vector<TexelAffine>& affines,
                                     const Image<std::uint32_t>& owner, int reach);

}  // namespace normalshop
