#include "normalshop/rgbn/stamp.h"

#include <algorithm>
#include <cmath>

#include "normalshop/core/error.h"
#include "normalshop/core/parallel.h"
#include "normalshop/core/sample.h"

namespace normalshop {

namespace {

void check(const Patch& patch, const StampOptions& o) {
  if (patch.slopes.empty()) throw InvalidInput("stamp: the patch is empty");
  const auto fits = [&](const Rect& r) { return r.empty() || r == patch.slopes.rect(); };
  if (!fits(patch.opacity.rect()) || !fits(patch.color.rect())) {
    throw InvalidInput("stamp: the patch's slopes, opacity and colour must have one size");
  }
  if (!std::isfinite(o.size) || !std::isfinite(o.relief) || !std::isfinite(o.border) ||
      o.size < 0.0F || o.border < 0.0F) {
    throw InvalidInput(
        "stamp: size, relief and border must be numbers, size and border at least 0");
  }
}

enum class Copies { One, Endless };

/// Maps pixels of the chart to pixels of the patch, and gradients back.
struct Mapping {
  Vec2f center;        ///< in the chart
  Vec2f patch_center;  ///< in the patch
  Mat2f to_patch;      ///< y down on both sides
  Mat2f gradient;      ///< y up on both sides
  Rect bounds;
  int grid_x = 1;  ///< positions averaged in a pixel of the chart
  int grid_y = 1;

  Vec2f patch_position(float x, float y) const {
    const float dx = x - center.x();
    const float dy = y - center.y();
    return {to_patch(0, 0) * dx + to_patch(0, 1) * dy + patch_center.x(),
            to_patch(1, 0) * dx + to_patch(1, 1) * dy + patch_center.y()};
  }
};

Mat2f inverse(const Mat2f& m) {
  const float det = m(0, 0) * m(1, 1) - m(0, 1) * m(1, 0);
  Mat2f out;
  out << m(1, 1) / det, -m(0, 1) / det, -m(1, 0) / det, m(0, 0) / det;
  return out;
}

Vec2f half_extent(const Patch& patch, const Mat2f& to_chart) {
  const Vec2f half(0.5F * static_cast<float>(patch.slopes.width()),
                   0.5F * static_cast<float>(patch.slopes.height()));
  return to_chart.cwiseAbs() * half;
}

float size_scale(const Patch& patch, const StampOptions& o) {
  return o.size > 0.0F ? o.size / static_cast<float>(patch.slopes.width()) : 1.0F;
}

/// One copy is small when its pixels are, many are not.
int positions(float step, Copies copies) {
  const float most = copies == Copies::One ? 1024.0F : 16.0F;
  return step > 1.001F ? static_cast<int>(std::ceil(std::min(step, most))) : 1;
}

Rect bounds_of(const Vec2f& center, const Vec2f& half) {
  const Vec2f low = (center - half).cwiseMax(-1e8F);
  const Vec2f high = (center + half).cwiseMin(1e8F);
  return {static_cast<int>(std::floor(std::min(low.x(), 1e8F))),
          static_cast<int>(std::floor(std::min(low.y(), 1e8F))),
          static_cast<int>(std::ceil(std::max(high.x(), -1e8F))) + 1,
          static_cast<int>(std::ceil(std::max(high.y(), -1e8F))) + 1};
}

Mapping make_mapping(const Patch& patch, const Vec2f& center, const StampOptions& o,
                     Copies copies) {
  check(patch, o);
  if (!center.allFinite()) throw InvalidInput("stamp: the centre must be numbers");
  const Mat2f placed = placement_matrix(o);
  const Mat2f placed_inverse = inverse(placed);
  const float scale = size_scale(patch, o);
  const float det = std::abs(placed(0, 0) * placed(1, 1) - placed(0, 1) * placed(1, 0));
  const float lift = o.heights == StampHeights::Grow ? std::sqrt(det) : 1.0F;
  Mapping m;
  m.center = center;
  m.patch_center = {0.5F * static_cast<float>(patch.slopes.width() - 1),
                    0.5F * static_cast<float>(patch.slopes.height() - 1)};
  m.gradient = o.relief * lift * placed_inverse.transpose();
  // The flip of y on both sides negates what mixes x and y.
  m.to_patch = placed_inverse / scale;
  m.to_patch(0, 1) = -m.to_patch(0, 1);
  m.to_patch(1, 0) = -m.to_patch(1, 0);
  const bool endless = copies == Copies::Endless;
  m.bounds = bounds_of(center, endless ? Vec2f(1e8F, 1e8F) : half_extent(patch, scale * placed));
  m.grid_x = positions(m.to_patch.col(0).norm(), copies);
  m.grid_y = positions(m.to_patch.col(1).norm(), copies);
  return m;
}

/// 1 inside, falling to 0 over `border` of the smaller side at the patch's edge.
float border_weight(const Patch& patch, const Vec2f& p, float border) {
  const auto width = static_cast<float>(patch.slopes.width());
  const auto height = static_cast<float>(patch.slopes.height());
  const float x = std::min(p.x() + 0.5F, width - 0.5F - p.x());
  const float y = std::min(p.y() + 0.5F, height - 0.5F - p.y());
  if (!(x >= 0.0F && y >= 0.0F)) return 0.0F;
  const float fade = border * std::min(width, height);
  return fade > 0.0F ? smoothstep(0.0F, fade, x) * smoothstep(0.0F, fade, y) : 1.0F;
}

template <class T>
struct Pixel {
  T weighted = zero<T>();
  float weight = 0.0F;
};

/// Mean of opacity * value and of opacity over the pixel.
template <class T, Border outside>
Pixel<T> sample(const Patch& patch, ImageView<T> values, const Mapping& m, float border, int x,
                int y) {
  Pixel<T> sum;
  const bool shrinks = m.grid_x * m.grid_y > 1;
  for (int j = 0; j < m.grid_y; ++j) {
    for (int i = 0; i < m.grid_x; ++i) {
      const float dx = (static_cast<float>(i) + 0.5F) / static_cast<float>(m.grid_x) - 0.5F;
      const float dy = (static_cast<float>(j) + 0.5F) / static_cast<float>(m.grid_y) - 0.5F;
      const Vec2f p = m.patch_position(static_cast<float>(x) + dx, static_cast<float>(y) + dy);
      float weight = outside == Border::Wrap ? 1.0F : border_weight(patch, p, border);
      if (weight <= 0.0F) continue;
      if (!patch.opacity.empty()) {
        weight *= sample_bilinear<float, outside>(patch.opacity, p.x(), p.y());
      }
      const T value = shrinks ? sample_bilinear<T, outside>(values, p.x(), p.y())
                              : sample_bicubic<T, outside>(values, p.x(), p.y());
      sum.weighted += weight * value;
      sum.weight += weight;
    }
  }
  if (shrinks) {
    const float scale = 1.0F / static_cast<float>(m.grid_x * m.grid_y);
    sum.weighted *= scale;
    sum.weight *= scale;
  }
  return sum;
}

template <Border outside>
Rect lay(SlopeSpan details, MaskSpan coverage, Rect region, const Patch& patch, const Mapping& m,
         float border) {
  region = intersect(region, details.rect());
  if (region.empty()) return {};
  parallel_for(static_cast<std::size_t>(region.height()), 8, [&](std::size_t a, std::size_t b) {
    for (int y = region.y0 + static_cast<int>(a); y < region.y0 + static_cast<int>(b); ++y) {
      for (int x = region.x0; x < region.x1; ++x) {
        Pixel<Vec2f> pixel;
        if (m.bounds.contains(x, y)) {
          pixel = sample<Vec2f, outside>(patch, patch.slopes, m, border, x, y);
        }
        details(x, y) = m.gradient * pixel.weighted;
        if (!coverage.empty()) coverage(x, y) = pixel.weight;
      }
    }
  });
  return intersect(region, m.bounds);
}

}  // namespace

Rect stamp(SlopeSpan details, MaskSpan coverage, Rect region, const Patch& patch,
           const Vec2f& center, const StampOptions& options) {
  const Mapping m = make_mapping(patch, center, options, Copies::One);
  return lay<Border::Clamp>(details, coverage, region, patch, m, options.border);
}

Rect stamp_repeated(SlopeSpan details, MaskSpan coverage, Rect region, const Patch& patch,
                    const Vec2f& center, const StampOptions& options) {
  const Mapping m = make_mapping(patch, center, options, Copies::Endless);
  return lay<Border::Wrap>(details, coverage, region, patch, m, 0.0F);
}

Rect stamp_color(ColorSpan color, Rect region, const Patch& patch, const Vec2f& center,
                 const StampOptions& options) {
  const Mapping m = make_mapping(patch, center, options, Copies::One);
  if (patch.color.empty()) throw InvalidInput("stamp: the patch has no colour");
  region = intersect(intersect(region, color.rect()), m.bounds);
  if (region.empty()) return {};
  parallel_for(static_cast<std::size_t>(region.height()), 8, [&](std::size_t a, std::size_t b) {
    for (int y = region.y0 + static_cast<int>(a); y < region.y0 + static_cast<int>(b); ++y) {
      for (int x = region.x0; x < region.x1; ++x) {
        const auto pixel =
            sample<Vec3f, Border::Clamp>(patch, patch.color, m, options.border, x, y);
        color(x, y) = (1.0F - pixel.weight) * color(x, y) + pixel.weighted;
      }
    }
  });
  return region;
}

int reach(const StampOptions& options, const Patch& patch) {
  check(patch, options);
  const Vec2f half = half_extent(patch, size_scale(patch, options) * placement_matrix(options));
  return static_cast<int>(std::ceil(std::min(half.maxCoeff(), 1e6F))) + 1;
}

}  // namespace normalshop
