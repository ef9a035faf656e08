#include "normalshop/rgbn/vector_tools.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "normalshop/core/error.h"
#include "normalshop/core/slope.h"
#include "normalshop/rgbn/detail/rows.h"

namespace normalshop {

namespace {

constexpr double degrees = 3.14159265358979323846 / 180.0;

void check(double value, double low, double high, const char* message) {
  if (!(value >= low && value <= high)) throw InvalidInput(message);
}

Vec3d unit(const Vec3f& v, const char* message) {
  const Vec3d d = v.cast<double>();
  if (!d.allFinite() || !(d.norm() > 0.0)) throw InvalidInput(message);
  return d.normalized();
}

Vec3d normal_of(const Vec2f& slope) {
  const Vec2d s = slope.cast<double>();
  return Vec3d(-s.x(), -s.y(), 1.0).normalized();
}

Vec2f slope_of(const Vec3d& n) {
  return {static_cast<float>(-n.x() / n.z()), static_cast<float>(-n.y() / n.z())};
}

/// n turned about a unit axis by an angle of 0 to pi, or to where it reaches the horizon. On the
/// way n.z = c + r cos(angle - peak).
Vec3d turn(const Vec3d& n, const Vec3d& axis, double angle) {
  const Vec3d along = axis.dot(n) * axis;
  const Vec3d across = n - along;
  const Vec3d ahead = axis.cross(n);
  const double horizon = std::min(static_cast<double>(min_cosine), n.z());
  const double r = std::hypot(across.z(), ahead.z());
  if (along.z() - r < horizon - 1e-9) {
    const double peak = std::atan2(ahead.z(), across.z());
    const double cosine = std::clamp((horizon - along.z()) / r, -1.0, 1.0);
    angle = std::clamp(angle, 0.0, std::max(0.0, peak + std::acos(cosine)));
  }
  Vec3d out = along + std::cos(angle) * across + std::sin(angle) * ahead;
  out.z() = std::max(out.z(), horizon);  // rounding
  return out;
}

/// target = edit(slope, mask) where the mask is not 0.
template <class Edit>
Rect edit_slopes(SlopeView source, MaskView mask, SlopeSpan target, Rect region, const Edit& edit) {
  region = intersect(region, target.rect());
  if (region.empty()) return {};
  for_pixels(region, [&](int x, int y) {
    const float amount = mask_at(mask, x, y);
    const Vec2f& slope = source(x, y);
    target(x, y) = amount == 0.0F || !slope.allFinite() ? slope : edit(x, y, slope, amount);
  });
  return region;
}

template <class T, class Change>
Rect change_all(ImageView<T> source, ImageSpan<T> target, Rect region, const Change& change) {
  region = intersect(region, target.rect());
  if (region.empty()) return {};
  for_pixels(region, [&](int x, int y) {
    T value = source(x, y);
    change(value);
    target(x, y) = value;
  });
  return region;
}

/// Sums of a row, then of the rows in their order: the same for any number of threads.
struct Sums {
  Vec2d slope = Vec2d::Zero();  ///< of mask * slope
  double mask = 0.0;
  double mask_squared = 0.0;

  void add(const Sums& other) {
    slope += other.slope;
    mask += other.mask;
    mask_squared += other.mask_squared;
  }
};

Sums sum_slopes(SlopeView source, MaskView mask) {
  std::vector<Sums> rows(static_cast<std::size_t>(source.height()));
  parallel_for(rows.size(), 32, [&](std::size_t a, std::size_t b) {
    for (std::size_t i = a; i < b; ++i) {
      const auto y = static_cast<int>(i);
      for (int x = 0; x < source.width(); ++x) {
        if (!source(x, y).allFinite()) continue;
        const auto m = static_cast<double>(mask_at(mask, x, y));
        rows[i].add({m * source(x, y).cast<double>(), m, m * m});
      }
    }
  });
  Sums total;
  for (const Sums& row : rows) total.add(row);
  return total;
}

enum class VectorKind { Unit, OtherLength, Zero, NotFinite };

VectorKind normalize(Vec3f& v) {
  if (!v.allFinite()) {
    v = Vec3f::Zero();
    return VectorKind::NotFinite;
  }
  const Vec3d d = v.cast<double>();
  const double length = d.norm();
  if (length == 0.0) return VectorKind::Zero;
  if (std::abs(length - 1.0) <= unit_tolerance) return VectorKind::Unit;
  v = (d / length).cast<float>();
  return VectorKind::OtherLength;
}

}  // namespace

Vec3f direction_from_angles(float azimuth, float tilt) {
  const double a = static_cast<double>(azimuth) * degrees;
  const double t = static_cast<double>(tilt) * degrees;
  return Vec3d(std::sin(t) * std::cos(a), std::sin(t) * std::sin(a), std::cos(t)).cast<float>();
}

Rect paint_direction(SlopeView source, MaskView mask, SlopeSpan target, Rect region,
                     const Vec3f& direction, float strength) {
  const Vec3d to = unit(direction, "paint_direction: the direction must be finite and not zero");
  check(strength, 0.0, 1.0, "paint_direction: strength must be a number from 0 to 1");
  return edit_slopes(source, mask, target, region,
                     [&](int, int, const Vec2f& slope, float amount) -> Vec2f {
                       const double part = static_cast<double>(strength * amount);
                       if (part == 0.0) return slope;
                       const Vec3d n = normal_of(slope);
                       const Vec3d axis = n.cross(to);
                       const double sine = axis.norm();
                       if (!(sine > 1e-12)) return slope;  // there already, or no arc is shortest
                       const double angle = std::atan2(sine, n.dot(to));
                       return slope_of(turn(n, axis / sine, part * angle));
                     });
}

Rect paint_direction(SlopeView source, MaskView mask, SlopeSpan target, Rect region,
                     const PaintDirectionOptions& options) {
  check(options.azimuth, -360.0, 360.0,
        "paint_direction: azimuth must be a number from -360 to 360");
  check(options.tilt, 0.0, 180.0, "paint_direction: tilt must be a number from 0 to 180");
  return paint_direction(source, mask, target, region,
                         direction_from_angles(options.azimuth, options.tilt), options.strength);
}

Rect rotate_normals(SlopeView source, MaskView mask, SlopeSpan target, Rect region,
                    const Vec3f& axis, float angle) {
  const Vec3d about = unit(axis, "rotate_normals: the axis must be finite and not zero");
  check(angle, -180.0, 180.0, "rotate_normals: angle must be a number from -180 to 180");
  return edit_slopes(source, mask, target, region,
                     [&](int, int, const Vec2f& slope, float amount) -> Vec2f {
                       const double turned = static_cast<double>(angle * amount) * degrees;
                       if (turned == 0.0) return slope;
                       const Vec3d around = turned < 0.0 ? Vec3d(-about) : about;
                       return slope_of(turn(normal_of(slope), around, std::abs(turned)));
                     });
}

Rect rotate_normals(SlopeView source, MaskView mask, SlopeSpan target, Rect region,
                    const RotateNormalsOptions& options) {
  check(options.azimuth, -360.0, 360.0,
        "rotate_normals: azimuth must be a number from -360 to 360");
  check(options.tilt, 0.0, 180.0, "rotate_normals: tilt must be a number from 0 to 180");
  return rotate_normals(source, mask, target, region,
                        direction_from_angles(options.azimuth, options.tilt), options.angle);
}

Rect flatten(SlopeView source, MaskView mask, SlopeSpan target, Rect region,
             const FlattenOptions& options) {
  const Vec2f& plane = options.slope;
  check(plane.x(), -50.0, 50.0, "flatten: slope must be two numbers from -50 to 50");
  check(plane.y(), -50.0, 50.0, "flatten: slope must be two numbers from -50 to 50");
  check(options.strength, 0.0, 1.0, "flatten: strength must be a number from 0 to 1");
  return edit_slopes(source, mask, target, region,
                     [&](int, int, const Vec2f& slope, float amount) -> Vec2f {
                       const float t = options.strength * amount;
                       if (t == 0.0F) return slope;
                       return (1.0F - t) * slope + t * plane;
                     });
}

Rect flatten_to(SlopeView base, SlopeView source, MaskView mask, SlopeSpan target, Rect region,
                float strength) {
  check(strength, 0.0, 1.0, "flatten_to: strength must be a number from 0 to 1");
  return edit_slopes(source, mask, target, region,
                     [&](int x, int y, const Vec2f& slope, float amount) -> Vec2f {
                       const float t = strength * amount;
                       if (t == 0.0F || !base(x, y).allFinite()) return slope;
                       return (1.0F - t) * slope + t * base(x, y);
                     });
}

Vec2d mean_slope(SlopeView source, MaskView mask) {
  const Sums sums = sum_slopes(source, mask);
  return sums.mask > 0.0 ? Vec2d(sums.slope / sums.mask) : Vec2d(0.0, 0.0);
}

Rect balance_mean(SlopeView source, MaskView mask, SlopeSpan target, Rect region) {
  const Sums sums = sum_slopes(source, mask);
  const Vec2d shift =
      sums.mask_squared > 0.0 ? Vec2d(sums.slope / sums.mask_squared) : Vec2d(0.0, 0.0);
  return edit_slopes(
      source, mask, target, region, [&](int, int, const Vec2f& slope, float amount) -> Vec2f {
        return (slope.cast<double>() - static_cast<double>(amount) * shift).cast<float>();
      });
}

NormalizeReport normalize_vectors(ImageView<Vec3f> source, ImageSpan<Vec3f> target, Rect region) {
  NormalizeReport report{.written = intersect(region, target.rect())};
  if (report.written.empty()) return {};
  std::vector<std::array<std::size_t, 4>> rows(static_cast<std::size_t>(report.written.height()));
  for_pixels(report.written, [&](int x, int y) {
    target(x, y) = source(x, y);
    const auto kind = static_cast<std::size_t>(normalize(target(x, y)));
    ++rows[static_cast<std::size_t>(y - report.written.y0)][kind];
  });
  for (const auto& row : rows) {
    report.not_unit += row[static_cast<std::size_t>(VectorKind::OtherLength)];
    report.zero += row[static_cast<std::size_t>(VectorKind::Zero)];
    report.not_finite += row[static_cast<std::size_t>(VectorKind::NotFinite)];
  }
  return report;
}

Rect flip_green(SlopeView source, SlopeSpan target, Rect region) {
  return change_all(source, target, region, [](Vec2f& slope) { slope.y() = -slope.y(); });
}

Rect flip_green(ImageView<Vec3f> source, ImageSpan<Vec3f> target, Rect region) {
  return change_all(source, target, region, [](Vec3f& v) { v.y() = -v.y(); });
}

Rect swap_red_green(SlopeView source, SlopeSpan target, Rect region) {
  return change_all(source, target, region, [](Vec2f& s) { std::swap(s.x(), s.y()); });
}

Rect swap_red_green(ImageView<Vec3f> source, ImageSpan<Vec3f> target, Rect region) {
  return change_all(source, target, region, [](Vec3f& v) { std::swap(v.x(), v.y()); });
}

}  // namespace normalshop
