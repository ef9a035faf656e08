#include "normalshop/rgbn/shade_lambert.h"

#include "normalshop/core/error.h"
#include "normalshop/rgbn/detail/normal_layer.h"

namespace normalshop {

namespace {

constexpr float pi = 3.14159265F;

std::vector<Light> prepared(const LambertOptions& options) {
  if (!options.ambient.allFinite()) throw InvalidInput("lambert: ambient must be finite numbers");
  std::vector<Light> out;
  for (const Light& light : options.lights) {
    if (!light.direction.allFinite() || light.direction.isZero(0.0F) || !light.color.allFinite()) {
      throw InvalidInput(
          "lambert: lights must have finite colors and directions that are finite and not 0");
    }
    out.push_back({light.direction.stableNormalized(), light.color / pi});
  }
  return out;
}

}  // namespace

Rect shade_lambert(ImageView<Vec3f> normals, ColorView albedo, ColorSpan target, Rect region,
                   const LambertOptions& options) {
  const std::vector<Light> lights = prepared(options);
  assert(normals.rect() == target.rect());
  region = intersect(region, target.rect());
  if (region.empty()) return {};
  for_each_row(region, [&](int y) {
    for (int x = region.x0; x < region.x1; ++x) {
      const Vec3f& n = normals(x, y);
      if (!has_direction(n) || !n.allFinite()) continue;
      Vec3f sum = options.ambient;
      for (const Light& light : lights) {
        sum += std::max(0.0F, n.dot(light.direction)) * light.color;
      }
      target(x, y) = albedo.empty() ? sum : Vec3f(sum.cwiseProduct(albedo(x, y)));
    }
  });
  return region;
}

}  // namespace normalshop
