#include "normalshop/rgbn/curl.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "normalshop/core/error.h"
#include "normalshop/core/parallel.h"
#include "normalshop/rgbn/detail/grid_field.h"
#include "normalshop/rgbn/heatmap.h"
#include "normalshop/rgbn/project.h"

namespace normalshop {

namespace {

/// Derivatives in a square of four pixels.
struct Derivatives {
  double y_along_x = 0.0;  ///< d z_y / d x
  double x_along_y = 0.0;  ///< d z_x / d y (up)
  double curl() const { return y_along_x - x_along_y; }
};

/// The squares of an image.
class Squares {
 public:
  Squares(SlopeView slopes, MaskView validity, const CurlOptions& options)
      : slopes_(slopes), validity_(validity), wraps_(options.border == Border::Wrap) {
    assert(validity.empty() || validity.rect() == slopes.rect());
  }

  /// Not a number when a pixel does not count; 0 for squares that leave the image.
  Derivatives operator()(int x, int y) const {
    const bool inside = x + 1 < slopes_.width() && y + 1 < slopes_.height();
    if (!inside && !wraps_) return {};
    const int right = x + 1 < slopes_.width() ? x + 1 : 0;
    const int below = y + 1 < slopes_.height() ? y + 1 : 0;
    const Vec2d nw = slope(x, y);
    const Vec2d ne = slope(right, y);
    const Vec2d sw = slope(x, below);
    const Vec2d se = slope(right, below);
    return {0.5 * ((ne.y() + se.y()) - (nw.y() + sw.y())),
            0.5 * ((nw.x() + ne.x()) - (sw.x() + se.x()))};
  }

 private:
  Vec2d slope(int x, int y) const {
    const bool counts = validity_.empty() || validity_(x, y) > 0.0F;
    Vec2d s = slopes_(x, y).cast<double>();
    if (counts && std::isfinite(s.x()) && std::isfinite(s.y())) return s;
    return Vec2d::Constant(std::numeric_limits<double>::quiet_NaN());
  }

  SlopeView slopes_;
  MaskView validity_;
  bool wraps_;
};

/// Bilinear between pixel centres.
Vec2d slope_between(SlopeView slopes, const Vec2d& at, Border border) {
  const double fx = std::floor(at.x());
  const double fy = std::floor(at.y());
  const auto pixel = [&](int x, int y) -> Vec2d {
    const BorderPixel column = border_pixel(x, slopes.width(), border);
    const BorderPixel row = border_pixel(y, slopes.height(), border);
    const Vec2d slope = slopes(column.index, row.index).cast<double>();
    return {column.flipped ? -slope.x() : slope.x(), row.flipped ? -slope.y() : slope.y()};
  };
  const int x = static_cast<int>(fx);
  const int y = static_cast<int>(fy);
  const double u = at.x() - fx;
  const double v = at.y() - fy;
  // Weights of 0 are left out: a neighbour without direction does not matter then.
  const auto mix = [](double t, const Vec2d& a, const auto& b) -> Vec2d {
    return t > 0.0 ? Vec2d((1.0 - t) * a + t * b()) : a;
  };
  const auto line = [&](int row) {
    return mix(u, pixel(x, row), [&] { return pixel(x + 1, row); });
  };
  return mix(v, line(y), [&] { return line(y + 1); });
}

/// Where a piece crosses the rows and columns of pixel centres, as fractions of it.
void add_crossings(double from, double to, std::vector<double>& fractions) {
  const double low = std::min(from, to);
  const double high = std::max(from, to);
  for (double at = std::floor(low) + 1.0; at < high; at += 1.0) {
    fractions.push_back((at - from) / (to - from));
  }
}

/// Between crossings the bilinear slope along a piece is a polynomial of degree 2: Simpson's rule
/// is exact.
double gain(SlopeView slopes, const Vec2d& a, const Vec2d& b, Border border) {
  std::vector<double> fractions = {0.0, 1.0};
  add_crossings(a.x(), b.x(), fractions);
  add_crossings(a.y(), b.y(), fractions);
  std::sort(fractions.begin(), fractions.end());
  const Vec2d along(b.x() - a.x(), a.y() - b.y());  // y up
  const auto slope = [&](double t) {
    return slope_between(slopes, a + t * (b - a), border).dot(along);
  };
  double sum = 0.0;
  for (std::size_t i = 1; i < fractions.size(); ++i) {
    const double s = fractions[i - 1];
    const double e = fractions[i];
    if (e > s) sum += (e - s) / 6.0 * (slope(s) + 4.0 * slope(0.5 * (s + e)) + slope(e));
  }
  return sum;
}

}  // namespace

Rect curl(SlopeView slopes, MaskView validity, MaskSpan target, Rect region,
          const CurlOptions& options) {
  assert(slopes.rect() == target.rect());
  region = intersect(region, target.rect());
  if (region.empty()) return {};
  const Squares squares(slopes, validity, options);
  parallel_for(static_cast<std::size_t>(region.height()), 16, [&](std::size_t a, std::size_t b) {
    for (int y = region.y0 + static_cast<int>(a); y < region.y0 + static_cast<int>(b); ++y) {
      for (int x = region.x0; x < region.x1; ++x) {
        target(x, y) = static_cast<float>(squares(x, y).curl());
      }
    }
  });
  return region;
}

int reach(const CurlOptions& /*options*/) { return 1; }

void curl_heatmap(SlopeView slopes, MaskView validity, float maximum, ColorSpan target,
                  const CurlOptions& options) {
  MaskImage values(slopes.width(), slopes.height());
  curl(slopes, validity, values, values.rect(), options);
  std::transform(values.data(), values.data() + values.size(), values.data(),
                 [](float value) { return std::abs(value); });
  heatmap(values, maximum, target);
}

double curl_share(SlopeView slopes, MaskView validity, const CurlOptions& options,
                  const Progress& progress) {
  const ProjectOptions project = {.border = options.border, .tolerance = 1e-6F};
  return project_to_integrable(slopes, validity, {}, slopes.rect(), project, progress)
      .removed_share;
}

double curl_share_of_derivatives(SlopeView slopes, MaskView validity, const CurlOptions& options) {
  const Squares squares(slopes, validity, options);
  const auto sum = [&](const auto& value) {
    return sum_rows({(slopes.width() + 1) / 2, slopes.height()}, [&](int y) {
      double all = 0.0;
      for (int x = 0; x < slopes.width(); ++x) {
        const Derivatives d = squares(x, y);
        if (std::isfinite(d.curl())) all += value(d);
      }
      return all;
    });
  };
  const double curls = sum([](const Derivatives& d) { return d.curl() * d.curl(); });
  const double all = sum(
      [](const Derivatives& d) { return d.y_along_x * d.y_along_x + d.x_along_y * d.x_along_y; });
  return all > 0.0 ? curls / (2.0 * all) : 0.0;
}

double level_change(SlopeView slopes, std::span<const Vec2f> path, const CurlOptions& options) {
  if (slopes.empty()) throw InvalidInput("level_change: the image must have pixels");
  for (const Vec2f& point : path) {
    if (!(std::abs(point.x()) <= 1e6F) || !(std::abs(point.y()) <= 1e6F)) {
      throw InvalidInput("level_change: the path's points must be numbers up to 1e6");
    }
  }
  double sum = 0.0;
  for (std::size_t i = 1; i < path.size(); ++i) {
    sum += gain(slopes, path[i - 1].cast<double>(), path[i].cast<double>(), options.border);
  }
  return sum;
}

}  // namespace normalshop
