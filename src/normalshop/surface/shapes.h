#pragma once

#include <array>

#include "normalshop/surface/mesh.h"

namespace normalshop {

/// Where a square chart lies in the atlas.
struct ChartSquare {
  Vec2f center;
  float side = 0.1F;
  float degrees = 0.0F;  ///< turned counter-clockwise as seen in the map
};

/// The unit sphere around the origin as a cube blown up: six charts, one a cube face, in the order
/// +x, -x, +y, -y, +z, -z. Unturned, +z lies in the map as it is seen from +z with y up, and the
/// sides stand beside it alike; +y is seen from above with -z up, -y from below with +z up.
/// cells x cells quads a face, spaced by equal angles. Vertices on chart borders are shared, so
/// that positions match exactly. Normals are the sphere's; texture set 0 is called `name`. Throws
/// InvalidInput unless cells is 1 to 2048.
Mesh cube_sphere(int cells, const std::array<ChartSquare, 6>& charts, const std::string& name);

}  // namespace normalshop
