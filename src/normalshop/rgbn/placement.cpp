#include "normalshop/rgbn/placement.h"

#include <cmath>

#include "normalshop/core/error.h"

namespace normalshop {

namespace {

/// (cos, sin) with exact values at quarter turns.
Vec2f direction(double degrees) {
  const double quarters = std::nearbyint(degrees / 90.0);
  const double rest = (degrees - 90.0 * quarters) * (3.14159265358979323846 / 180.0);
  const auto c = static_cast<float>(std::cos(rest));
  const auto s = static_cast<float>(std::sin(rest));
  switch (((static_cast<int>(std::fmod(quarters, 4.0)) + 4) % 4)) {
    case 1:
      return {-s, c};
    case 2:
      return {-c, -s};
    case 3:
      return {s, -c};
    default:
      return {c, s};
  }
}

}  // namespace

Mat2f placement_matrix(const Placement& p) {
  if (!std::isfinite(p.rotation) || !std::isfinite(p.scale_x) || !std::isfinite(p.scale_y) ||
      !std::isfinite(p.shear)) {
    throw InvalidInput("rotation, scale_x, scale_y and shear must be numbers");
  }
  if (p.scale_x == 0.0F || p.scale_y == 0.0F) {
    throw InvalidInput("scale_x and scale_y must not be 0");
  }
  const Vec2f d = direction(static_cast<double>(p.rotation));
  Mat2f turn;
  turn << d.x(), -d.y(), d.y(), d.x();
  Mat2f slant;
  slant << p.scale_x, p.shear * p.scale_y, 0.0F, p.scale_y;
  return turn * slant;
}

}  // namespace normalshop
