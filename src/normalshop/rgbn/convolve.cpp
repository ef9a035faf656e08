#include "normalshop/rgbn/convolve.h"

#include <cmath>
#include <optional>
#include <vector>

#include "normalshop/core/error.h"
#include "normalshop/rgbn/detail/filter_rows.h"
#include "normalshop/rgbn/detail/line_kernels.h"
#include "normalshop/rgbn/detail/tile_filter.h"

namespace normalshop {

namespace {

/// A kernel is a column times a row when no weight differs from that by more than this part of the
/// largest: the rounding of single precision.
constexpr double rank_tolerance = 3e-7;

/// Weights of a kernel, turned round so that they belong to the pixels that they multiply.
struct Weights {
  int radius_x = 0;
  int radius_y = 0;
  std::vector<double> values;

  int width() const { return 2 * radius_x + 1; }
  int height() const { return 2 * radius_y + 1; }
  double& operator()(int x, int y) { return values[static_cast<std::size_t>(y * width() + x)]; }
  double operator()(int x, int y) const {
    return values[static_cast<std::size_t>(y * width() + x)];
  }
  double sum() const {
    double total = 0.0;
    for (const double w : values) total += w;
    return total;
  }
  Weights absolute() const {
    Weights result = *this;
    for (double& w : result.values) w = std::abs(w);
    return result;
  }
};

Weights read_weights(KernelView kernel, bool normalize) {
  if (kernel.width() % 2 == 0 || kernel.height() % 2 == 0) {
    throw InvalidInput("convolve: the kernel must have sides of an odd number of pixels");
  }
  Weights weights{kernel.width() / 2, kernel.height() / 2, {}};
  for (int y = kernel.height() - 1; y >= 0; --y) {
    for (int x = kernel.width() - 1; x >= 0; --x) {
      if (!std::isfinite(kernel(x, y))) {
        throw InvalidInput("convolve: the kernel's weights must be finite numbers");
      }
      weights.values.push_back(static_cast<double>(kernel(x, y)));
    }
  }
  if (!normalize) return weights;
  const double sum = weights.sum();
  if (!(std::abs(sum) > 1e-6 * weights.absolute().sum())) {
    throw InvalidInput("convolve: a kernel that is to be normalised must have a sum other than 0");
  }
  for (double& w : weights.values) w /= sum;
  return weights;
}

struct ColumnAndRow {
  std::vector<double> column;
  std::vector<double> row;
};

std::optional<ColumnAndRow> take_apart(const Weights& weights) {
  int px = 0;
  int py = 0;
  for (int y = 0; y < weights.height(); ++y) {
    for (int x = 0; x < weights.width(); ++x) {
      if (!(std::abs(weights(x, y)) > std::abs(weights(px, py)))) continue;
      px = x;
      py = y;
    }
  }
  const double largest = weights(px, py);
  if (largest == 0.0) return std::nullopt;
  ColumnAndRow parts;
  for (int y = 0; y < weights.height(); ++y) parts.column.push_back(weights(px, y));
  for (int x = 0; x < weights.width(); ++x) parts.row.push_back(weights(x, py) / largest);
  for (int y = 0; y < weights.height(); ++y) {
    for (int x = 0; x < weights.width(); ++x) {
      const double product =
          parts.column[static_cast<std::size_t>(y)] * parts.row[static_cast<std::size_t>(x)];
      if (std::abs(product - weights(x, y)) > rank_tolerance * std::abs(largest)) {
        return std::nullopt;
      }
    }
  }
  return parts;
}

WeightedSum line_sum(const std::vector<double>& weights, std::ptrdiff_t step) {
  WeightedSum sum;
  const auto radius = static_cast<std::ptrdiff_t>(weights.size() / 2);
  for (std::size_t i = 0; i < weights.size(); ++i) {
    sum.add((static_cast<std::ptrdiff_t>(i) - radius) * step, static_cast<float>(weights[i]));
  }
  return sum;
}

/// Applies weights to the rows of a tile.
class TileKernel {
 public:
  TileKernel(const Weights& weights, std::ptrdiff_t channels, std::ptrdiff_t stride)
      : side_(weights.radius_x * channels) {
    const bool small = weights.width() * weights.height() <= weights.width() + weights.height();
    const auto parts = small ? std::nullopt : take_apart(weights);
    if (parts) {
      down_ = line_sum(parts->column, stride);
      all_ = line_sum(parts->row, channels);
      return;
    }
    for (int y = 0; y < weights.height(); ++y) {
      for (int x = 0; x < weights.width(); ++x) {
        all_.add((y - weights.radius_y) * stride + (x - weights.radius_x) * channels,
                 static_cast<float>(weights(x, y)));
      }
    }
  }
  void apply(const Tile& tile, float* scratch, float* out) const {
    if (down_.weights.empty()) return weighted_sum(tile.at, tile.count, all_, out);
    weighted_sum(tile.at - side_, tile.count + 2 * side_, down_, scratch);
    weighted_sum(scratch + side_, tile.count, all_, out);
  }

 private:
  std::ptrdiff_t side_;
  WeightedSum down_;  ///< empty: all in one
  WeightedSum all_;
};

/// Takes for every pixel the sums of weights times valid pixels and of weights times validity, and
/// after a whole row of those the same sums of the weights' sizes.
template <class T>
struct FilledStore {
  Output<T> output;
  ImageView<T> source;
  float sum;           ///< of the weights
  float least_weight;  ///< less than this of their sizes counts as nothing valid in reach

  float* begin(int /*x0*/, int /*y*/, float* free) const { return free; }
  void end(int x0, int x1, int y, const float* from) const {
    constexpr int channels = channels_of<T>;
    const float* sizes = from + (x1 - x0) * (channels + 1);
    T* to = output.at(x0, y);
    for (int i = 0; i < x1 - x0; ++i, from += channels + 1, sizes += channels + 1) {
      if (!(sizes[channels] > least_weight)) {
        to[i] = source(x0 + i, y);
        continue;
      }
      const float missing = sum - from[channels];
      for (int c = 0; c < channels; ++c) {
        numbers(to + i)[c] = from[c] + missing * (sizes[c] / sizes[channels]);
      }
    }
  }
};

template <class T>
void convolve_all(ImageView<T> source, const Weights& weights, const Rect& region, Border border,
                  const Output<T>& output) {
  using Rows = ExtendedRows<T, false>;
  const Rows rows(source, {}, border);
  const TileSize size(region, weights.radius_x, weights.radius_y, Rows::channels);
  const TileKernel kernel(weights, Rows::channels, size.stride());
  filter_tiles(
      rows, region, size,
      [&](const Tile& tile, float* scratch, float* out) { kernel.apply(tile, scratch, out); },
      PlainStore<T>{output});
}

template <class T>
void convolve_valid(ImageView<T> source, MaskView validity, const Weights& weights,
                    const Rect& region, Border border, const Output<T>& output) {
  using Rows = ExtendedRows<T, true>;
  const Rows rows(source, validity, border);
  const Weights sizes = weights.absolute();
  const TileSize size(region, weights.radius_x, weights.radius_y, Rows::channels);
  const TileKernel kernel(weights, Rows::channels, size.stride());
  const TileKernel size_kernel(sizes, Rows::channels, size.stride());
  const FilledStore<T> store{output, source, static_cast<float>(weights.sum()),
                             static_cast<float>(1e-4 * sizes.sum())};
  filter_tiles(
      rows, region, size,
      [&](const Tile& tile, float* scratch, float* out) {
        kernel.apply(tile, scratch, out);
        size_kernel.apply(tile, scratch, out + tile.count);
      },
      store);
}

template <class T>
Rect convolve_any(ImageView<T> source, MaskView validity, KernelView kernel, ImageSpan<T> target,
                  Rect region, const ConvolveOptions& options) {
  const Weights weights = read_weights(kernel, options.normalize);
  assert(source.rect() == target.rect());
  region = intersect(region, target.rect());
  if (region.empty()) return {};
  write_apart<T>(target, region, share_memory(target, source) || share_memory(target, validity),
                 [&](const Output<T>& output) {
                   if (validity.empty()) {
                     convolve_all(source, weights, region, options.border, output);
                   } else {
                     convolve_valid(source, validity, weights, region, options.border, output);
                   }
                 });
  return region;
}

}  // namespace

Rect convolve(SlopeView source, MaskView validity, KernelView kernel, SlopeSpan target, Rect region,
              const ConvolveOptions& options) {
  return convolve_any<Vec2f>(source, validity, kernel, target, region, options);
}

Rect convolve(MaskView source, MaskView validity, KernelView kernel, MaskSpan target, Rect region,
              const ConvolveOptions& options) {
  return convolve_any<float>(source, validity, kernel, target, region, options);
}

int reach(KernelView kernel) { return std::max(kernel.width(), kernel.height()) / 2; }

}  // namespace normalshop
