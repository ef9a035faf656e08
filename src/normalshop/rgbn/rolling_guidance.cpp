#include "normalshop/rgbn/rolling_guidance.h"

#include "normalshop/core/error.h"
#include "normalshop/rgbn/bilateral.h"
#include "normalshop/rgbn/detail/rgbn_window.h"

namespace normalshop {

namespace {

constexpr int most_iterations = 20;

/// One step, or the whole reach of the blur before the first.
BilateralOptions step(const RollingGuidanceOptions& options, float guide_sigma) {
  return {.sigma_space = options.sigma_space,
          .sigma_color = options.sigma_color,
          .sigma_normal = options.sigma_normal,
          .guide_sigma = guide_sigma};
}

/// A guide that is 0 everywhere, with colours where they are compared or wanted.
RgbnWindow zero_window(const Rect& size, bool color) {
  RgbnWindow guide = make_window(size, color);
  guide.slopes.fill(Vec2f::Zero());
  guide.color.fill(Vec3f::Zero());
  return guide;
}

}  // namespace

Rect rolling_guidance(const RgbnView& source, const RgbnSpan& target, Rect region,
                      const RollingGuidanceOptions& options) {
  if (options.iterations < 0 || options.iterations > most_iterations) {
    throw InvalidInput("rolling_guidance: iterations must be from 0 to 20");
  }
  const BilateralOptions first = step(options, options.guide_sigma);
  const BilateralOptions later = step(options, 0.0F);
  region = intersect(region, rect_of(target));
  bilateral(source, target, {}, first);  // throws for what it does not accept
  if (region.empty()) return {};
  if (options.iterations == 0 || reach(later) == 0) {
    copy_region(source, target, region);
    return region;
  }
  const int margin = reach(options);
  const RgbnWindow input = gather_window(source, grow(region, margin), options.border);
  const Rect inner = {margin, margin, margin + region.width(), margin + region.height()};
  const bool color = !input.color.empty() && (options.sigma_color > 0.0F || !target.color.empty());
  RgbnWindow guide;
  for (int k = 1; k <= options.iterations; ++k) {
    RgbnWindow next = zero_window(input.slopes.rect(), color);
    bilateral(input.view(), guide.view(), {next.slopes, next.color},
              grow(inner, (options.iterations - k) * reach(later)), k == 1 ? first : later);
    guide = std::move(next);
  }
  for (int y = region.y0; y < region.y1; ++y) {
    for (int x = region.x0; x < region.x1; ++x) {
      const int u = x - region.x0 + margin;
      const int v = y - region.y0 + margin;
      const bool counts = input.validity.empty() || input.validity(u, v) > 0.0F;
      if (!target.slopes.empty()) {
        target.slopes(x, y) = counts ? guide.slopes(u, v) : source.slopes(x, y);
      }
      if (!target.color.empty()) {
        target.color(x, y) = counts ? guide.color(u, v) : source.color(x, y);
      }
    }
  }
  return region;
}

int reach(const RollingGuidanceOptions& options) {
  return reach(step(options, options.guide_sigma)) +
         (std::max(options.iterations, 1) - 1) * reach(step(options, 0.0F));
}

}  // namespace normalshop
