#include "normalshop/rgbn/heatmap.h"

#include <array>
#include <cmath>

#include "normalshop/core/parallel.h"

namespace normalshop {

Vec3f heat_color(float t) {
  if (!std::isfinite(t)) return Vec3f::Constant(0.35F);
  // Chosen by eye so that the lightness L* grows by about 12 from one to the next.
  static const std::array<Vec3f, 8> ramp = {Vec3f(0.03F, 0.03F, 0.08F), Vec3f(0.15F, 0.08F, 0.30F),
                                            Vec3f(0.36F, 0.10F, 0.46F), Vec3f(0.60F, 0.17F, 0.45F),
                                            Vec3f(0.82F, 0.29F, 0.33F), Vec3f(0.95F, 0.47F, 0.18F),
                                            Vec3f(0.98F, 0.71F, 0.22F), Vec3f(0.99F, 0.96F, 0.68F)};
  const float x = std::clamp(t, 0.0F, 1.0F) * static_cast<float>(ramp.size() - 1);
  const std::size_t i = std::min(static_cast<std::size_t>(x), ramp.size() - 2);
  const float f = x - static_cast<float>(i);
  return (1.0F - f) * ramp[i] + f * ramp[i + 1];
}

void heatmap(MaskView values, float maximum, ColorSpan target) {
  assert(maximum > 0.0F && values.rect() == target.rect());
  parallel_for(static_cast<std::size_t>(target.height()), 32, [&](std::size_t a, std::size_t b) {
    for (int y = static_cast<int>(a); y < static_cast<int>(b); ++y) {
      for (int x = 0; x < target.width(); ++x) target(x, y) = heat_color(values(x, y) / maximum);
    }
  });
}

}  // namespace normalshop
