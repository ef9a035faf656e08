#pragma once

#include "normalshop/surface/frames.h"

namespace normalshop {

/// The surface point nearest to a position; the first of several. Triangles with two corners in one
/// place don't count. Throws InvalidInput when no triangle has a place (none, or corners that are
/// not numbers). Linear in the size of the mesh.
SurfacePoint nearest_surface_point(const Mesh& mesh, const Vec3f& position);

}  // namespace normalshop
