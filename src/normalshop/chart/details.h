#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <string_view>

#include "normalshop/core/slope.h"

namespace normalshop {

/// Which direction an edit displaces along.
enum class EditMode {
  View,  ///< the viewing direction: the two numbers are slopes z_x, z_y
  Base,  ///< the base normal N^b: the two numbers are h_u, h_v over chart x, y
  Along  ///< any fixed direction: the two numbers are h_u, h_v likewise
};
constexpr auto names_of(EditMode) {
  return std::array<std::string_view, 3>{"view", "base", "along"};
}

/// Below this cosine between base normal and the viewing direction, or that of Along, a surface
/// point is left alone, whatever the weight of the chart says.
inline constexpr float grazing_cosine = 0.05F;

/// A mode with what it needs; one that is no Along converts by itself.
struct EditDirection {
  EditMode mode = EditMode::View;
  Vec3f along = Vec3f::UnitZ();  ///< of Along: unit, in the frame of the normals

  EditDirection() = default;
  EditDirection(EditMode m) : mode(m) { assert(m != EditMode::Along); }
  explicit EditDirection(const Vec3f& d) : mode(EditMode::Along), along(d.normalized()) {}
};

/// The conversion between a normal and the two numbers that operators see, at one surface point
/// whose unit base normal in chart axes is `base` (base.z > 0). All normals are in chart axes.
///
/// View: slopes of n. Base and Along displace the base point b to f = b + h d, with d = base or the
/// fixed direction: h_u = -<b_u, n> / <d, n> with b_u = (1, 0, -base.x / base.z), likewise v.
/// (Thesis 4.3 takes f_u = (1, 0, -n.x / n.z), which is that of the pixel and not of the base point
/// that moves: on tilted surface it does not return what went in.) Along the viewing direction h_u
/// is the slope less that of the base. All are the surface gradient of n with respect to one
/// direction, the tangent plane method of thesis 4.8, and return what went in. Along needs
/// <d, base> > 0. Saturates at the horizon of the direction, where <d, n> = 0.
inline Vec2f gradient_from_normal(const Vec3f& n, const Vec3f& base,
                                  const EditDirection& direction) {
  if (direction.mode == EditMode::View) return slope_from_normal(n);
  // In double: on steep bases rounding in float alone would turn the normal by 3e-5 degrees.
  const Vec3d normal = n.cast<double>();
  const Vec3d b = base.cast<double>().normalized();
  const bool fixed = direction.mode == EditMode::Along;
  const double along = normal.dot(b);
  const double facing = fixed ? normal.dot(direction.along.cast<double>()) : along;
  const double cosine = std::max(facing, static_cast<double>(min_cosine) * normal.norm());
  if (!(cosine > 0.0)) return {0.0F, 0.0F};
  const Vec3d sg = (along * b - normal) / cosine;
  const double rise = sg.z() / std::max(b.z(), static_cast<double>(min_cosine));
  return {static_cast<float>(sg.x() - b.x() * rise), static_cast<float>(sg.y() - b.y() * rise)};
}

/// f_u x f_v of f_u = b_u + h_u d, f_v = b_v + h_v d, which is (1 + <w, d>) base - <base, d> w with
/// w = (h_u, h_v, 0). Along a fixed direction that is exact; along the base normal the term h N_u
/// is dropped: it is small while h is small beside the base surface's radius of curvature.
inline Vec3f normal_from_gradient(const Vec2f& gradient, const Vec3f& base,
                                  const EditDirection& direction) {
  if (direction.mode == EditMode::View) return normal_from_slope(gradient);
  const Vec3d b = base.cast<double>().normalized();
  const Vec3d d = direction.mode == EditMode::Along ? Vec3d(direction.along.cast<double>()) : b;
  const Vec3d w(static_cast<double>(gradient.x()), static_cast<double>(gradient.y()), 0.0);
  return ((1.0 + w.dot(d)) * b - b.dot(d) * w).normalized().cast<float>();
}

/// The numbers of the base surface alone: its slopes, or (0, 0).
inline Vec2f base_gradient(const Vec3f& base, const EditDirection& direction) {
  return direction.mode == EditMode::View ? slope_from_normal(base) : Vec2f(0.0F, 0.0F);
}

}  // namespace normalshop
