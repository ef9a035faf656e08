#include "normalshop/rgbn/shade_exaggerated.h"

#include <cmath>
#include <utility>

#include "normalshop/rgbn/detail/check_options.h"
#include "normalshop/rgbn/detail/display.h"
#include "normalshop/rgbn/detail/normal_layer.h"

namespace normalshop {

namespace {

constexpr float level_step = 1.41421356F;
/// Sine of the angle between normal and light below which the light has no side to come from.
constexpr float least_sine = 0.2F;

/// The part of the light perpendicular to n, unit unless it is very short.
Vec3f grazing(const Vec3f& light, const Vec3f& n) {
  const Vec3f across = light - light.dot(n) * n;
  return across / std::max(across.norm(), least_sine);
}

/// Runs body(x, y, i, j) over the pixels with a normal; (i, j) counts from the region's corner.
template <class Body>
void for_each_normal(const NormalLayer& layer, const Rect& region, const Body& body) {
  for_each_row(region, [&](int y) {
    for (int x = region.x0; x < region.x1; ++x) {
      if (has_direction(layer(x, y))) body(x, y, x - region.x0, y - region.y0);
    }
  });
}

}  // namespace

Rect shade_exaggerated(ImageView<Vec3f> normals, ColorView albedo, ColorSpan target, Rect region,
                       const ExaggeratedOptions& options) {
  check_options("exaggerated shading", options);
  assert(normals.rect() == target.rect());
  region = intersect(region, target.rect());
  if (region.empty()) return {};
  const Vec3f light = light_vector(options);
  const NormalLayer finest(normals, grow(region, reach(options)));
  MaskImage details(region.width(), region.height(), 0.0F);
  NormalLayer level = finest;
  float total = 0.0F;
  float size = options.scale;
  for (int k = 0; k < options.levels; ++k, size *= level_step) {
    NormalLayer smoother = finest.smoothed(size);
    const float weight = std::pow(size / options.scale, options.balance);
    total += weight;
    for_each_normal(finest, region, [&](int x, int y, int i, int j) {
      const float lit = options.gain * level(x, y).dot(grazing(light, smoother(x, y)));
      details(i, j) += weight * std::clamp(lit, -1.0F, 1.0F);
    });
    level = std::move(smoother);
  }
  const float room = 1.0F - 0.5F * options.detail;
  for_each_normal(finest, region, [&](int x, int y, int i, int j) {
    const float base = room * level(x, y).dot(light);
    const float c = options.detail * details(i, j) / total;
    const float joined = (base + c) / std::max(1.0F + base * c, 1e-6F);
    target(x, y) =
        colored(albedo, x, y, linear_tone(0.5F + 0.5F * std::clamp(joined, -1.0F, 1.0F)));
  });
  return region;
}

int reach(const ExaggeratedOptions& options) {
  float largest = options.scale;
  for (int k = 1; k < options.levels; ++k) largest *= level_step;
  return smoothing_reach(largest);
}

}  // namespace normalshop
