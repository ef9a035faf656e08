#pragma once

#include <array>
#include <span>
#include <vector>

#include "normalshop/core/vec.h"

/// Inside the io floor: polygons of a model file as triangles.
namespace normalshop {

/// Triangles (corner numbers of the polygon) that cover it, in its own sense of rotation. A quad is
/// cut along its shorter diagonal in UV, as MikkTSpace does (equal: the shorter in space, equal
/// again: 0-2), unless that diagonal lies outside; larger polygons by ear clipping in the plane of
/// their area vector (Meisters 1975); above 4096 corners, and where a polygon crosses itself so
/// often that ears are not found in time, convex corners are cut untested. n corners always give n
/// - 2 triangles.
std::vector<std::array<int, 3>> triangulate(std::span<const Vec3f> positions,
                                            std::span<const Vec2f> uvs);

}  // namespace normalshop
