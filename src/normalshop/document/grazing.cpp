#include "normalshop/document/grazing.h"

#include <atomic>
#include <cmath>

#include "normalshop/core/for_pixels.h"
#include "normalshop/core/sample.h"

namespace normalshop {

namespace {

/// What an operator adds grows to a replacement over this change of slope: three degrees.
constexpr float strong_change = 0.05F;
/// The same where a filter takes away what is finer than the chart: half a degree.
constexpr float noticed_change = 0.01F;

/// Continues the identity smoothly towards steepest_slope.
float limited(float steepness) {
  constexpr float room = steepest_slope - steep_slope;
  return steep_slope + room * std::tanh((steepness - steep_slope) / room);
}

}  // namespace

MaskImage limit_grazing(SlopeSpan slopes) {
  const auto is_steep = [](const Vec2f& s) { return s.squaredNorm() > steep_slope * steep_slope; };
  std::atomic<bool> any = false;
  for_pixels(slopes.rect(), [&](int x, int y) {
    if (is_steep(slopes(x, y))) any.store(true, std::memory_order_relaxed);
  });
  if (!any) return {};
  MaskImage grazing(slopes.width(), slopes.height(), 0.0F);
  for_pixels(slopes.rect(), [&](int x, int y) {
    Vec2f& slope = slopes(x, y);
    if (!is_steep(slope)) return;
    const float steepness = slope.norm();
    grazing(x, y) = smoothstep(steep_slope, steepest_slope, steepness);
    slope *= limited(steepness) / steepness;
  });
  return grazing;
}

void replace_details(MaskView grazing, float finer, SlopeView before, SlopeView base,
                     OperatorResult& result) {
  for_pixels(result.region, [&](int x, int y) {
    Vec2f& change = result.change(x, y);
    float& coverage = result.coverage(x, y);
    const float size = change.norm();
    float part = finer * std::min(1.0F, size / noticed_change);
    if (!grazing.empty()) {
      part = std::max(part, grazing(x, y) * std::min(1.0F, size / strong_change));
    }
    coverage *= part;
    if (coverage > 0.0F) {
      change += coverage * (before(x, y) - base(x, y));
    }
  });
}

}  // namespace normalshop
