#include <cmath>

#include "normalshop/core/parallel.h"
#include "normalshop/core/slope.h"
#include "normalshop/rgbn/bilateral.h"
#include "normalshop/rgbn/detail/bilateral_input.h"

namespace normalshop {

namespace {

/// The exponent's part of one dimension: 0 where it is ignored.
double closeness(const Vec3f& a, const Vec3f& b, float sigma) {
  if (sigma == 0.0F) return 0.0;
  const double d = (a - b).cast<double>().norm() / static_cast<double>(sigma);
  return -0.5 * d * d;
}

struct Mean {
  double weight = 0.0;
  Vec2d slope = Vec2d::Zero();
  Vec3d color = Vec3d::Zero();
};

Mean mean_at(const BilateralInput& input, int x, int y, const BilateralOptions& options) {
  const RgbnWindow& guide = input.guide();
  const double square = static_cast<double>(options.sigma_space * options.sigma_space);
  const int radius = kernel_radius(options);
  const bool colors = !input.source.color.empty();
  const Vec3f normal = normal_from_slope(guide.slopes(x, y));
  const Vec2f own_slope = limit_slope(input.source.slopes(x, y));
  Mean mean;
  for (int v = y - radius; v <= y + radius; ++v) {
    for (int u = x - radius; u <= x + radius; ++u) {
      const int distance = (u - x) * (u - x) + (v - y) * (v - y);
      const float own = input.weight(u, v);
      if (distance > radius * radius || !(own > 0.0F)) continue;
      double exponent = -0.5 * distance / square;
      exponent += closeness(normal, normal_from_slope(guide.slopes(u, v)), options.sigma_normal);
      if (!guide.color.empty()) {
        exponent += closeness(guide.color(x, y), guide.color(u, v), options.sigma_color);
      }
      const double weight = static_cast<double>(own) * std::exp(exponent);
      mean.weight += weight;
      // Relative to the pixel itself: what is constant stays so to the last bit.
      mean.slope += weight * (limit_slope(input.source.slopes(u, v)) - own_slope).cast<double>();
      if (colors) {
        mean.color += weight * (input.source.color(u, v) - input.source.color(x, y)).cast<double>();
      }
    }
  }
  return mean;
}

}  // namespace

Rect bilateral_exact(const RgbnView& source, const RgbnView& guide, const RgbnSpan& target,
                     Rect region, const BilateralOptions& options) {
  check(options);
  region = intersect(region, rect_of(target));
  if (region.empty()) return {};
  const BilateralInput input = bilateral_input(source, guide, region, options);
  copy_region(source, target, region);
  if (kernel_radius(options) == 0) return region;
  const int dx = input.region.x0 - region.x0;
  const int dy = input.region.y0 - region.y0;
  parallel_for(static_cast<std::size_t>(region.height()), 4, [&](std::size_t a, std::size_t b) {
    for (int y = region.y0 + static_cast<int>(a); y < region.y0 + static_cast<int>(b); ++y) {
      for (int x = region.x0; x < region.x1; ++x) {
        if (!(input.weight(x + dx, y + dy) > 0.0F)) continue;
        const Mean mean = mean_at(input, x + dx, y + dy, options);
        const Vec2f slope = limit_slope(input.source.slopes(x + dx, y + dy)) +
                            (mean.slope / mean.weight).cast<float>();
        Vec3f color = Vec3f::Zero();
        if (!input.source.color.empty()) {
          color = input.source.color(x + dx, y + dy) + (mean.color / mean.weight).cast<float>();
        }
        write_filtered(source, target, x, y, slope, color);
      }
    }
  });
  return region;
}

}  // namespace normalshop
