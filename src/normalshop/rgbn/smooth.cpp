#include "normalshop/rgbn/smooth.h"

#include <cmath>

#include "normalshop/core/error.h"
#include "normalshop/rgbn/detail/filter_rows.h"
#include "normalshop/rgbn/detail/gaussian.h"
#include "normalshop/rgbn/detail/lattice.h"
#include "normalshop/rgbn/detail/rows.h"
#include "normalshop/rgbn/detail/tile_filter.h"

namespace normalshop {

namespace {

/// Up to here the direct filter is the fastest: among pixels, and among the few points of a
/// lattice, where it is nearly free.
constexpr double pixels_limit = 4.0;
constexpr double points_limit = 16.0;

/// The Gaussian along one axis, or with bend != 0 bend times its second derivative, of which the
/// filter takes the sum over both axes.
struct Axis {
  double sigma;
  double bend = 0.0;
};
struct Axes {
  Axis x;
  Axis y;
};

Lattice lattice_of(const Axis& axis, double limit) {
  return {axis.sigma,
          axis.sigma <= limit ? 1 : std::clamp(static_cast<int>(axis.sigma / 1.6), 2, 8)};
}

/// What is left to do between the points of a lattice.
Axis rest_of(const Axis& axis, const Lattice& lattice) {
  return {lattice.rest, axis.bend / (lattice.step * lattice.step)};
}

struct AxisWeights {
  explicit AxisWeights(const Axis& axis) : smoothing(gaussian_weights(axis.sigma)) {
    if (axis.bend == 0.0) return;
    bending = bending_weights(axis.sigma);
    for (double& w : bending) w *= axis.bend;
  }
  int radius() const { return static_cast<int>(std::max(smoothing.size(), bending.size())); }
  std::vector<double> smoothing;
  std::vector<double> bending;
};

int axis_reach(const Axis& axis, double limit) {
  if (axis.sigma <= limit) return AxisWeights(axis).radius();
  const Lattice lattice = lattice_of(axis, limit);
  const int points = axis_reach(rest_of(axis, lattice), points_limit) + lattice.after;
  return points * lattice.step + lattice.radius();
}

/// The sums of one axis over numbers that are `step` apart.
struct AxisSums {
  AxisSums(const AxisWeights& weights, std::ptrdiff_t step)
      : smoothing(line_pairs(weights.smoothing, step)),
        bending(line_pairs(weights.bending, step)) {}
  WeightedPairs smoothing;
  WeightedPairs bending;
};

/// Finite filters down and along tiles.
template <class Rows, class Store>
void filter_direct(const Rows& rows, const Rect& region, const Axes& axes, const Store& store) {
  constexpr std::ptrdiff_t channels = Rows::channels;
  const AxisWeights x(axes.x);
  const AxisWeights y(axes.y);
  const TileSize size(region, x.radius(), y.radius(), Rows::channels);
  const AxisSums along(x, channels);
  const AxisSums down(y, size.stride());
  const std::ptrdiff_t side = x.radius() * channels;
  const auto filter_row = [&](const Tile& tile, float* scratch, float* out) {
    const std::ptrdiff_t wide = tile.count + 2 * side;
    pairs_around(tile.at - side, wide, down.smoothing, scratch);
    if (x.bending.empty()) return pairs_around(scratch + side, tile.count, along.smoothing, out);
    float* bent_down = scratch + wide;
    float* bent_along = bent_down + wide;
    pairs_only(tile.at - side, wide, down.bending, bent_down);
    pairs_only(scratch + side, tile.count, along.bending, bent_along);
    pairs_around(bent_down + side, tile.count, along.smoothing, out);
    for (std::ptrdiff_t i = 0; i < tile.count; ++i) out[i] += bent_along[i];
  };
  filter_tiles(rows, region, size, filter_row, store);
}

/// The points that there are along an axis of n pixels. Beyond those of Clamp all are alike.
struct Range {
  int begin;
  int end;
};
Range all_points(const Lattice& lattice, int n, int reach, Border border) {
  const int radius = lattice.radius();
  if (border == Border::Clamp) {
    return {lattice.point_of(-radius), lattice.point_of(n - 1 + radius + lattice.step - 1) + 1};
  }
  return {lattice.point_of(0) - lattice.before - reach,
          lattice.point_of(n - 1) + lattice.after + reach + 1};
}

template <class Rows, class Store>
void filter_axes(const Rows& rows, const Rect& region, const Axes& axes, double limit,
                 const Store& store) {
  if (std::max(axes.x.sigma, axes.y.sigma) <= limit) {
    return filter_direct(rows, region, axes, store);
  }
  using Pixel = Numbers<Rows::channels>;
  const Lattices lattices{lattice_of(axes.x, limit), lattice_of(axes.y, limit)};
  const Axes rest{rest_of(axes.x, lattices.x), rest_of(axes.y, lattices.y)};
  const int reach_x = axis_reach(rest.x, points_limit);
  const int reach_y = axis_reach(rest.y, points_limit);
  const Range across = all_points(lattices.x, rows.width(), reach_x, rows.border());
  const Range down = all_points(lattices.y, rows.height(), reach_y, rows.border());
  const auto from_first = [&](const Rect& r) {
    return Rect{r.x0 - across.begin, r.y0 - down.begin, r.x1 - across.begin, r.y1 - down.begin};
  };
  const Rect wanted = lattices.points_for(region);
  const Rect held = intersect(
      {wanted.x0 - reach_x, wanted.y0 - reach_y, wanted.x1 + reach_x, wanted.y1 + reach_y},
      {across.begin, down.begin, across.end, down.end});
  const Image<Pixel> points = take_points(rows, lattices, held);
  const ExtendedRows<Pixel, false> point_rows(points, {}, Border::Clamp, from_first(held),
                                              across.end - across.begin, down.end - down.begin);
  Image<Pixel> filtered(wanted.width(), wanted.height());
  const Rect inner = from_first(wanted);
  filter_axes(point_rows, inner, rest, points_limit,
              PlainStore<Pixel>{{filtered, {inner.x0, inner.y0}}});
  join_points<Rows::channels>(filtered, lattices, region, store);
}

/// What repeats is flat after a Gaussian as wide as its period (to 3e-9), so that wider ones give
/// the same.
double useful_sigma(float sigma, int n, Border border) {
  const auto wide = static_cast<double>(sigma);
  if (border == Border::Clamp) return wide;
  return std::min(wide, border == Border::Wrap ? 1.0 * n : 2.0 * n);
}

Axes gaussian_axes(float sigma, const Rect& image, Border border) {
  return {{useful_sigma(sigma, image.width(), border)},
          {useful_sigma(sigma, image.height(), border)}};
}

template <class T>
void smooth_into(ImageView<T> source, MaskView validity, const Rect& region, float sigma,
                 Border border, const Output<T>& output) {
  const Axes axes = gaussian_axes(sigma, source.rect(), border);
  if (validity.empty()) {
    filter_axes(ExtendedRows<T, false>(source, validity, border), region, axes, pixels_limit,
                PlainStore<T>{output});
  } else {
    filter_axes(ExtendedRows<T, true>(source, validity, border), region, axes, pixels_limit,
                ValidStore<T>{output, source});
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

SlopeImage laplacian(SlopeView source, MaskView validity, const Rect& region, float sigma,
                     Border border) {
  Axes axes = gaussian_axes(sigma, source.rect(), border);
  for (Axis* axis : {&axes.x, &axes.y}) axis->bend = -axis->sigma * axis->sigma;
  SlopeImage result(region.width(), region.height());
  const Origin origin{region.x0, region.y0};
  if (validity.empty()) {
    filter_axes(ExtendedRows<Vec2f, false>(source, validity, border), region, axes, pixels_limit,
                PlainStore<Vec2f>{{result, origin}});
    return result;
  }
  using Weighed = Numbers<3>;
  Image<Weighed> bent(region.width(), region.height());
  filter_axes(ExtendedRows<Vec2f, true>(source, validity, border), region, axes, pixels_limit,
              PlainStore<Weighed>{{bent, origin}});
  const SlopeImage mean = gaussian(source, validity, region, sigma, border);
  for_pixels(result.rect(), [&](int x, int y) {
    const auto& [bent_x, bent_y, weight] = bent(x, y);
    result(x, y) = Vec2f(bent_x, bent_y) - weight * mean(x, y);
  });
  return result;
}

int gaussian_reach(float sigma) {
  return sigma > 0.0F ? axis_reach({static_cast<double>(sigma)}, pixels_limit) : 0;
}

int laplacian_reach(float sigma) {
  return sigma > 0.0F ? axis_reach({static_cast<double>(sigma), 1.0}, pixels_limit) : 0;
}

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
