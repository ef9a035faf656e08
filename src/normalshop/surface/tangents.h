#pragma once

#include "normalshop/surface/mesh.h"

namespace normalshop {

/// Fills mesh.tangents as MikkTSpace does with its default settings on triangles (Mikkelsen,
/// "Simulation of Wrinkled Surfaces Revisited", 2008), on (u, 1 - v): w = +1 where the bitangent
/// points up in the map, as in glTF. Corners are one vertex when position, normal and UV are
/// equal; triangles around it that hang together and are turned alike in the map share a tangent,
/// the mean of dP/du weighted by their angles there.
///
/// Triangles without area in the map join any group; triangles with two corners in one place copy
/// the tangent of another triangle at the same corner; where there is none the tangent is (1, 0, 0)
/// and w = -1.
///
/// Linear in the size of the mesh. Throws InvalidInput when the mesh has no UVs or no normals.
void compute_tangents(Mesh& mesh);

}  // namespace normalshop
