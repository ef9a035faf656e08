#include "normalshop/rgbn/detail/domain_weights.h"

#include <algorithm>
#include <cmath>

#include "normalshop/core/parallel.h"
#include "normalshop/core/slope.h"
#include "normalshop/rgbn/detail/domain_kernels.h"

namespace normalshop {

namespace {

/// exp(-x) is taken as (1 - x / range_power)^range_power: products that vectorise and give the same
/// bits on every machine.
constexpr int range_power = 64;

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
void block(MaskView validity, int y, DomainWeights& weights) {
  for (int x = 0; x < validity.width(); ++x) {
    const bool counts = validity(x, y) > 0.0F;
    if (!counts || (x > 0 && !(validity(x - 1, y) > 0.0F))) weights.across(x, y) = 0.0F;
    if (!counts || (y > 0 && !(validity(x, y - 1) > 0.0F))) weights.down(x, y) = 0.0F;
  }
}

}  // namespace

void shape_plane(Image<float>& plane, int width, int height) {
  plane.resize((width + domain_lanes - 1) / domain_lanes * domain_lanes + 16, height);
  for (int y = 0; y < height; ++y) {
    std::fill(plane.row(y) + width, plane.row(y) + plane.width(), 0.0F);
  }
}

void set_weights(const RgbnView& guide, MaskView validity, const DomainTransformOptions& options,
                 int iterations, DomainWeights& weights) {
  const WeightRule rule(options, iterations);
  const int width = guide.slopes.width();
  const bool color = options.sigma_color > 0.0F && !guide.color.empty();
  const int height = guide.slopes.height();
  shape_plane(weights.across, width, height);
  shape_plane(weights.down, width, height);
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
}

}  // namespace normalshop
