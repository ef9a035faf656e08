#pragma once

#include "normalshop/core/normal_map.h"
#include "normalshop/surface/mesh.h"

namespace normalshop {

/// A point of a triangle: weights of its corners 1 and 2 (corner 0 has the rest). Extrapolates.
struct SurfacePoint {
  std::uint32_t triangle = 0;
  float b1 = 0.0F;
  float b2 = 0.0F;
};

template <class T>
T interpolate(const T& corner0, const T& corner1, const T& corner2, float b1, float b2) {
  return corner0 * (1.0F - b1 - b2) + corner1 * b1 + corner2 * b2;
}

/// The linear map from a map's vectors to object space at one surface point, as renderers build it:
/// columns vT, vB = w cross(vN, vT), vN, interpolated and NOT normalised (MikkTSpace's contract).
/// Mesh::node_frame() for object-space maps, the identity for world-space ones.
struct TangentFrame {
  Mat3f to_object = Mat3f::Identity();

  /// Unit object-space normal of a map-space vector; zero for zero.
  Vec3f object_normal(const Vec3f& map_vector) const;
  /// Unit map-space normal of an object-space normal: the exact inverse of object_normal().
  Vec3f map_normal(const Vec3f& object_normal) const;
};

/// An orthonormal frame around a direction, its third column, which need not be unit; around z for
/// the zero vector.
Mat3f any_frame(const Vec3d& normal);

Vec3f position_at(const Mesh& mesh, const SurfacePoint& point);
/// Unit base normal N^b.
Vec3f base_normal_at(const Mesh& mesh, const SurfacePoint& point);
/// Needs mesh.tangents for tangent space. Where corners' tangents cancel or are parallel to the
/// normal, any orthonormal frame around the base normal.
TangentFrame frame_at(const Mesh& mesh, const SurfacePoint& point, NormalSpace space);

}  // namespace normalshop
