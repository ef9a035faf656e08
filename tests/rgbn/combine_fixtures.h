#pragma once

#include <array>
#include <cmath>

#include "support/slope_fields.h"
#include <Eigen/Geometry>

#include "normalshop/rgbn/combine.h"

/// What the tests of combination share. Angles are degrees, normals unit in chart axes.
namespace normalshop::test {

inline constexpr double degree = 3.14159265358979323846 / 180.0;

inline constexpr std::array<CombineModel, 6> all_models{
    CombineModel::Linear,   CombineModel::Rotation, CombineModel::Reoriented,
    CombineModel::Whiteout, CombineModel::Udn,      CombineModel::Overlay};

inline Vec3d normal(const Vec2f& slope) {
  return Vec3d(-static_cast<double>(slope.x()), -static_cast<double>(slope.y()), 1.0).normalized();
}

inline double degrees_between(const Vec3d& a, const Vec3d& b) {
  return 2.0 * std::atan2((a - b).norm(), (a + b).norm()) / degree;
}

/// Slopes of the normal that is tilted so far towards an azimuth.
inline Vec2f tilted_slope(double tilt, double azimuth) {
  const double slope = -std::tan(tilt * degree);
  return Vec2d(slope * std::cos(azimuth * degree), slope * std::sin(azimuth * degree))
      .cast<float>();
}

inline Vec2f combined(const Vec2f& base, const Vec2f& details, CombineModel model) {
  SlopeImage target(1, 1, base);
  const SlopeImage image(1, 1, details);
  combine(target, image, {}, target, target.rect(), {.model = model});
  return target(0, 0);
}

inline Vec2f rnm(const Vec2f& base, const Vec2f& details) {
  return combined(base, details, CombineModel::Reoriented);
}

/// Random slopes, most of them gentle and some nearly at the horizon.
inline SlopeImage random_slopes(int width, int height, std::uint32_t seed, float steepest = 45.0F) {
  SlopeImage image(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const auto bits = hash(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y), seed);
      const auto unit = [&](std::uint32_t b) { return static_cast<float>(b & 0xffffU) * 0x1p-16F; };
      const float azimuth = 6.2831853F * unit(bits);
      const float size = steepest * std::pow(unit(bits >> 16U), 4.0F);
      image(x, y) = {size * std::cos(azimuth), size * std::sin(azimuth)};
    }
  }
  return image;
}

/// The rotation of n_h into the frame of n, with the axis and the angle spelled out.
inline Vec3d rotated_by_hand(const Vec3d& v, const Vec3d& from, const Vec3d& to) {
  const Vec3d axis = from.cross(to);
  if (axis.norm() < 1e-15) return v;
  const double angle = std::atan2(axis.norm(), from.dot(to));
  return Eigen::AngleAxisd(angle, axis.normalized()) * v;
}

}  // namespace normalshop::test
