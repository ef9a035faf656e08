#include "normalshop/rgbn/curvature.h"

#include <cmath>

#include "normalshop/rgbn/detail/check_options.h"
#include "normalshop/rgbn/detail/normal_layer.h"
#include "normalshop/rgbn/detail/principal_curvature.h"

namespace normalshop {

namespace {

/// Writes value(J, n) of every pixel that has a normal, T{} elsewhere.
template <class T, class Value>
Rect from_jacobian(ImageView<Vec3f> normals, ImageSpan<T> target, Rect region,
                   const CurvatureOptions& options, const Value& value) {
  check_options("curvature", options);
  assert(normals.rect() == target.rect());
  region = intersect(region, target.rect());
  if (region.empty()) return {};
  const NormalLayer layer(normals, grow(region, reach(options)));
  const NormalLayer smooth = layer.smoothed(options.sigma);
  const float least_cosine = guard_cosine(options.guard);
  for_each_row(region, [&](int y) {
    for (int x = region.x0; x < region.x1; ++x) {
      if (!has_direction(layer(x, y))) {
        target(x, y) = T{};
        continue;
      }
      const Links links = links_at(layer, x, y, least_cosine);
      target(x, y) = value(normal_jacobian(smooth, links, x, y), smooth(x, y));
    }
  });
  return region;
}

}  // namespace

Rect curvature(ImageView<Vec3f> normals, ImageSpan<Curvature> target, Rect region,
               const CurvatureOptions& options) {
  return from_jacobian(normals, target, region, options, principal_curvature);
}

Rect mean_curvature(ImageView<Vec3f> normals, MaskSpan target, Rect region,
                    const CurvatureOptions& options) {
  return from_jacobian(normals, target, region, options,
                       [](const Mat2f& j, const Vec3f&) { return 0.5F * (j(0, 0) + j(1, 1)); });
}

Rect gaussian_curvature(ImageView<Vec3f> normals, MaskSpan target, Rect region,
                        const CurvatureOptions& options) {
  return from_jacobian(normals, target, region, options, [](const Mat2f& j, const Vec3f&) {
    return j(0, 0) * j(1, 1) - j(0, 1) * j(1, 0);
  });
}

int reach(const CurvatureOptions& options) { return smoothing_reach(options.sigma) + 1; }

}  // namespace normalshop
