#pragma once

#include "normalshop/core/normal_map.h"
#include "normalshop/surface/mesh.h"
#include "normalshop/surface/texel_map.h"

namespace normalshop {

/// The map with its normals expressed in another space, as codes of `type`, edits included. Texels
/// of triangles and of the gutter are converted by their frames; texels that show no surface become
/// (0, 0, 1). Tangent space needs mesh.tangents. `texels` must have the map's size.
RawImage convert_space(const Mesh& mesh, const TexelMap& texels, const NormalMap& map,
                       const NormalConvention& to, CodeType type);

}  // namespace normalshop
