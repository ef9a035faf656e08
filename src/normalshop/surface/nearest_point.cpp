#include "normalshop/surface/nearest_point.h"

#include <limits>

#include "normalshop/core/error.h"

namespace normalshop {

namespace {

/// Weights of corners 1 and 2 at the point of a triangle nearest to p (Ericson 2004, 5.1.5).
Vec2f nearest_weights(const Vec3f& p, const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  const Vec3f ab = b - a;
  const Vec3f ac = c - a;
  const float d1 = ab.dot(p - a);
  const float d2 = ac.dot(p - a);
  if (d1 <= 0 && d2 <= 0) return {0, 0};
  const float d3 = ab.dot(p - b);
  const float d4 = ac.dot(p - b);
  if (d3 >= 0 && d4 <= d3) return {1, 0};
  const float vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return {d1 / (d1 - d3), 0};
  const float d5 = ab.dot(p - c);
  const float d6 = ac.dot(p - c);
  if (d6 >= 0 && d5 <= d6) return {0, 1};
  const float vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return {0, d2 / (d2 - d6)};
  const float va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6) {
    const float w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {1 - w, w};
  }
  const float sum = va + vb + vc;
  return sum > 0 ? Vec2f(vb / sum, vc / sum) : Vec2f(0, 0);
}

/// Of those with two corners in one place no way leads on; others reach as far.
bool has_two_corners_in_one_place(const Mesh& mesh, std::size_t t) {
  const Vec3f& a = mesh.position(3 * t);
  const Vec3f& b = mesh.position(3 * t + 1);
  const Vec3f& c = mesh.position(3 * t + 2);
  return a == b || b == c || c == a;
}

}  // namespace

SurfacePoint nearest_surface_point(const Mesh& mesh, const Vec3f& position) {
  SurfacePoint best;
  float smallest = std::numeric_limits<float>::max();
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    if (has_two_corners_in_one_place(mesh, t)) continue;
    const Vec2f w = nearest_weights(position, mesh.position(3 * t), mesh.position(3 * t + 1),
                                    mesh.position(3 * t + 2));
    const SurfacePoint point{static_cast<std::uint32_t>(t), w.x(), w.y()};
    const float distance = (position_at(mesh, point) - position).squaredNorm();
    if (!(distance < smallest)) continue;
    smallest = distance;
    best = point;
  }
  if (smallest == std::numeric_limits<float>::max()) {
    throw InvalidInput("the model has no triangle that a point could lie on");
  }
  return best;
}

}  // namespace normalshop
