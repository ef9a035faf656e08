#include "normalshop/rgbn/smooth.h"

#include <cmath>

#include "normalshop/core/error.h"
#include "normalshop/rgbn/detail/filter_rows.h"
#include "normalshop/rgbn/detail/gaussian.h"
#include "normalshop/rgbn/detail/recursive_filter.h"
#include "normalshop/rgbn/detail/tile_filter.h"

namespace normalshop {

namespace {

/// Up to here the direct filter is faster than the recursive one.
constexpr double fir_limit = 5.0;
/// Samples, in sigmas, after which the recursive filter has forgotten where it began.
constexpr double memory_in_sigmas = 10.0;

int ceil_to_int(double x) { return static_cast<int>(std::ceil(x)); }

}  // namespace

LinePlan::LinePlan(int line_begin, int line_end, int n, double line_sigma, Border border)
    : begin(line_begin), end(line_end), held_end(n) {
  if (border == Border::Clamp) {
    kernel = recursive_kernel(line_sigma);
    const int margin = gaussian_reach(static_cast<float>(line_sigma));
    before = std::min(begin, margin);
    after = std::min(n - end, margin);
    held_begin = begin - before;
    held_end = end + after;
    return;
  }
  // What repeats is flat after a Gaussian as wide as its period (to 3e-9).
  const double sigma = std::min(line_sigma, border == Border::Wrap ? 1.0 * n : 2.0 * n);
  kernel = recursive_kernel(sigma);
  rests = false;
  const bool whole = end - begin == n;
  before = after =
      whole ? ceil_to_int(memory_in_sigmas * sigma) : gaussian_reach(static_cast<float>(sigma));
  if (end - begin + 2 * before >= n) return;
  held_begin = begin - before;
  held_end = end + after;
}

namespace {

/// Finite Gaussians down and along tiles.
template <class Rows, class Store>
void smooth_direct(const Rows& rows, const Rect& region, double sigma, const Store& store) {
  const FirKernel kernel = fir_kernel(sigma);
  constexpr std::ptrdiff_t channels = Rows::channels;
  const std::ptrdiff_t side = kernel.radius() * channels;
  const auto filter_row = [&](const Tile& tile, float* scratch, float* out) {
    fir_line(tile.at - side, tile.count + 2 * side, tile.stride, kernel, scratch);
    fir_line(scratch + side, tile.count, channels, kernel, out);
  };
  const TileSize size(region, kernel.radius(), kernel.radius(), Rows::channels);
  filter_tiles(rows, region, size, filter_row, store);
}

/// The output as numbers.
template <class T>
ImageSpan<float> number_span(const Output<T>& output, const Rect& region) {
  constexpr int channels = channels_of<T>;
  T* first = output.at(region.x0, region.y0);
  const std::ptrdiff_t stride =
      region.height() > 1 ? output.at(region.x0, region.y0 + 1) - first : region.width();
  return {numbers(first), region.width() * channels, region.height(), stride * channels};
}

template <class Rows, class Store>
void smooth_recursive(const Rows& rows, const Rect& region, double sigma, const Store& store) {
  const int width = rows.width();
  const LinePlan across(region.x0, region.x1, width, sigma, rows.border());
  const LinePlan down(region.y0, region.y1, rows.height(), sigma, rows.border());
  const int x0 = across.held_begin;
  const int x1 = across.held_end;
  // The columns' results stay in the target where they fit.
  const bool fits = !Rows::is_masked && x0 == region.x0 && x1 == region.x1;
  Image<float> memory;
  if (!fits) memory.resize((x1 - x0) * Rows::channels, region.height());
  const ImageSpan<float> between =
      fits ? number_span(store.output, region) : ImageSpan<float>(memory);
  filter_columns(rows, x0, x1, down, between);
  filter_rows<Rows>(BetweenRows{between, x0, x1, width, rows.border()}, region.y0, across, store);
}

template <class Rows, class Store>
void smooth_rows(const Rows& rows, const Rect& region, double sigma, const Store& store) {
  if (sigma <= fir_limit) {
    smooth_direct(rows, region, sigma, store);
  } else {
    smooth_recursive(rows, region, sigma, store);
  }
}

template <class T>
void smooth_into(ImageView<T> source, MaskView validity, const Rect& region, float sigma,
                 Border border, const Output<T>& output) {
  const auto wide = static_cast<double>(sigma);
  if (validity.empty()) {
    const ExtendedRows<T, false> rows(source, validity, border);
    smooth_rows(rows, region, wide, PlainStore<T>{output});
  } else {
    const ExtendedRows<T, true> rows(source, validity, border);
    smooth_rows(rows, region, wide, ValidStore<T>{output, source});
  }
}

template <class T>
Rect smooth_any(ImageView<T> source, MaskView validity, ImageSpan<T> target, Rect region,
                const SmoothOptions& options, Border border) {
  if (!(options.sigma >= 0.0F) || !std::isfinite(options.sigma)) {
    throw InvalidInput("smooth: sigma must be a number of at least 0");
  }
  assert(source.rect() == target.rect());
  region = intersect(region, target.rect());
  if (region.empty()) return {};
  if (options.sigma == 0.0F) {
    copy_rows(source, {}, target, region);
    return region;
  }
  write_apart<T>(target, region, share_memory(target, source) || share_memory(target, validity),
                 [&](const Output<T>& output) {
                   smooth_into(source, validity, region, options.sigma, border, output);
                 });
  return region;
}

}  // namespace

SlopeImage gaussian(SlopeView source, MaskView validity, const Rect& region, float sigma,
                    Border border) {
  SlopeImage result(region.width(), region.height());
  smooth_into(source, validity, region, sigma, border,
              Output<Vec2f>{result, {region.x0, region.y0}});
  return result;
}

int gaussian_reach(float sigma) { return ceil_to_int(4.0 * static_cast<double>(sigma)); }

Rect smooth(SlopeView source, MaskView validity, SlopeSpan target, Rect region,
            const SmoothOptions& options, Border border) {
  return smooth_any<Vec2f>(source, validity, target, region, options, border);
}

Rect smooth(MaskView source, MaskView validity, MaskSpan target, Rect region,
            const SmoothOptions& options, Border border) {
  return smooth_any<float>(source, validity, target, region, options, border);
}

Rect smooth(ColorView source, MaskView validity, ColorSpan target, Rect region,
            const SmoothOptions& options, Border border) {
  return smooth_any<Vec3f>(source, validity, target, region, options, border);
}

int reach(const SmoothOptions& options) { return gaussian_reach(options.sigma); }

}  // namespace normalshop
