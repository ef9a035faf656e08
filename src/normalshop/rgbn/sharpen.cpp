#include "normalshop/rgbn/sharpen.h"

#include <cmath>

#include "normalshop/core/error.h"
#include "normalshop/rgbn/detail/filter_rows.h"
#include "normalshop/rgbn/detail/gaussian.h"
#include "normalshop/rgbn/detail/rows.h"

namespace normalshop {

namespace {

void check(const SharpenOptions& o) {
  const bool finite =
      std::isfinite(o.sigma) && std::isfinite(o.noise_sigma) && std::isfinite(o.amount);
  if (!finite || o.sigma < 0.0F || o.noise_sigma < 0.0F) {
    throw InvalidInput("sharpen: sigma and noise_sigma must be numbers of at least 0");
  }
  if (o.noise_sigma > 0.0F && o.noise_sigma >= o.sigma) {
    throw InvalidInput("sharpen: noise_sigma must be smaller than sigma");
  }
}

}  // namespace

Rect sharpen(SlopeView source, MaskView validity, SlopeSpan target, Rect region,
             const SharpenOptions& options, Border border) {
  check(options);
  assert(source.rect() == target.rect());
  region = intersect(region, target.rect());
  if (region.empty()) return {};
  if (options.sigma == 0.0F || options.amount == 0.0F) {
    copy_rows(source, {}, target, region);
    return region;
  }
  const SlopeImage low = gaussian(source, validity, region, options.sigma, border);
  SlopeImage high;
  if (options.noise_sigma > 0.0F) {
    high = gaussian(source, validity, region, options.noise_sigma, border);
  }
  for_pixels(region, [&](int x, int y) {
    const Vec2f& own = source(x, y);
    const int i = x - region.x0;
    const int j = y - region.y0;
    const Vec2f details = (high.empty() ? own : high(i, j)) - low(i, j);
    target(x, y) = mask_at(validity, x, y) > 0.0F ? Vec2f(own + options.amount * details) : own;
  });
  return region;
}

int reach(const SharpenOptions& options) { return gaussian_reach(options.sigma); }

}  // namespace normalshop
