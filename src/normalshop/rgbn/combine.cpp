#include "normalshop/rgbn/combine.h"

#include "normalshop/core/parallel.h"

namespace normalshop {

Rect combine_linear(SlopeView base, SlopeView details, MaskView mask, float strength,
                    SlopeSpan target, Rect region) {
  region = intersect(region, target.rect());
  if (region.empty()) return {};
  parallel_for(static_cast<std::size_t>(region.height()), 32, [&](std::size_t a, std::size_t b) {
    for (std::size_t i = a; i < b; ++i) {
      const int y = region.y0 + static_cast<int>(i);
      for (int x = region.x0; x < region.x1; ++x) {
        const float weight = mask.empty() ? strength : strength * mask(x, y);
        target(x, y) = base(x, y) + weight * details(x, y);
      }
    }
  });
  return region;
}

}  // namespace normalshop
