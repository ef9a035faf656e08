#include "normalshop/rgbn/filter.h"

#include <cmath>

#include "normalshop/core/error.h"
#include "normalshop/rgbn/detail/gaussian.h"
#include "normalshop/rgbn/detail/rows.h"
#include "normalshop/rgbn/sharpen.h"
#include "normalshop/rgbn/smooth.h"

namespace normalshop {

namespace {

void check(const FilterOptions& o) {
  if (!(o.sigma >= 0.0F && o.noise_sigma >= 0.0F && o.sigma <= 1e6F && o.noise_sigma <= 1e6F)) {
    throw InvalidInput("filter: sigma and noise_sigma must be numbers from 0 to 1000000");
  }
  if (!(std::abs(o.amount) <= 100.0F)) {
    throw InvalidInput("filter: amount must be a number from -100 to 100");
  }
  if (uses_noise(o.kind) && o.noise_sigma > 0.0F && o.noise_sigma >= o.sigma) {
    throw InvalidInput("filter: noise_sigma must be smaller than sigma");
  }
}

/// What a filter works on; the region is not empty.
struct Work {
  SlopeView source;
  MaskView validity;
  Rect region;
  Border border;
};

/// target = value(x, y) where pixels count.
template <class Value>
void write(const Work& work, SlopeSpan target, const Value& value) {
  for_pixels(work.region, [&](int x, int y) {
    target(x, y) = mask_at(work.validity, x, y) > 0.0F ? Vec2f(value(x, y)) : work.source(x, y);
  });
}

/// target = amount * (source * g(fine_sigma) - source * g(sigma)).
void pass_band(const Work& work, SlopeSpan target, float fine_sigma, float sigma, float amount) {
  const Rect& region = work.region;
  const SlopeImage low = gaussian(work.source, work.validity, region, sigma, work.border);
  SlopeImage fine;
  if (fine_sigma > 0.0F) {
    fine = gaussian(work.source, work.validity, region, fine_sigma, work.border);
  }
  write(work, target, [&](int x, int y) -> Vec2f {
    const int i = x - region.x0;
    const int j = y - region.y0;
    return amount * ((fine.empty() ? work.source(x, y) : fine(i, j)) - low(i, j));
  });
}

void pass_details(const Work& work, SlopeSpan target, const FilterOptions& o) {
  if (o.sigma == 0.0F) {
    write(work, target, [](int, int) -> Vec2f { return Vec2f::Zero(); });
  } else if (o.kind == FilterKind::LaplacianOfGaussian) {
    const SlopeImage bent =
        laplacian(work.source, work.validity, work.region, o.sigma, work.border);
    write(work, target, [&](int x, int y) -> Vec2f {
      return o.amount * bent(x - work.region.x0, y - work.region.y0);
    });
  } else {
    pass_band(work, target, uses_noise(o.kind) ? o.noise_sigma : 0.0F, o.sigma, o.amount);
  }
}

}  // namespace

Rect filter(SlopeView source, MaskView validity, SlopeSpan target, Rect region,
            const FilterOptions& options) {
  check(options);
  assert(source.rect() == target.rect());
  region = intersect(region, target.rect());
  if (region.empty()) return {};
  const Work work{source, validity, region, options.border};
  switch (options.kind) {
    case FilterKind::Gaussian:
      return smooth(source, validity, target, region, {.sigma = options.sigma}, options.border);
    case FilterKind::Unsharp:
    case FilterKind::EdgeEnhance:
      return sharpen(source, validity, target, region,
                     {.sigma = options.sigma,
                      .amount = options.amount,
                      .noise_sigma = uses_noise(options.kind) ? options.noise_sigma : 0.0F},
                     options.border);
    case FilterKind::Scale:
      write(work, target, [&](int x, int y) -> Vec2f { return options.amount * source(x, y); });
      return region;
    case FilterKind::HighPass:
    case FilterKind::BandPass:
    case FilterKind::LaplacianOfGaussian:
      break;
  }
  pass_details(work, target, options);
  return region;
}

int reach(const FilterOptions& options) {
  if (options.kind == FilterKind::Scale || options.sigma == 0.0F) return 0;
  if (options.kind != FilterKind::LaplacianOfGaussian) return gaussian_reach(options.sigma);
  return laplacian_reach(options.sigma);
}

}  // namespace normalshop
