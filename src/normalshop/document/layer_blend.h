#pragma once

#include "normalshop/core/normal_map.h"
#include "normalshop/document/edit_stack.h"

namespace normalshop {

/// A normal of a layer above one of what is below, both unit: opacity 0 gives the lower one, 1 the
/// upper. Linear mixes slopes in tangent space (where both normals point up) and vectors
/// elsewhere; Rotation turns the lower one by a share of the angle.
Vec3f blend_normals(const Vec3f& below, const Vec3f& above, float opacity, LayerBlend blend,
                    NormalSpace space);

}  // namespace normalshop
