#include "normalshop/rgbn/rgbn_normals.h"

#include "normalshop/core/slope.h"
#include "normalshop/rgbn/detail/normal_layer.h"

namespace normalshop {

Rect normals_of(const RgbnView& image, ImageSpan<Vec3f> normals, Rect region) {
  assert(image.slopes.rect() == normals.rect());
  region = intersect(region, normals.rect());
  for_each_row(region, [&](int y) {
    for (int x = region.x0; x < region.x1; ++x) {
      const Vec2f slope = image.slopes(x, y);
      const bool valid =
          slope.allFinite() && (image.validity.empty() || image.validity(x, y) > 0.0F);
      normals(x, y) = valid ? normal_from_slope(slope) : Vec3f(Vec3f::Zero());
    }
  });
  return region.empty() ? Rect{} : region;
}

}  // namespace normalshop
