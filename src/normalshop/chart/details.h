#pragma once

#include <array>
#include <string_view>

#include "normalshop/core/slope.h"

namespace normalshop {

/// Which direction an edit displaces along.
enum class EditMode {
  View,  ///< along the viewing direction: the two numbers are slopes z_x, z_y
  Base   ///< along the base normal N^b: the two numbers are h_u, h_v over chart x, y
};
constexpr auto names_of(EditMode) { return std::array<std::string_view, 2>{"view", "base"}; }

/// The conversion between a normal and the two numbers that operators see, at one surface point
/// whose unit base normal in chart axes is `base` (base.z > 0). All normals are in chart axes.
///
/// View: slopes of n. Base: h_u = -<b_u, n> / <base, n> with b_u = (1, 0, -base.x / base.z),
/// likewise v. (Thesis 4.3 takes f_u = (1, 0, -n.x / n.z), which is that of the pixel and not of
/// the base point that moves: on tilted surface it does not return what went in.) Both modes are
/// the surface gradient of n with respect to one direction, and both return what went in. Saturates
/// at the horizon of that direction.
inline Vec2f gradient_from_normal(const Vec3f& n, const Vec3f& base, EditMode mode) {
  if (mode == EditMode::View) return slope_from_normal(n);
  // In double: on steep bases rounding in float alone would turn the normal by 3e-5 degrees.
  const Vec3d normal = n.cast<double>();
  const Vec3d b = base.cast<double>().normalized();
  const double along = normal.dot(b);
  const double cosine = std::max(along, static_cast<double>(min_cosine) * normal.norm());
  if (!(cosine > 0.0)) return {0.0F, 0.0F};
  const Vec3d sg = (along * b - normal) / cosine;
  const double rise = sg.z() / std::max(b.z(), static_cast<double>(min_cosine));
  return {static_cast<float>(sg.x() - b.x() * rise), static_cast<float>(sg.y() - b.y() * rise)};
}

/// Base: the tangential vector with <sg, b_u> = h_u and <sg, b_v> = h_v subtracted from the base
/// normal, which is f_u x f_v for f_u = b_u + h_u N. The term h N_u is dropped: it is small while h
/// is small beside the base surface's radius of curvature.
inline Vec3f normal_from_gradient(const Vec2f& gradient, const Vec3f& base, EditMode mode) {
  if (mode == EditMode::View) return normal_from_slope(gradient);
  const Vec3d b = base.cast<double>().normalized();
  const Vec2d g = gradient.cast<double>();
  const double along = g.x() * b.x() + g.y() * b.y();
  const Vec3d sg(g.x() - along * b.x(), g.y() - along * b.y(), -along * b.z());
  return (b - sg).normalized().cast<float>();
}

/// The numbers of the base surface alone: its slopes, or (0, 0).
inline Vec2f base_gradient(const Vec3f& base, EditMode mode) {
  return mode == EditMode::View ? slope_from_normal(base) : Vec2f(0.0F, 0.0F);
}

}  // namespace normalshop
