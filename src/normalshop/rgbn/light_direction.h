#pragma once

#include <cmath>
#include <tuple>

#include "normalshop/core/options.h"
#include "normalshop/core/vec.h"

namespace normalshop {

/// Where the light of a style stands. Base of the options that share these fields.
struct LightDirection {
  float azimuth = 135.0F;
  float elevation = 45.0F;
};

template <class Owner>
constexpr auto light_fields() {
  return std::tuple{
      field<Owner, float>("azimuth", &Owner::azimuth, "degrees", -360.0, 360.0,
                          "Where the light comes from, counter-clockwise: 0 the right, 90 above, "
                          "135 the upper left"),
      field<Owner, float>("elevation", &Owner::elevation, "degrees", 0.0, 90.0,
                          "Height of the light: 0 grazes the picture, 90 stands before it")};
}

/// Unit vector towards the light in view axes (x right, y up, z towards the viewer).
inline Vec3f light_vector(const LightDirection& light) {
  constexpr double degree = 3.14159265358979323846 / 180.0;
  const double azimuth = static_cast<double>(light.azimuth) * degree;
  const double elevation = static_cast<double>(light.elevation) * degree;
  return Vec3d(std::cos(azimuth) * std::cos(elevation), std::sin(azimuth) * std::cos(elevation),
               std::sin(elevation))
      .cast<float>();
}

}  // namespace normalshop
