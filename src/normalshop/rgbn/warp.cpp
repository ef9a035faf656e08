#include "normalshop/rgbn/warp.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <vector>

#include "normalshop/core/error.h"
#include "normalshop/core/parallel.h"
#include "normalshop/core/sample.h"

namespace normalshop {

namespace {

/// Pixels whose points are asked for at once.
constexpr int run_pixels = 256;
constexpr double most_samples = 64.0;
/// A step of sqrt(1 + this) pixels: averaging over less changes nothing that one could see.
constexpr double least_excess = 0.02;
/// Less than this weight of valid pixels counts as none.
constexpr float least_weight = 1e-4F;
constexpr double least_determinant = 1e-6;

/// A place between pixel centres.
struct Place {
  int x = 0;
  int y = 0;
  float fx = 0.0F;
  float fy = 0.0F;

  explicit Place(const Vec2d& p) {
    if (!(std::abs(p.x()) < 1e9 && std::abs(p.y()) < 1e9)) return;
    x = floor_of(p.x());
    y = floor_of(p.y());
    fx = static_cast<float>(p.x() - static_cast<double>(x));
    fy = static_cast<float>(p.y() - static_cast<double>(y));
  }
  bool on_center() const { return fx == 0.0F && fy == 0.0F; }

 private:
  static int floor_of(double v) {
    const int i = static_cast<int>(v);
    return i - (static_cast<double>(i) > v ? 1 : 0);
  }
};

/// One axis of the samples that are averaged: offsets from the centre in pixels of the target.
struct Spread {
  int count = 1;
  double step = 0.0;

  explicit Spread(double squared_pixels) {
    const double excess = squared_pixels - 1.0;
    if (!(excess > least_excess)) return;
    count = 1 + static_cast<int>(std::min(std::ceil(std::sqrt(excess)), most_samples - 1.0));
    step = std::sqrt(excess / squared_pixels) / static_cast<double>(count);
  }
  double offset(int i) const {
    return (static_cast<double>(i) - 0.5 * static_cast<double>(count - 1)) * step;
  }
};

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

/// Reads one image beyond its border. Reflected slopes change their sign.
template <class T>
class Source {
 public:
  Source(ImageView<T> image, Border border) : image_(image), border_(border) {}

  T pixel(int x, int y) const {
    const BorderPixel px = border_pixel(x, image_.width(), border_);
    const BorderPixel py = border_pixel(y, image_.height(), border_);
    T value = image_(px.index, py.index);
    if constexpr (channels_of<T> == 2) {
      if (px.flipped) value.x() = -value.x();
      if (py.flipped) value.y() = -value.y();
    }
    return value;
  }

  T bicubic(const Place& p) const {
    if (p.on_center()) return pixel(p.x, p.y);
    const std::array<float, 4> wx = cubic_weights(p.fx);
    const std::array<float, 4> wy = cubic_weights(p.fy);
    Line line = Line::Zero();
    if (p.x >= 1 && p.y >= 1 && p.x + 2 < image_.width() && p.y + 2 < image_.height()) {
      for (int j = 0; j < 4; ++j) {
        line += Eigen::Map<const Line>(numbers(image_.row(p.y + j - 1) + (p.x - 1))) *
                wy[static_cast<std::size_t>(j)];
      }
    } else {
      std::array<T, 4> row;
      for (int j = 0; j < 4; ++j) {
        for (int i = 0; i < 4; ++i) {
          row[static_cast<std::size_t>(i)] = pixel(p.x + i - 1, p.y + j - 1);
        }
        line += Eigen::Map<const Line>(numbers(row.data())) * wy[static_cast<std::size_t>(j)];
      }
    }
    return across(line, wx);
  }

 private:
  /// Four pixels side by side.
  using Line = Eigen::Array<float, 4 * channels_of<T>, 1>;

  static T across(const Line& line, const std::array<float, 4>& weights) {
    constexpr int C = channels_of<T>;
    T sum = zero<T>();
    for (int i = 0; i < 4; ++i) {
      if constexpr (C == 1) {
        sum += line[i] * weights[static_cast<std::size_t>(i)];
      } else {
        sum += line.template segment<C>(C * i).matrix() * weights[static_cast<std::size_t>(i)];
      }
    }
    return sum;
  }

  ImageView<T> image_;
  Border border_;
};

/// Mean of the source over what a pixel of the target shows of it.
template <class T>
class Sampler {
 public:
  Sampler(ImageView<T> image, MaskView validity, const WarpOptions& options)
      : source_(image, options.border),
        validity_(validity, options.border),
        all_valid_(validity.empty()),
        averages_(options.reduction == WarpReduction::Average) {}

  T operator()(const WarpPoint& point) const {
    if (!averages_) return single(Place(point.position));
    const Spread across(point.jacobian.col(0).squaredNorm());
    const Spread down(point.jacobian.col(1).squaredNorm());
    if (across.count * down.count == 1) return single(Place(point.position));
    Sum sum;
    for (int j = 0; j < down.count; ++j) {
      for (int i = 0; i < across.count; ++i) {
        const Vec2d at = point.position + point.jacobian.col(0) * across.offset(i) +
                         point.jacobian.col(1) * down.offset(j);
        add(Place(at), sum);
      }
    }
    if (sum.weight > least_weight) return sum.weighted / sum.weight;
    return source_.bicubic(Place(point.position));
  }

 private:
  struct Sum {
    T weighted = zero<T>();
    float weight = 0.0F;
  };

  T single(const Place& p) const {
    if (all_valid_ || p.on_center()) return source_.bicubic(p);
    Sum sum;
    add(p, sum);
    return sum.weight > least_weight ? T(sum.weighted / sum.weight) : source_.bicubic(p);
  }

  void add(const Place& p, Sum& sum) const {
    const float weight = all_valid_ ? 1.0F : common_validity(p);
    if (weight > 0.0F) {
      sum.weighted += weight * source_.bicubic(p);
      sum.weight += weight;
    } else {
      add_bilinear(p, sum);
    }
  }

  /// The validity of all pixels that the bicubic filter reads, 0 where they differ.
  float common_validity(const Place& p) const {
    const float first = validity_.pixel(p.x - 1, p.y - 1);
    for (int j = -1; j <= 2; ++j) {
      for (int i = -1; i <= 2; ++i) {
        if (validity_.pixel(p.x + i, p.y + j) != first) return 0.0F;
      }
    }
    return first;
  }

  void add_bilinear(const Place& p, Sum& sum) const {
    for (int j = 0; j < 2; ++j) {
      for (int i = 0; i < 2; ++i) {
        const float weight = (i == 0 ? 1.0F - p.fx : p.fx) * (j == 0 ? 1.0F - p.fy : p.fy) *
                             validity_.pixel(p.x + i, p.y + j);
        if (!(weight > 0.0F)) continue;  // what does not count may not even be a number
        sum.weighted += weight * source_.pixel(p.x + i, p.y + j);
        sum.weight += weight;
      }
    }
  }

  Source<T> source_;
  Source<float> validity_;
  bool all_valid_;
  bool averages_;
};

double determinant(const Eigen::Matrix2d& m) { return m(0, 0) * m(1, 1) - m(0, 1) * m(1, 0); }

/// DW^T slopes. The slopes' y is up and the map's is down, which negates what mixes x and y.
Vec2f turn(const Vec2f& slopes, const Eigen::Matrix2d& jacobian, WarpHeights heights) {
  if (jacobian == Eigen::Matrix2d::Identity()) return slopes;
  double lift = 1.0;
  if (heights == WarpHeights::Grow) {
    lift = 1.0 / std::sqrt(std::max(std::abs(determinant(jacobian)), least_determinant));
  }
  const double x = slopes.x();
  const double y = slopes.y();
  return {static_cast<float>(lift * (jacobian(0, 0) * x - jacobian(1, 0) * y)),
          static_cast<float>(lift * (jacobian(1, 1) * y - jacobian(0, 1) * x))};
}

/// body(x, y, point) for all pixels of the region, in parallel.
template <class Body>
void for_each_point(const WarpMap& map, const Rect& region, const Body& body) {
  parallel_for(static_cast<std::size_t>(region.height()), 8, [&](std::size_t a, std::size_t b) {
    std::array<WarpPoint, run_pixels> run;
    for (int y = region.y0 + static_cast<int>(a); y < region.y0 + static_cast<int>(b); ++y) {
      for (int x = region.x0; x < region.x1; x += run_pixels) {
        const int count = std::min(run_pixels, region.x1 - x);
        map(x, y, std::span(run).first(static_cast<std::size_t>(count)));
        for (int i = 0; i < count; ++i) body(x + i, y, run[static_cast<std::size_t>(i)]);
      }
    }
  });
}

Rect target_rect(const RgbnSpan& target) {
  return target.slopes.empty() ? target.color.rect() : target.slopes.rect();
}

}  // namespace

Rect warp(const RgbnView& source, const RgbnSpan& target, Rect region, const WarpMap& map,
          const WarpOptions& options) {
  const bool slopes = !target.slopes.empty();
  const bool color = !target.color.empty();
  if (slopes && source.slopes.empty()) throw InvalidInput("warp: the source has no slopes");
  if (color && source.color.empty()) throw InvalidInput("warp: the source has no colour");
  assert(!slopes || !color || target.slopes.rect() == target.color.rect());
  assert(source.slopes.empty() || source.color.empty() ||
         source.slopes.rect() == source.color.rect());
  region = intersect(region, target_rect(target));
  if (region.empty()) return {};
  const Sampler<Vec2f> sample_slopes(source.slopes, source.validity, options);
  const Sampler<Vec3f> sample_color(source.color, source.validity, options);
  for_each_point(map, region, [&](int x, int y, const WarpPoint& point) {
    if (slopes) {
      target.slopes(x, y) = turn(sample_slopes(point), point.jacobian, options.heights);
    }
    if (color) target.color(x, y) = sample_color(point);
  });
  return region;
}

Rect warp(MaskView source, MaskSpan target, Rect region, const WarpMap& map,
          const WarpOptions& options) {
  region = intersect(region, target.rect());
  if (region.empty()) return {};
  if (source.empty()) throw InvalidInput("warp: the source is empty");
  const Sampler<float> sample(source, {}, options);
  for_each_point(map, region,
                 [&](int x, int y, const WarpPoint& point) { target(x, y) = sample(point); });
  return region;
}

int reach(const WarpMap& map, Rect region) {
  if (region.empty()) return 0;
  std::vector<double> farthest(static_cast<std::size_t>(region.height()), 0.0);
  for_each_point(map, region, [&](int x, int y, const WarpPoint& point) {
    const Vec2d pixel(x, y);
    const Vec2d footprint = 0.5 * point.jacobian.cwiseAbs().rowwise().sum();
    double& row = farthest[static_cast<std::size_t>(y - region.y0)];
    row = std::max(row, ((point.position - pixel).cwiseAbs() + footprint).maxCoeff());
  });
  const double all = *std::max_element(farthest.begin(), farthest.end());
  return static_cast<int>(std::ceil(std::min(all, 1e9))) + 2;
}

}  // namespace normalshop
