#include "normalshop/rgbn/filter.h"

#include <cmath>

#include "normalshop/core/error.h"
#include "normalshop/rgbn/detail/filter_rows.h"
#include "normalshop/rgbn/detail/gaussian.h"
#include "normalshop/rgbn/detail/line_kernels.h"
#include "normalshop/rgbn/detail/rows.h"
#include "normalshop/rgbn/detail/tile_filter.h"
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

/// The Laplacian of a Gaussian as the Gaussian of `rest` and then the Laplacian of a narrow one,
/// whose derivatives are short.
struct LaplacianParts {
  static constexpr double widest = 2.0;

  explicit LaplacianParts(float of_sigma) {
    const auto sigma = static_cast<double>(of_sigma);
    smoothing = fir_kernel(std::min(sigma, widest));
    bending = fir_second_derivative(std::min(sigma, widest));
    if (sigma > widest) rest = static_cast<float>(std::sqrt(sigma * sigma - widest * widest));
  }
  int radius() const { return std::max(smoothing.radius(), bending.radius()); }

  FirKernel smoothing;
  FirKernel bending;
  float rest = 0.0F;
};

/// The pixels that filters of this radius read of the image for `region`.
Rect read_part(const Work& work, int radius) {
  const Rect& region = work.region;
  const Rect image = work.source.rect();
  Rect part = intersect(grow(region, radius), image);
  if (work.border != Border::Wrap) return part;
  if (region.x0 < radius || region.x1 + radius > image.x1) part.x0 = 0, part.x1 = image.x1;
  if (region.y0 < radius || region.y1 + radius > image.y1) part.y0 = 0, part.y1 = image.y1;
  return part;
}

/// The slopes after the Gaussian of `rest` (0: as they are), with what is not valid like its
/// surroundings.
SlopeImage smoothed_part(const Work& work, const Rect& part, float rest, float sigma) {
  const bool keep = rest == 0.0F;
  SlopeImage result = gaussian(work.source, work.validity, part, keep ? sigma : rest, work.border);
  if (work.validity.empty()) return result;
  for_pixels(part, [&](int x, int y) {
    Vec2f& out = result(x - part.x0, y - part.y0);
    if (!out.allFinite()) out = Vec2f::Zero();  // nothing valid near
    const float weight = work.validity(x, y);
    if (keep && weight > 0.0F) out = weight * work.source(x, y) + (1.0F - weight) * out;
  });
  return result;
}

/// -sigma^2 times the Laplacian of the smoothed slopes, as an image of the region's size.
SlopeImage negative_laplacian(const Work& work, float sigma) {
  const LaplacianParts parts(sigma);
  const int radius = parts.radius();
  const Rect part = read_part(work, radius);
  SlopeImage memory;
  ExtendedRows<Vec2f, false> rows(work.source, {}, work.border);
  if (parts.rest > 0.0F || !work.validity.empty()) {
    memory = smoothed_part(work, part, parts.rest, sigma);
    rows = {memory, {}, work.border, part, work.source.width(), work.source.height()};
  }
  SlopeImage result(work.region.width(), work.region.height());
  const PlainStore<Vec2f> store{{result, {work.region.x0, work.region.y0}}};
  const float factor = -sigma * sigma;
  const auto filter_row = [&](const Tile& tile, float* scratch, float* out) {
    const std::ptrdiff_t side = 2 * radius;
    const std::ptrdiff_t wide = tile.count + 2 * side;
    float* down = scratch;
    float* bent_down = down + wide;
    float* bent_along = bent_down + wide;
    fir_line(tile.at - side, wide, tile.stride, parts.smoothing, down);
    fir_differences(tile.at - side, wide, tile.stride, parts.bending, bent_down);
    fir_differences(down + side, tile.count, 2, parts.bending, bent_along);
    fir_line(bent_down + side, tile.count, 2, parts.smoothing, out);
    for (std::ptrdiff_t i = 0; i < tile.count; ++i) out[i] = factor * (bent_along[i] + out[i]);
  };
  filter_tiles(rows, work.region, TileSize(work.region, radius, radius, 2), filter_row, store);
  return result;
}

void pass_details(const Work& work, SlopeSpan target, const FilterOptions& o) {
  if (o.sigma == 0.0F) {
    write(work, target, [](int, int) -> Vec2f { return Vec2f::Zero(); });
  } else if (o.kind == FilterKind::LaplacianOfGaussian) {
    const SlopeImage bent = negative_laplacian(work, o.sigma);
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
  const LaplacianParts parts(options.sigma);
  return parts.radius() + gaussian_reach(parts.rest);
}

}  // namespace normalshop
