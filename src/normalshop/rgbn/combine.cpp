#include "normalshop/rgbn/combine.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include <Eigen/Geometry>

#include "normalshop/core/error.h"
#include "normalshop/core/parallel.h"
#include "normalshop/core/slope.h"

namespace normalshop {

namespace {

constexpr double least_z = static_cast<double>(min_cosine);

// In double, so that a model that only turns normals returns what went in.
Vec3d unit_normal(const Vec2f& slope) {
  const Vec2d s = slope.cast<double>();
  return Vec3d(-s.x(), -s.y(), 1.0).normalized();
}

/// Of a normal that need not be unit. Saturates at the horizon however far below it points, so that
/// two steep slopes don't add up to a gentle one.
Vec2f slope_of(const Vec3d& n) {
  if (n.z() >= least_z * n.norm()) return (n.head<2>() / -n.z()).cast<float>();
  const double across = n.head<2>().norm();
  if (across == 0.0) return Vec2f::Zero();
  const double steepest = std::sqrt(1.0 / (least_z * least_z) - 1.0);
  return (n.head<2>() * (-steepest / across)).cast<float>();
}

/// `v` turned by the shortest arc from the z axis to the unit vector t, t.z > 0.
Vec3d reoriented(const Vec3d& t, const Vec3d& v) {
  const Vec3d half(t.x(), t.y(), t.z() + 1.0);
  const Vec3d opposite(-v.x(), -v.y(), v.z());
  return half * (half.dot(opposite) / half.z()) - opposite;
}

/// `v` turned by the shortest arc from one unit vector to another, less than a half turn away.
Vec3d turned(const Vec3d& v, const Vec3d& from, const Vec3d& to) {
  const Vec3d axis = from.cross(to);
  const double cosine = from.dot(to);
  return v * cosine + axis.cross(v) + axis * (axis.dot(v) / (1.0 + cosine));
}

/// The last unit vector on the great arc from n to b, less than a half turn away, with z >=
/// least_z.
Vec3d saturated(const Vec3d& n, const Vec3d& b) {
  if (b.z() >= least_z) return b;
  if (n.z() <= least_z) return n;
  // n + s (b - n) runs below the arc; the first s where its z is least_z times its length.
  const Vec3d chord = b - n;
  const double square = least_z * least_z;
  const double shrink = square * chord.squaredNorm();
  const double qa = chord.z() * chord.z() - shrink;
  const double qb = 2.0 * n.z() * chord.z() + shrink;
  const double qc = n.z() * n.z() - square;
  const double root = std::sqrt(std::max(0.0, qb * qb - 4.0 * qa * qc));
  return (n + (2.0 * qc / (root - qb)) * chord).normalized();
}

Vec2f rotation(const Vec2f& base, const Vec2f& smooth, const Vec2f& details) {
  const Vec3d n = unit_normal(smooth);
  const Vec3d b = saturated(n, reoriented(n, unit_normal(details)));
  return slope_of(turned(unit_normal(base), n, b));
}

Vec2f whiteout(const Vec2f& base, const Vec2f& details) {
  const Vec3d t = unit_normal(base);
  const Vec3d u = unit_normal(details);
  return slope_of({t.x() + u.x(), t.y() + u.y(), t.z() * u.z()});
}

Vec2f udn(const Vec2f& base, const Vec2f& details) {
  const Vec3d t = unit_normal(base);
  const Vec3d u = unit_normal(details);
  return slope_of({t.x() + u.x(), t.y() + u.y(), t.z()});
}

/// Two components from -1 to 1 as colours.
double overlay(double base, double details) {
  const double b = 0.5 * base + 0.5;
  const double d = 0.5 * details + 0.5;
  return b < 0.5 ? 4.0 * b * d - 1.0 : 1.0 - 4.0 * (1.0 - b) * (1.0 - d);
}

Vec2f overlay(const Vec2f& base, const Vec2f& details) {
  const Vec3d t = unit_normal(base);
  const Vec3d u = unit_normal(details);
  return slope_of({overlay(t.x(), u.x()), overlay(t.y(), u.y()), overlay(t.z(), u.z())});
}

struct Places {
  MaskView mask;
  float strength;
  SlopeSpan target;
  Rect region;
};

/// target = model(x, y, weight) where the weight is not 0, else base.
template <class Model>
Rect for_each_pixel(SlopeView base, Places p, const Model& model) {
  if (!std::isfinite(p.strength)) throw InvalidInput("combine: strength must be a number");
  assert(base.rect() == p.target.rect());
  assert(p.mask.empty() || p.mask.rect() == base.rect());
  const Rect region = intersect(p.region, p.target.rect());
  if (region.empty()) return {};
  parallel_for(static_cast<std::size_t>(region.height()), 32, [&](std::size_t a, std::size_t b) {
    for (int y = region.y0 + static_cast<int>(a); y < region.y0 + static_cast<int>(b); ++y) {
      for (int x = region.x0; x < region.x1; ++x) {
        const float weight = p.mask.empty() ? p.strength : p.strength * p.mask(x, y);
        p.target(x, y) = weight == 0.0F ? base(x, y) : model(x, y, weight);
      }
    }
  });
  return region;
}

/// target = model(base, weight * details) where these details are not flat, else base.
template <class Model>
Rect scale_details(SlopeView base, SlopeView details, const Places& places, const Model& model) {
  assert(details.rect() == base.rect());
  return for_each_pixel(base, places, [&](int x, int y, float weight) -> Vec2f {
    const Vec2f scaled = weight * details(x, y);
    return scaled.x() == 0.0F && scaled.y() == 0.0F ? base(x, y) : model(x, y, scaled);
  });
}

}  // namespace

Rect combine_linear(SlopeView base, SlopeView details, MaskView mask, float strength,
                    SlopeSpan target, Rect region) {
  assert(details.rect() == base.rect());
  return for_each_pixel(
      base, {mask, strength, target, region},
      [&](int x, int y, float weight) -> Vec2f { return base(x, y) + weight * details(x, y); });
}

Rect combine_rotation(SlopeView base, SlopeView smooth, SlopeView details, MaskView mask,
                      float strength, SlopeSpan target, Rect region) {
  assert(smooth.rect() == base.rect());
  return scale_details(
      base, details, {mask, strength, target, region},
      [&](int x, int y, const Vec2f& d) { return rotation(base(x, y), smooth(x, y), d); });
}

Rect combine(SlopeView base, SlopeView details, MaskView mask, SlopeSpan target, Rect region,
             const CombineOptions& options) {
  const Places places{mask, options.strength, target, region};
  switch (options.model) {
    case CombineModel::Linear:
      break;
    case CombineModel::Rotation:
      return combine_rotation(base, base, details, mask, options.strength, target, region);
    case CombineModel::Reoriented:
      return scale_details(base, details, places, [&](int x, int y, const Vec2f& d) {
        return slope_of(reoriented(unit_normal(base(x, y)), unit_normal(d)));
      });
    case CombineModel::Whiteout:
      return scale_details(base, details, places,
                           [&](int x, int y, const Vec2f& d) { return whiteout(base(x, y), d); });
    case CombineModel::Udn:
      return scale_details(base, details, places,
                           [&](int x, int y, const Vec2f& d) { return udn(base(x, y), d); });
    case CombineModel::Overlay:
      return for_each_pixel(base, places, [&](int x, int y, float weight) -> Vec2f {
        const Vec2f& b = base(x, y);
        return b + weight * (overlay(b, details(x, y)) - b);
      });
  }
  return combine_linear(base, details, mask, options.strength, target, region);
}

}  // namespace normalshop
