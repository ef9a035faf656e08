#pragma once

#include <algorithm>
#include <cmath>

#include "normalshop/core/vec.h"

/// Normals as slopes. All vectors are in one orthonormal frame; "chart axes" means x right, y up,
/// z towards the viewer. Sources: thesis 2.2 and 4.8, Mikkelsen 2020 (surface gradients).
namespace normalshop {

/// Steepest slope that a chart holds: beyond it a normal counts as on the horizon.
inline constexpr float max_slope = 50.0F;

/// Smallest <n, d> for which a gradient with respect to d exists; below it n is treated as if it
/// had this component, which keeps its azimuth.
inline constexpr float min_cosine = 1.0F / max_slope;

/// Slopes (z_x, z_y) of a normal in chart axes; n need not be unit. Saturates at the horizon.
inline Vec2f slope_from_normal(const Vec3f& n) {
  const float z = std::max(n.z(), min_cosine * n.norm());
  return z > 0.0F ? Vec2f(-n.x() / z, -n.y() / z) : Vec2f(0.0F, 0.0F);
}

/// Unit normal (-z_x, -z_y, 1) / W in chart axes.
inline Vec3f normal_from_slope(const Vec2f& slope) {
  const float inverse = 1.0F / std::sqrt(1.0F + slope.squaredNorm());
  return {-slope.x() * inverse, -slope.y() * inverse, inverse};
}

/// Angle in degrees between two directions (exact for small angles too).
inline double angle_degrees(const Vec3f& a, const Vec3f& b) {
  const Vec3d u = a.cast<double>().normalized();
  const Vec3d v = b.cast<double>().normalized();
  return 2.0 * std::atan2((u - v).norm(), (u + v).norm()) * (180.0 / 3.14159265358979323846);
}

}  // namespace normalshop
