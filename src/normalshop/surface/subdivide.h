#pragma once

#include "normalshop/surface/mesh.h"

namespace normalshop {

/// Each triangle into four at its edges' midpoints, `times` times (0 copies). The shape stays as it
/// is: positions, UVs and normals are interpolated, normals and tangents made unit again. Triangle
/// t becomes triangles 4 t to 4 t + 3. Throws InvalidInput when corners would not fit into 32 bits.
Mesh subdivide(const Mesh& mesh, int times);

}  // namespace normalshop
