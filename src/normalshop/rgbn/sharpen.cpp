#include "normalshop/rgbn/sharpen.h"

#include <cmath>

#include "normalshop/core/error.h"
#include "normalshop/core/parallel.h"
#include "normalshop/rgbn/smooth.h"

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

/// A window of the image around `area`, so that only that part needs memory.
template <class T>
ImageView<T> window(ImageView<T> image, const Rect& area, int stride) {
  if (image.empty()) return {};
  return {image.row(area.y0) + area.x0, area.width(), area.height(), stride};
}

}  // namespace

Rect sharpen(SlopeView source, MaskView validity, SlopeSpan target, Rect region,
             const SharpenOptions& options) {
  check(options);
  assert(source.rect() == target.rect());
  region = intersect(region, target.rect());
  if (region.empty()) return {};
  const Rect area = intersect(grow(region, reach(options)), source.rect());
  const auto stride = [](const auto& image) {
    return image.height() > 1 ? static_cast<int>(image.row(1) - image.row(0)) : image.width();
  };
  const SlopeView near = window(source, area, stride(source));
  const MaskView valid = window(validity, area, validity.empty() ? 0 : stride(validity));
  const Rect inner = {region.x0 - area.x0, region.y0 - area.y0, region.x1 - area.x0,
                      region.y1 - area.y0};
  SlopeImage low(area.width(), area.height());
  SlopeImage high(area.width(), area.height());
  smooth(near, valid, low, inner, {.sigma = options.sigma});
  smooth(near, valid, high, inner, {.sigma = options.noise_sigma});
  parallel_for(static_cast<std::size_t>(inner.height()), 32, [&](std::size_t a, std::size_t b) {
    for (int y = inner.y0 + static_cast<int>(a); y < inner.y0 + static_cast<int>(b); ++y) {
      for (int x = inner.x0; x < inner.x1; ++x) {
        const float weight = valid.empty() ? 1.0F : valid(x, y);
        const Vec2f change = options.amount * (high(x, y) - low(x, y));
        target(x + area.x0, y + area.y0) = weight > 0.0F ? Vec2f(near(x, y) + change) : near(x, y);
      }
    }
  });
  return region;
}

int reach(const SharpenOptions& options) { return reach(SmoothOptions{.sigma = options.sigma}); }

}  // namespace normalshop
