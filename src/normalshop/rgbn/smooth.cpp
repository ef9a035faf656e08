#include "normalshop/rgbn/smooth.h"

#include <cmath>
#include <string>
#include <vector>

#include "normalshop/core/error.h"
#include "normalshop/core/parallel.h"
#include "normalshop/rgbn/detail/gaussian_kernels.h"

namespace normalshop {

namespace {

/// Up to here the direct filter is as exact as it is fast (measured in benchmarks/bench_rgbn.cpp).
constexpr double fir_limit = 8.0;
/// Less than this weight of valid pixels in reach counts as none.
constexpr float least_weight = 1e-4F;

/// Gaussian along one panel, whatever the filter.
class LineFilter {
 public:
  explicit LineFilter(double sigma) {
    direct_ = sigma <= fir_limit;
    if (direct_) {
      fir_ = fir_kernel(sigma);
    } else {
      recursive_ = recursive_kernel(sigma);
    }
  }
  /// Samples that the panel must hold before the first and after the last one.
  int padding() const { return direct_ ? static_cast<int>(fir_.weights.size()) : 0; }
  /// `in` starts with the padding.
  void run(const float* in, int count, float* out) const {
    if (direct_) {
      fir_panel(in + padding() * panel_lanes, count, fir_, out);
    } else {
      recursive_panel(in, count, recursive_, out);
    }
  }

 private:
  bool direct_ = true;
  FirKernel fir_;
  RecursiveKernel recursive_{};
};

/// A range of samples along a line of `size` samples that continues its ends.
struct Range {
  int begin;
  int end;
  int clamped(int i, int size) const { return std::clamp(begin + i, 0, size - 1); }
  int count() const { return end - begin; }
};

/// Buffers of one task.
struct Panels {
  Panels(int in_samples, int out_samples)
      : in(panel_lanes, in_samples, 0.0F), out(panel_lanes, out_samples) {}
  Image<float> in;
  Image<float> out;
};

/// Where the numbers of C channels come from: load(x, y, float[C]) or a whole row.
template <int C>
constexpr int panel_pixels = panel_lanes / C;

/// Runs body(panel index, panels) over all panels in parallel, reusing buffers within a task.
template <class Body>
void for_each_panel(int panels, int in_samples, int out_samples, const Body& body) {
  parallel_for(static_cast<std::size_t>(panels), 1, [&](std::size_t a, std::size_t b) {
    Panels buffers(in_samples, out_samples);
    for (std::size_t i = a; i < b; ++i) body(static_cast<int>(i), buffers);
  });
}

/// The part of a line that is held: the region with its reach, within the image.
Range with_reach(int begin, int end, int margin, int size) {
  return {std::max(0, begin - margin), std::min(size, end + margin)};
}

/// Filters down the columns [columns) of a source and writes the rows [region.y0, region.y1) of all
/// of them into `target`, whose origin is (columns.begin, region.y0). load(x, y, out) gives a
/// pixel.
template <int C, class Load>
void filter_columns(const Load& load, int height, const Range& columns, const Rect& region,
                    int margin, const LineFilter& filter, Image<float>& target) {
  constexpr int pixels = panel_pixels<C>;
  const Range held = with_reach(region.y0, region.y1, margin, height);
  const int pad = filter.padding();
  const int skip = pad > 0 ? region.y0 - pad : held.begin;
  const int in_samples = pad > 0 ? region.height() + 2 * pad : held.count();
  const int count = pad > 0 ? region.height() : held.count();
  for_each_panel(
      (columns.count() + pixels - 1) / pixels, in_samples, count, [&](int panel, Panels& buffers) {
        const int x0 = columns.begin + panel * pixels;
        const int x1 = std::min(x0 + pixels, columns.end);
        for (int i = 0; i < in_samples; ++i) {
          float* to = buffers.in.row(i);
          load(x0, x1, std::clamp(skip + i, 0, height - 1), to);
        }
        filter.run(buffers.in.data(), count, buffers.out.data());
        for (int y = region.y0; y < region.y1; ++y) {
          const float* from = buffers.out.row(pad > 0 ? y - region.y0 : y - skip);
          std::copy_n(from, (x1 - x0) * C, target.row(y - region.y0) + (x0 - columns.begin) * C);
        }
      });
}

/// Filters along the rows of `source` (origin (columns.begin, region.y0), `width` the whole
/// image's) and hands every pixel of the region to store(x, y, const float[C]).
template <int C, class Store>
void filter_rows(const Image<float>& source, const Range& columns, const Rect& region,
                 const LineFilter& filter, const Store& store) {
  constexpr int pixels = panel_pixels<C>;
  const int pad = filter.padding();
  const int first = pad > 0 ? region.x0 - pad : columns.begin;
  const int in_samples = pad > 0 ? region.width() + 2 * pad : columns.count();
  const int count = pad > 0 ? region.width() : columns.count();
  for_each_panel((region.height() + pixels - 1) / pixels, in_samples, count,
                 [&](int panel, Panels& buffers) {
                   const int y0 = panel * pixels;
                   const int rows = std::min(pixels, region.height() - y0);
                   for (int r = 0; r < rows; ++r) {
                     const float* from = source.row(y0 + r);
                     float* to = buffers.in.data() + r * C;
                     for (int i = 0; i < in_samples; ++i, to += panel_lanes) {
                       const int x = std::clamp(first + i - columns.begin, 0, columns.count() - 1);
                       for (int c = 0; c < C; ++c) to[c] = from[x * C + c];
                     }
                   }
                   filter.run(buffers.in.data(), count, buffers.out.data());
                   for (int r = 0; r < rows; ++r) {
                     const float* from =
                         buffers.out.data() + r * C +
                         static_cast<std::ptrdiff_t>(pad > 0 ? 0 : region.x0 - first) * panel_lanes;
                     for (int x = region.x0; x < region.x1; ++x, from += panel_lanes) {
                       store(x, region.y0 + y0 + r, from);
                     }
                   }
                 });
}

template <int C, class Load, class Store>
void filter(const Load& load, const Rect& image, const Rect& region, const SmoothOptions& options,
            const Store& store) {
  const LineFilter line(static_cast<double>(options.sigma));
  const int margin = reach(options);
  const Range columns = with_reach(region.x0, region.x1, margin, image.width());
  Image<float> between(columns.count() * C, region.height());
  filter_columns<C>(load, image.height(), columns, region, margin, line, between);
  filter_rows<C>(between, columns, region, line, store);
}

template <class T>
constexpr int channels_of = static_cast<int>(sizeof(T) / sizeof(float));

template <class T>
const float* numbers(const T* pixel) {
  if constexpr (channels_of<T> == 1) {
    return pixel;
  } else {
    return pixel->data();
  }
}

template <class T>
void set(T& pixel, const float* from) {
  if constexpr (channels_of<T> == 1) {
    pixel = *from;
  } else {
    pixel = Eigen::Map<const T>(from);
  }
}

template <class T>
void smooth_all(ImageView<T> source, ImageSpan<T> target, const Rect& region,
                const SmoothOptions& options) {
  constexpr int C = channels_of<T>;
  filter<C>([&](int x0, int x1, int y,
                float* to) { std::copy_n(numbers(source.row(y) + x0), (x1 - x0) * C, to); },
            source.rect(), region, options,
            [&](int x, int y, const float* from) { set(target(x, y), from); });
}

/// Normalised convolution: filters validity * source and validity.
template <class T>
void smooth_valid(ImageView<T> source, MaskView validity, ImageSpan<T> target, const Rect& region,
                  const SmoothOptions& options) {
  constexpr int C = channels_of<T>;
  filter<C + 1>(
      [&](int x0, int x1, int y, float* to) {
        for (int x = x0; x < x1; ++x) {
          const float weight = validity(x, y);
          const float* from = numbers(source.row(y) + x);
          for (int c = 0; c < C; ++c) *to++ = weight > 0.0F ? weight * from[c] : 0.0F;
          *to++ = weight;
        }
      },
      source.rect(), region, options,
      [&](int x, int y, const float* from) {
        if (!(from[C] > least_weight)) {
          target(x, y) = source(x, y);
          return;
        }
        std::array<float, C> out;
        for (int c = 0; c < C; ++c) out[static_cast<std::size_t>(c)] = from[c] / from[C];
        set(target(x, y), out.data());
      });
}

template <class T>
Rect smooth_any(ImageView<T> source, MaskView validity, ImageSpan<T> target, Rect region,
                const SmoothOptions& options) {
  if (!(options.sigma >= 0.0F) || !std::isfinite(options.sigma)) {
    throw InvalidInput("smooth: sigma must be a number of at least 0");
  }
  assert(source.rect() == target.rect());
  region = intersect(region, target.rect());
  if (region.empty()) return {};
  if (options.sigma == 0.0F) {
    for (int y = region.y0; y < region.y1; ++y) {
      std::copy(source.row(y) + region.x0, source.row(y) + region.x1, target.row(y) + region.x0);
    }
  } else if (validity.empty()) {
    smooth_all(source, target, region, options);
  } else {
    smooth_valid(source, validity, target, region, options);
  }
  return region;
}

}  // namespace

Rect smooth(SlopeView source, MaskView validity, SlopeSpan target, Rect region,
            const SmoothOptions& options) {
  return smooth_any<Vec2f>(source, validity, target, region, options);
}

Rect smooth(MaskView source, MaskView validity, MaskSpan target, Rect region,
            const SmoothOptions& options) {
  return smooth_any<float>(source, validity, target, region, options);
}

Rect smooth(ColorView source, MaskView validity, ColorSpan target, Rect region,
            const SmoothOptions& options) {
  return smooth_any<Vec3f>(source, validity, target, region, options);
}

int reach(const SmoothOptions& options) {
  return static_cast<int>(std::ceil(4.0 * static_cast<double>(options.sigma)));
}

}  // namespace normalshop
