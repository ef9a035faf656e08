#pragma once

#include "normalshop/surface/mesh.h"

namespace normalshop {

enum class NormalsRule {
  AngleWeighted,  ///< one normal per vertex: the triangles' normals weighted by their angles there
                  ///< (Thürmer and Wüthrich 1998); vertices are welded by position
  Flat            ///< each triangle's own, what glTF asks for where a file has no normals
};

/// Fills mesh.normals. Triangles without area count for nothing and take their vertices' normals;
/// where nothing else is known a normal is (0, 0, 1).
void compute_normals(Mesh& mesh, NormalsRule rule = NormalsRule::AngleWeighted);

}  // namespace normalshop
