#include "normalshop/rgbn/shade_curvature.h"

#include <cmath>

#include "normalshop/rgbn/detail/check_options.h"
#include "normalshop/rgbn/detail/display.h"
#include "normalshop/rgbn/detail/normal_layer.h"

namespace normalshop {

namespace {

constexpr float root_two = 1.41421356F;

/// tanh within 0.002, from operations that give the same bits everywhere.
float soft_sign(float x) {
  const float x2 = x * x;
  if (x2 > 14.0F) return x > 0.0F ? 1.0F : -1.0F;
  const float value = x * (945.0F + x2 * (105.0F + x2)) / (945.0F + x2 * (420.0F + x2 * 15.0F));
  return std::clamp(value, -1.0F, 1.0F);
}

/// Adds weight * tanh(gain * r * H) of one scale r to `sum`, whose origin is the region's corner.
void add_scale(const NormalLayer& layer, float r, float weight,
               const CurvatureShadeOptions& options, const Rect& region, MaskImage& sum) {
  const NormalLayer smooth = layer.smoothed(r);
  const float least_cosine = guard_cosine(options.guard);
  const float steepness = 0.5F * options.gain * r;
  for_each_row(region, [&](int y) {
    for (int x = region.x0; x < region.x1; ++x) {
      if (!has_direction(layer(x, y))) continue;
      const Mat2f j = normal_jacobian(smooth, links_at(layer, x, y, least_cosine), x, y);
      sum(x - region.x0, y - region.y0) += weight * soft_sign(steepness * (j(0, 0) + j(1, 1)));
    }
  });
}

}  // namespace

Rect shade_curvature(ImageView<Vec3f> normals, ColorView albedo, ColorSpan target, Rect region,
                     const CurvatureShadeOptions& options) {
  check_options("curvature shading", options);
  assert(normals.rect() == target.rect());
  region = intersect(region, target.rect());
  if (region.empty()) return {};
  const NormalLayer layer(normals, grow(region, reach(options)));
  MaskImage sum(region.width(), region.height(), 0.0F);
  float total = 0.0F;
  float r = options.scale;
  for (int i = 0; i < options.levels; ++i, r *= root_two) {
    const float weight = std::pow(r / options.scale, options.balance);
    add_scale(layer, r, weight, options, region, sum);
    total += weight;
  }
  for_each_row(region, [&](int y) {
    for (int x = region.x0; x < region.x1; ++x) {
      if (!has_direction(layer(x, y))) continue;
      const float tone = 0.5F + 0.5F * sum(x - region.x0, y - region.y0) / total;
      target(x, y) = colored(albedo, x, y, linear_tone(tone));
    }
  });
  return region;
}

int reach(const CurvatureShadeOptions& options) {
  float largest = options.scale;
  for (int i = 1; i < options.levels; ++i) largest *= root_two;
  return smoothing_reach(largest) + 1;
}

}  // namespace normalshop
