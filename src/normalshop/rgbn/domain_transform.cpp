#include "normalshop/rgbn/domain_transform.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "normalshop/core/error.h"
#include "normalshop/core/parallel.h"
#include "normalshop/rgbn/detail/domain_kernels.h"
#include "normalshop/rgbn/detail/domain_weights.h"
#include "normalshop/rgbn/detail/rgbn_window.h"
#include "normalshop/rgbn/smooth.h"

namespace normalshop {

namespace {

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

/// All planes, a few at a time.
template <class Body>
void for_planes(std::vector<Image<float>>& planes, const Body& body) {
  for (std::size_t first = 0; first < planes.size(); first += domain_planes) {
    body(std::span(planes).subspan(first,
                                   std::min(planes.size() - first, std::size_t{domain_planes})));
  }
}

/// One pass along all rows; they are transposed and filtered as columns.
void filter_across(std::vector<Image<float>>& planes, const Image<float>& weights, int width,
                   int squarings) {
  const int height = weights.height();
  const std::ptrdiff_t stride = weights.width();
  const int padded = (width + 3) / 4 * 4;
  const auto groups = static_cast<std::size_t>((height + domain_lanes - 1) / domain_lanes);
  parallel_for(groups, 1, [&](std::size_t a, std::size_t b) {
    Image<float> columns(domain_lanes * padded, 1 + domain_planes);
    for (int y = static_cast<int>(a) * domain_lanes; y < static_cast<int>(b) * domain_lanes;
         y += domain_lanes) {
      const int rows = std::min(domain_lanes, height - y);
      transpose_lanes(weights.row(y), stride, rows, padded, columns.row(domain_planes));
      for_planes(planes, [&](std::span<Image<float>> some) {
        std::array<float*, domain_planes> starts{};
        for (std::size_t p = 0; p < some.size(); ++p) {
          starts[p] = columns.row(static_cast<int>(p));
          transpose_lanes(some[p].row(y), stride, rows, padded, starts[p]);
        }
        filter_lanes(std::span(starts).first(some.size()), columns.row(domain_planes), domain_lanes,
                     width, squarings);
        for (std::size_t p = 0; p < some.size(); ++p) {
          transpose_back(starts[p], some[p].row(y), stride, rows, padded);
        }
      });
    }
  });
}

void filter_down(std::vector<Image<float>>& planes, const Image<float>& weights, int width,
                 int squarings) {
  const auto groups = static_cast<std::size_t>((width + domain_lanes - 1) / domain_lanes);
  parallel_for(groups, 4, [&](std::size_t a, std::size_t b) {
    for (int x = static_cast<int>(a) * domain_lanes; x < static_cast<int>(b) * domain_lanes;
         x += domain_lanes) {
      for_planes(planes, [&](std::span<Image<float>> some) {
        std::array<float*, domain_planes> starts{};
        for (std::size_t p = 0; p < some.size(); ++p) starts[p] = some[p].row(0) + x;
        filter_lanes(std::span(starts).first(some.size()), weights.row(0) + x, weights.width(),
                     weights.height(), squarings);
      });
    }
  });
}

/// Fills the planes: slopes, colours where they are wanted, and the validity where not all pixels
/// count 1; the former times the latter.
void set_planes(const RgbnView& window, bool color, std::vector<Image<float>>& planes) {
  const int width = window.slopes.width();
  const int height = window.slopes.height();
  const bool weighted = !window.validity.empty();
  planes.resize((color ? 5U : 2U) + (weighted ? 1U : 0U));
  for (Image<float>& plane : planes) shape_plane(plane, width, height);
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
}

/// Where the filter works: the region with its reach, and beyond the image only where the image
/// goes on otherwise than by its last pixel.
Rect held_around(const Rect& region, const Rect& image, const DomainTransformOptions& options) {
  const Rect wanted = grow(region, reach(options));
  if (options.border == Border::Clamp) return intersect(wanted, image);
  return intersect(wanted, {-image.x1, -image.y1, 2 * image.x1, 2 * image.y1});
}

/// The window blurred by guide_sigma; empty where that is 0.
RgbnWindow first_guide(const RgbnView& window, bool color, const DomainTransformOptions& options) {
  if (options.guide_sigma == 0.0F) return {};
  const SmoothOptions gaussian{.sigma = options.guide_sigma};
  const Rect all = window.slopes.rect();
  RgbnWindow guide = make_window(all, color);
  smooth(window.slopes, window.validity, guide.slopes, all, gaussian);
  if (color) smooth(window.color, window.validity, guide.color, all, gaussian);
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

/// The planes of a window and their weights, whose memory is used again.
struct Planes {
  std::vector<Image<float>> planes;
  DomainWeights weights;

  /// Filters `window` along the guide's distances.
  void filter(const RgbnView& window, const RgbnView& guide, bool color,
              const DomainTransformOptions& options, int iterations) {
    set_weights(guide, window.validity, options, iterations, weights);
    set_planes(window, color, planes);
    for (int i = 0; i < iterations; ++i) {
      filter_across(planes, weights.across, guide.slopes.width(), i);
      filter_down(planes, weights.down, guide.slopes.width(), i);
    }
  }
};

/// Filters `window`, which shows the pixels `held`, and writes those of the region.
void filter(const RgbnView& window, const Rect& held, const RgbnView& source,
            const RgbnSpan& target, const Rect& region, const DomainTransformOptions& options) {
  const bool compares_color = options.sigma_color > 0.0F && !window.color.empty();
  const Rect all = window.slopes.rect();
  RgbnWindow guide = first_guide(window, compares_color, options);
  RgbnView compared = guide.slopes.empty() ? window : guide.view();
  Planes work;
  for (int i = 0; i < options.rolls; ++i) {
    work.filter(window, compared, compares_color, options, 1);
    if (guide.slopes.empty()) {
      guide = make_window(all, compares_color);
      copy_region(window, {guide.slopes, guide.color}, all);  // pixels that don't count stay so
    }
    store(work.planes, all, window.validity, window, {guide.slopes, guide.color}, all);
    compared = guide.view();
  }
  work.filter(window, compared, !target.color.empty(), options, options.iterations);
  store(work.planes, held, window.validity, source, target, region);
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
