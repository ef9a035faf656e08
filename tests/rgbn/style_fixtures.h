#pragma once

#include <cmath>

#include "normalshop/core/color_map.h"
#include "normalshop/core/image.h"
#include "normalshop/core/slope.h"

/// Pictures of analytic surfaces for the tests of curvature and styles. Points (x, y) are pixels
/// from the middle, y up.
namespace normalshop::test {

template <class NormalAt>
Image<Vec3f> picture_of(int width, int height, const NormalAt& normal_at) {
  Image<Vec3f> out(width, height);
  for (int j = 0; j < height; ++j) {
    for (int i = 0; i < width; ++i) {
      out(i, j) =
          normal_at(static_cast<double>(i - width / 2), static_cast<double>(height / 2 - j));
    }
  }
  return out;
}

/// Normal of a height with these slopes.
inline Vec3f tilted(double z_x, double z_y) {
  return Vec3d(-z_x, -z_y, 1.0).normalized().cast<float>();
}

/// A ball of this radius; nothing around it.
inline Image<Vec3f> ball(int size, double radius) {
  return picture_of(size, size, [&](double x, double y) {
    const double z2 = radius * radius - x * x - y * y;
    if (z2 <= 0.0) return Vec3f(Vec3f::Zero());
    return Vec3f((Vec3d(x, y, std::sqrt(z2)) / radius).cast<float>());
  });
}

/// A picture with creases, steps in depth and gaps, for comparing runs with each other.
inline Image<Vec3f> lively(int width, int height) {
  return picture_of(width, height, [&](double x, double y) {
    const double r2 = (x + 20.0) * (x + 20.0) + y * y;
    if (r2 < 900.0) {
      return Vec3f((Vec3d(x + 20.0, y, std::sqrt(900.0 - r2)) / 30.0).cast<float>());
    }
    if (x > 60.0) return Vec3f(Vec3f::Zero());
    return tilted(0.8 * std::cos(0.15 * x) + (y > 10.0 ? 0.7 : -0.2), 0.6 * std::sin(0.11 * y));
  });
}

/// How light a grey looks.
inline float tone(const Vec3f& color) { return linear_to_srgb(color.y()); }

inline bool same(float a, float b) { return a == b; }
inline bool same(const Vec3f& a, const Vec3f& b) { return a == b; }

/// Whether the images agree bit for bit in the region.
template <class T>
bool same_in(const Image<T>& a, const Image<T>& b, const Rect& region) {
  for (int y = region.y0; y < region.y1; ++y) {
    for (int x = region.x0; x < region.x1; ++x) {
      if (!same(a(x, y), b(x, y))) return false;
    }
  }
  return true;
}

/// Whether every pixel outside the region has this value.
template <class T>
bool untouched_outside(const Image<T>& a, const Rect& region, const T& value) {
  for (int y = 0; y < a.height(); ++y) {
    for (int x = 0; x < a.width(); ++x) {
      if (!region.contains(x, y) && !same(a(x, y), value)) return false;
    }
  }
  return true;
}

}  // namespace normalshop::test
