#include "normalshop/rgbn/bilateral.h"

#include <cmath>
#include <vector>

#include "normalshop/core/parallel.h"
#include "normalshop/core/slope.h"
#include "normalshop/rgbn/detail/bilateral_input.h"
#include "normalshop/rgbn/detail/bilateral_kernels.h"

namespace normalshop {

namespace {

/// Computed as one task.
constexpr int tile_width = 128;
constexpr int tile_height = 64;
/// Below it differences of normals drown in rounding.
constexpr float least_sigma_normal = 0.005F;
/// A coordinate that nothing outweighs, finite so that differences are numbers.
constexpr float farthest = 1e15F;

/// Colours are averaged as they are compared where that loses nothing: scaled by at most this they
/// may be up to 1e9.
constexpr double most_shared_scale = 1e6;

/// 1 / 2 sigma^2 in the kernel's measure; 0: ignored.
double falloff(float sigma) {
  if (sigma == 0.0F) return 0.0;
  const double square = static_cast<double>(sigma) * static_cast<double>(sigma);
  return std::min(0.5 * bilateral_scale / bilateral_power / square, 1e30);
}

/// All but the centre.
std::vector<BilateralTap> disk_taps(const BilateralOptions& options,
                                    const BilateralLayout& layout) {
  const int radius = kernel_radius(options);
  const double square = 2.0 * static_cast<double>(options.sigma_space * options.sigma_space);
  std::vector<BilateralTap> taps;
  for (int dy = -radius; dy <= radius; ++dy) {
    for (int dx = -radius; dx <= radius; ++dx) {
      const int distance = dx * dx + dy * dy;
      if (distance == 0 || distance > radius * radius) continue;
      const double nearness = std::exp(-distance / square / bilateral_power);
      taps.push_back({dy * layout.planes() * layout.pitch + dx,
                      static_cast<float>(nearness - static_cast<double>(layout.normal_factor))});
    }
  }
  return taps;
}

/// The filter of one region, tile by tile: the pixels of a tile and around it are made ready once.
class Tiles {
 public:
  Tiles(const BilateralInput& input, const RgbnView& source, const RgbnSpan& target,
        const Rect& region, const BilateralOptions& options)
      : input_(input),
        source_(source),
        target_(target),
        region_(region),
        radius_(kernel_radius(options)),
        color_scale_(input.guide().color.empty() ? 0.0 : std::sqrt(falloff(options.sigma_color))) {
    layout_.guides = color_scale_ > 0.0 ? 6 : 3;
    layout_.values = target.color.empty() ? 2 : 5;
    layout_.averages_guide = layout_.guides == 6 && layout_.values == 5 &&
                             input.separate_guide.slopes.empty() &&
                             color_scale_ <= most_shared_scale;
    layout_.weighted = !input.source.validity.empty() || !input.guide().validity.empty();
    // |n_i - n_j|^2 = 2 (1 - <n_i, n_j>)
    layout_.normal_factor =
        static_cast<float>(2.0 * falloff(options.sigma_normal > 0.0F
                                             ? std::max(options.sigma_normal, least_sigma_normal)
                                             : 0.0F));
    layout_.pitch = tile_width + 2 * radius_;
    taps_ = disk_taps(options, layout_);
  }

  int count() const { return across() * ((region_.height() + tile_height - 1) / tile_height); }

  void run(int tile, Image<float>& pixels, Image<float>& means) const {
    const int x0 = region_.x0 + tile % across() * tile_width;
    const int y0 = region_.y0 + tile / across() * tile_height;
    const Rect all = intersect({x0, y0, x0 + tile_width, y0 + tile_height}, region_);
    const int planes = layout_.planes();
    const auto pitch = static_cast<int>(layout_.pitch);
    pixels.resize(pitch, (all.height() + 2 * radius_) * planes);
    means.resize(tile_width, layout_.values);
    for (int y = 0; y < all.height() + 2 * radius_; ++y) {
      float* row = pixels.row(y * planes);
      std::fill_n(row, planes * pitch, 0.0F);
      load_row(input_x(all.x0) - radius_, input_y(all.y0) - radius_ + y, all.width() + 2 * radius_,
               row);
    }
    const int width = (all.width() + bilateral_lanes - 1) / bilateral_lanes * bilateral_lanes;
    for (int y = 0; y < all.height(); ++y) {
      bilateral_row(pixels.row((y + radius_) * planes) + radius_, layout_, taps_, width,
                    means.data(), tile_width);
      store_row(all.x0, all.x1, all.y0 + y, means);
    }
  }

 private:
  int across() const { return (region_.width() + tile_width - 1) / tile_width; }
  int input_x(int x) const { return x - region_.x0 + input_.region.x0; }
  int input_y(int y) const { return y - region_.y0 + input_.region.y0; }

  void load_row(int x0, int y, int count, float* row) const {
    const RgbnWindow& guide = input_.guide();
    const auto scale = static_cast<float>(color_scale_);
    for (int i = 0; i < count; ++i) {
      const int x = x0 + i;
      float* out = row + i;
      const auto put = [&](float value) {
        *out = value;
        out += layout_.pitch;
      };
      for (const float n : normal_from_slope(guide.slopes(x, y))) put(n);
      if (layout_.guides == 6) {
        for (const float c : guide.color(x, y)) {
          put(std::clamp(c * scale, -farthest, farthest));
        }
      }
      for (const float s : limit_slope(input_.source.slopes(x, y))) put(s);
      if (layout_.values == 5 && !layout_.averages_guide) {
        for (const float c : input_.source.color(x, y)) put(c);
      }
      if (layout_.weighted) put(input_.weight(x, y));
    }
  }

  void store_row(int x0, int x1, int y, const Image<float>& means) const {
    const auto scale = static_cast<float>(layout_.averages_guide ? 1.0 / color_scale_ : 1.0);
    for (int x = x0; x < x1; ++x) {
      const int u = input_x(x);
      const int v = input_y(y);
      if (!(input_.weight(u, v) > 0.0F)) continue;
      const int i = x - x0;
      const Vec2f slope = limit_slope(input_.source.slopes(u, v)) + Vec2f(means(i, 0), means(i, 1));
      Vec3f color = Vec3f::Zero();
      if (layout_.values == 5) {
        color = input_.source.color(u, v) + scale * Vec3f(means(i, 2), means(i, 3), means(i, 4));
      }
      write_filtered(source_, target_, x, y, slope, color);
    }
  }

  const BilateralInput& input_;
  const RgbnView& source_;
  const RgbnSpan& target_;
  Rect region_;
  int radius_;
  double color_scale_;
  BilateralLayout layout_{};
  std::vector<BilateralTap> taps_;
};

}  // namespace

Rect bilateral(const RgbnView& source, const RgbnView& guide, const RgbnSpan& target, Rect region,
               const BilateralOptions& options) {
  check(options);
  region = intersect(region, rect_of(target));
  if (region.empty()) return {};
  if (kernel_radius(options) == 0) {
    copy_region(source, target, region);
    return region;
  }
  const BilateralInput input = bilateral_input(source, guide, region, options);
  if (!input.source.validity.empty() || !input.guide().validity.empty()) {
    copy_region(source, target, region);
  }
  const Tiles tiles(input, source, target, region, options);
  parallel_for(static_cast<std::size_t>(tiles.count()), 1, [&](std::size_t a, std::size_t b) {
    Image<float> pixels;
    Image<float> means;
    for (std::size_t i = a; i < b; ++i) tiles.run(static_cast<int>(i), pixels, means);
  });
  return region;
}

Rect bilateral(const RgbnView& source, const RgbnSpan& target, Rect region,
               const BilateralOptions& options) {
  return bilateral(source, {}, target, region, options);
}

}  // namespace normalshop
