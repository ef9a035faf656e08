#include "normalshop/rgbn/domain_transform.h"

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "normalshop/core/error.h"
#include "normalshop/core/parallel.h"
#include "normalshop/core/slope.h"
#include "normalshop/rgbn/detail/rgbn_window.h"
#include "normalshop/rgbn/smooth.h"

namespace normalshop {

namespace {

/// Rows filtered side by side, so that their chains of additions overlap.
constexpr int row_group = 4;
/// Columns filtered side by side: a line of the cache.
constexpr int column_group = 16;
/// exp(-x) is taken as (1 - x / range_power)^range_power: products that vectorise and give the same
/// bits on every machine.
constexpr int range_power = 64;
/// Less than this weight of valid pixels counts as none.
constexpr float least_weight = 1e-6F;

void check(const DomainTransformOptions& options) {
  const auto number = [](float value, const char* name) {
    if (value >= 0.0F && value <= 1e6F) return;
    throw InvalidInput("domain_transform: " + std::string(name) +
                       " must be a number from 0 to 1000000");
  };
  number(options.sigma_space, "sigma_space");
  number(options.sigma_color, "sigma_color");
  number(options.sigma_normal, "sigma_normal");
  number(options.guide_sigma, "guide_sigma");
  if (options.iterations < 1 || options.iterations > 10) {
    throw InvalidInput("domain_transform: iterations must be from 1 to 10");
  }
  if (options.rolls < 0 || options.rolls > 10) {
    throw InvalidInput("domain_transform: rolls must be from 0 to 10");
  }
}

/// Room for a plane, filled up with 0 to whole groups of columns. Its rows lie a bit further apart:
/// in a plane whose rows are a power of two apart the pixels of a column would share few lines of
/// the cache.
Image<float> make_plane(int width, int height) {
  Image<float> plane((width + column_group - 1) / column_group * column_group + 16, height);
  for (int y = 0; y < height; ++y)
    std::fill(plane.row(y) + width, plane.row(y) + plane.width(), 0.0F);
  return plane;
}

/// What is compared, plane by plane along one row: normals, then colours.
class GuideRow {
 public:
  GuideRow(int width, bool color) : planes_(width, color ? 6 : 3) {}

  void load(const RgbnView& guide, int y) {
    const Vec2f* slopes = guide.slopes.row(y);
    float* nx = planes_.row(0);
    float* ny = planes_.row(1);
    float* nz = planes_.row(2);
    for (int x = 0; x < planes_.width(); ++x) {
      const Vec3f n = normal_from_slope(slopes[x]);
      nx[x] = n.x();
      ny[x] = n.y();
      nz[x] = n.z();
    }
    if (planes_.height() == 3) return;
    const Vec3f* colors = guide.color.row(y);
    for (int x = 0; x < planes_.width(); ++x) {
      for (int c = 0; c < 3; ++c) planes_(x, 3 + c) = colors[x](c);
    }
  }
  /// First of three planes, from pixel x on.
  const float* normals(int x) const { return planes_.row(0) + x; }
  const float* colors(int x) const { return planes_.height() == 3 ? nullptr : planes_.row(3) + x; }
  int pitch() const { return planes_.width(); }

 private:
  Image<float> planes_;
};

/// distance[i] += scale |a_i - b_i| for three planes.
void add_distances(const float* a, const float* b, std::ptrdiff_t pitch, float scale, int count,
                   float* distance) {
  for (int i = 0; i < count; ++i) {
    const float x = a[i] - b[i];
    const float y = a[i + pitch] - b[i + pitch];
    const float z = a[i + 2 * pitch] - b[i + 2 * pitch];
    distance[i] += scale * std::sqrt(x * x + y * y + z * z);
  }
}

/// distance[i] = flat exp(-distance[i]), nearly.
void weights_of_distances(float* distance, float flat, int count) {
  for (int i = 0; i < count; ++i) {
    const float base = 1.0F - distance[i] * (1.0F / range_power);
    float power = base > 0.0F ? base : 0.0F;
    for (int n = 1; n < range_power; n *= 2) power *= power;
    distance[i] = flat * power;
  }
}

/// How much of a pixel's left (across) and upper (down) neighbour goes on in it.
struct Weights {
  Image<float> across;
  Image<float> down;
};

class WeightRule {
 public:
  WeightRule(const DomainTransformOptions& options, int iterations) {
    const auto sigma = static_cast<double>(options.sigma_space);
    // All distances are multiples of a pixel's in the first iteration.
    const double per_pixel = distance_of_pixels(sigma, iterations);
    flat_ = static_cast<float>(std::exp(-per_pixel));
    normal_scale_ = scale(per_pixel * sigma, options.sigma_normal);
    color_scale_ = scale(per_pixel * sigma, options.sigma_color);
  }

  void between(const GuideRow& a, int xa, const GuideRow& b, int xb, int count, float* out) const {
    std::fill_n(out, count, 0.0F);
    const int pitch = a.pitch();
    add_distances(a.normals(xa), b.normals(xb), pitch, normal_scale_, count, out);
    if (a.colors(0) != nullptr) {
      add_distances(a.colors(xa), b.colors(xb), pitch, color_scale_, count, out);
    }
    weights_of_distances(out, flat_, count);
  }

 private:
  /// The distance u between pixels, in widths of the first iteration, at which the whole filter's
  /// standard deviation is sigma. Forth and back with the weight exp(-u) has the variance
  /// 1 / (2 sinh^2(u / 2)), and each iteration doubles u.
  static double distance_of_pixels(double sigma, int iterations) {
    double near = 1e-9;
    double far = 200.0;
    for (int halving = 0; halving < 100; ++halving) {
      const double u = std::sqrt(near * far);
      double variance = 0.0;
      for (int i = 0; i < iterations; ++i) {
        variance += 0.5 / std::pow(std::sinh(0.5 * std::min(std::exp2(i) * u, 600.0)), 2.0);
      }
      (variance > sigma * sigma ? near : far) = u;
    }
    return std::sqrt(near * far);
  }
  static float scale(double space, float range) {
    if (range == 0.0F) return 0.0F;
    return static_cast<float>(std::min(space / static_cast<double>(range), 1e15));
  }
  float flat_;
  float normal_scale_;
  float color_scale_;
};

/// Nothing passes from or to a pixel that doesn't count.
void block(MaskView validity, int y, Weights& weights) {
  for (int x = 0; x < validity.width(); ++x) {
    const bool counts = validity(x, y) > 0.0F;
    if (!counts || (x > 0 && !(validity(x - 1, y) > 0.0F))) weights.across(x, y) = 0.0F;
    if (!counts || (y > 0 && !(validity(x, y - 1) > 0.0F))) weights.down(x, y) = 0.0F;
  }
}

Weights make_weights(const RgbnView& guide, MaskView validity,
                     const DomainTransformOptions& options, int iterations) {
  const WeightRule rule(options, iterations);
  const int width = guide.slopes.width();
  const bool color = options.sigma_color > 0.0F && !guide.color.empty();
  const int height = guide.slopes.height();
  Weights weights{make_plane(width, height), make_plane(width, height)};
  parallel_for(static_cast<std::size_t>(height), 16, [&](std::size_t a, std::size_t b) {
    GuideRow above(width, color);
    GuideRow here(width, color);
    here.load(guide, static_cast<int>(a > 0 ? a - 1 : 0));
    for (int y = static_cast<int>(a); y < static_cast<int>(b); ++y) {
      std::swap(above, here);
      here.load(guide, y);
      weights.across(0, y) = 0.0F;
      rule.between(here, 0, here, 1, width - 1, weights.across.row(y) + 1);
      rule.between(above, 0, here, 0, width, weights.down.row(y));
      if (!validity.empty()) block(validity, y, weights);
    }
  });
  return weights;
}

/// Filters N rows forth and back.
template <int N>
void filter_rows(Image<float>& plane, const Image<float>& weights, int width, int y) {
  std::array<float*, N> rows;
  std::array<const float*, N> factors;
  std::array<float, N> state;
  for (int r = 0; r < N; ++r) {
    const auto i = static_cast<std::size_t>(r);
    rows[i] = plane.row(y + r);
    factors[i] = weights.row(y + r);
    state[i] = rows[i][0];
  }
  for (int x = 1; x < width; ++x) {
    for (std::size_t i = 0; i < N; ++i) {
      const float own = rows[i][x];
      state[i] = own + factors[i][x] * (state[i] - own);
      rows[i][x] = state[i];
    }
  }
  for (int x = width - 2; x >= 0; --x) {
    for (std::size_t i = 0; i < N; ++i) {
      const float own = rows[i][x];
      state[i] = own + factors[i][x + 1] * (state[i] - own);
      rows[i][x] = state[i];
    }
  }
}

/// Half the width along the same distances.
void square(float* weights, int count) {
  for (int x = 0; x < count; ++x) weights[x] *= weights[x];
}

/// One pass along all rows; `half`: with half the width of the last one.
void filter_across(std::vector<Image<float>>& planes, Image<float>& weights, int width, bool half) {
  const int height = weights.height();
  const auto groups = static_cast<std::size_t>((height + row_group - 1) / row_group);
  parallel_for(groups, 1, [&](std::size_t a, std::size_t b) {
    for (int y = static_cast<int>(a) * row_group; y < static_cast<int>(b) * row_group;
         y += row_group) {
      for (int r = y; half && r < std::min(y + row_group, height); ++r) {
        square(weights.row(r), width);
      }
      for (Image<float>& plane : planes) {
        if (y + row_group <= height) {
          filter_rows<row_group>(plane, weights, width, y);
        } else {
          for (int last = y; last < height; ++last) filter_rows<1>(plane, weights, width, last);
        }
      }
    }
  });
}

/// Filters a group of columns down and up.
void filter_columns(Image<float>& plane, const Image<float>& weights, int x0) {
  std::array<float, column_group> state;
  std::copy_n(plane.row(0) + x0, column_group, state.data());
  const auto step = [&](int y, int weight_y) {
    float* own = plane.row(y) + x0;
    const float* weight = weights.row(weight_y) + x0;
    for (std::size_t x = 0; x < column_group; ++x) {
      state[x] = own[x] + weight[x] * (state[x] - own[x]);
    }
    std::copy_n(state.data(), column_group, own);
  };
  for (int y = 1; y < plane.height(); ++y) step(y, y);
  for (int y = plane.height() - 2; y >= 0; --y) step(y, y + 1);
}

void filter_down(std::vector<Image<float>>& planes, Image<float>& weights, int width, bool half) {
  const auto groups = static_cast<std::size_t>((width + column_group - 1) / column_group);
  parallel_for(groups, 4, [&](std::size_t a, std::size_t b) {
    for (int group = static_cast<int>(a); group < static_cast<int>(b); ++group) {
      const int x0 = group * column_group;
      for (int y = 0; half && y < weights.height(); ++y) square(weights.row(y) + x0, column_group);
      for (Image<float>& plane : planes) filter_columns(plane, weights, x0);
    }
  });
}

/// Slopes, colours where they are wanted, and the validity where not all pixels count 1; the former
/// times the latter.
std::vector<Image<float>> make_planes(const RgbnView& window, bool color) {
  const int width = window.slopes.width();
  const int height = window.slopes.height();
  const bool weighted = !window.validity.empty();
  std::vector<Image<float>> planes;
  for (int i = 0; i < (color ? 5 : 2) + (weighted ? 1 : 0); ++i) {
    planes.push_back(make_plane(width, height));
  }
  parallel_for(static_cast<std::size_t>(height), 16, [&](std::size_t a, std::size_t b) {
    for (int y = static_cast<int>(a); y < static_cast<int>(b); ++y) {
      for (int x = 0; x < width; ++x) {
        const float weight = weighted ? window.validity(x, y) : 1.0F;
        const Vec2f slope = weight * limit_slope(window.slopes(x, y));
        planes[0](x, y) = slope.x();
        planes[1](x, y) = slope.y();
        for (std::size_t c = 0; color && c < 3; ++c) {
          planes[2 + c](x, y) = weight * window.color(x, y)[static_cast<int>(c)];
        }
        if (weighted) planes.back()(x, y) = weight;
      }
    }
  });
  return planes;
}

/// Where the filter works: the region with its reach, and beyond the image only where the image
/// goes on otherwise than by its last pixel.
Rect held_around(const Rect& region, const Rect& image, const DomainTransformOptions& options) {
  const Rect wanted = grow(region, reach(options));
  if (options.border == Border::Clamp) return intersect(wanted, image);
  return intersect(wanted, {-image.x1, -image.y1, 2 * image.x1, 2 * image.y1});
}

RgbnWindow empty_window(const Rect& size, bool color) {
  RgbnWindow window;
  window.slopes.resize(size.width(), size.height());
  window.slopes.fill(Vec2f::Zero());
  if (color) {
    window.color.resize(size.width(), size.height());
    window.color.fill(Vec3f::Zero());
  }
  return window;
}

RgbnWindow blurred(const RgbnView& window, float sigma) {
  RgbnWindow guide;
  const Rect all = window.slopes.rect();
  guide.slopes.resize(all.width(), all.height());
  smooth(window.slopes, window.validity, guide.slopes, all, {.sigma = sigma});
  if (!window.color.empty()) {
    guide.color.resize(all.width(), all.height());
    smooth(window.color, window.validity, guide.color, all, {.sigma = sigma});
  }
  return guide;
}

void store(const std::vector<Image<float>>& planes, const Rect& held, MaskView validity,
           const RgbnView& source, const RgbnSpan& target, const Rect& region) {
  const bool weighted = !validity.empty();
  parallel_for(static_cast<std::size_t>(region.height()), 16, [&](std::size_t a, std::size_t b) {
    for (int y = region.y0 + static_cast<int>(a); y < region.y0 + static_cast<int>(b); ++y) {
      const int v = y - held.y0;
      for (int x = region.x0; x < region.x1; ++x) {
        const int u = x - held.x0;
        float inverse = 1.0F;
        if (weighted) {
          const float sum = planes.back()(u, v);
          if (!(validity(u, v) > 0.0F) || !(sum > least_weight)) continue;
          inverse = 1.0F / sum;
        }
        Vec3f color = Vec3f::Zero();
        if (!target.color.empty()) {
          color = inverse * Vec3f(planes[2](u, v), planes[3](u, v), planes[4](u, v));
        }
        write_filtered(source, target, x, y, inverse * Vec2f(planes[0](u, v), planes[1](u, v)),
                       color);
      }
    }
  });
}

template <class T>
ImageView<T> part(ImageView<T> image, const Rect& where) {
  if (image.empty()) return {};
  const std::ptrdiff_t stride = image.height() > 1 ? image.row(1) - image.row(0) : image.width();
  return {image.row(where.y0) + where.x0, where.width(), where.height(), stride};
}

/// A part of an image whose pixels all count.
RgbnView part(const RgbnView& image, const Rect& where) {
  return {part(image.slopes, where), part(image.color, where), {}};
}

/// The planes of `window` filtered along the guide's distances.
std::vector<Image<float>> filtered(const RgbnView& window, const RgbnView& guide, bool color,
                                   const DomainTransformOptions& options, int iterations) {
  Weights weights = make_weights(guide, window.validity, options, iterations);
  std::vector<Image<float>> planes = make_planes(window, color);
  for (int i = 0; i < iterations; ++i) {
    filter_across(planes, weights.across, guide.slopes.width(), i > 0);
    filter_down(planes, weights.down, guide.slopes.width(), i > 0);
  }
  return planes;
}

/// Filters `window`, which shows the pixels `held`, and writes those of the region.
void filter(const RgbnView& window, const Rect& held, const RgbnView& source,
            const RgbnSpan& target, const Rect& region, const DomainTransformOptions& options) {
  const bool compares_color = options.sigma_color > 0.0F && !window.color.empty();
  RgbnWindow blur;
  RgbnView guide = window;
  if (options.guide_sigma > 0.0F) {
    blur = blurred(window, options.guide_sigma);
    guide = blur.view();
  }
  for (int i = 0; i < options.rolls; ++i) {
    const auto planes = filtered(window, guide, compares_color, options, 1);
    RgbnWindow next = empty_window(window.slopes.rect(), compares_color);
    const Rect all = window.slopes.rect();
    store(planes, all, window.validity, window, {next.slopes, next.color}, all);
    blur = std::move(next);
    guide = blur.view();
  }
  store(filtered(window, guide, !target.color.empty(), options, options.iterations), held,
        window.validity, source, target, region);
}

}  // namespace

Rect domain_transform(const RgbnView& source, const RgbnSpan& target, Rect region,
                      const DomainTransformOptions& options) {
  check(options);
  region = intersect(region, rect_of(target));
  if (region.empty()) return {};
  if (options.sigma_space == 0.0F) {
    copy_region(source, target, region);
    return region;
  }
  const Rect held = held_around(region, source.slopes.rect(), options);
  if (held == intersect(held, source.slopes.rect()) && all_count(source, held)) {
    filter(part(source, held), held, source, target, region, options);
  } else {
    const RgbnWindow window = gather_window(source, held, options.border);
    if (!window.validity.empty()) copy_region(source, target, region);
    filter(window.view(), held, source, target, region, options);
  }
  return region;
}

int reach(const DomainTransformOptions& options) {
  // A guide's error at its border reaches the region only through what falls off on the way.
  const double sigmas = 6.0 + options.rolls;
  const double pixels = std::min(sigmas * static_cast<double>(options.sigma_space), 1e8);
  return static_cast<int>(std::ceil(pixels)) + reach(SmoothOptions{.sigma = options.guide_sigma});
}

}  // namespace normalshop
