#include "normalshop/rgbn/project.h"

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <Eigen/Eigenvalues>

#include "normalshop/core/error.h"
#include "normalshop/core/parallel.h"
#include "normalshop/rgbn/detail/corner_heights.h"
#include "normalshop/rgbn/detail/pixel_domain.h"

namespace normalshop {

namespace {

void check(const ProjectOptions& options) {
  if (!(options.fade >= 0.0F) || !(options.fade <= 1e4F)) {
    throw InvalidInput("project: fade must be from 0 to 10000 pixels");
  }
  if (!(options.tolerance >= 1e-9F) || !(options.tolerance <= 1e-2F)) {
    throw InvalidInput("project: tolerance must be from 1e-9 to 0.01");
  }
}

/// The pixels of the region, repeated until the solver can make them a torus.
class Domain {
 public:
  Domain(SlopeView source, MaskView validity, const Rect& region, bool wraps) : region_(region) {
    const int width = region.width() * (wraps ? repeats(region.width()) : 1);
    const int height = region.height() * (wraps ? repeats(region.height()) : 1);
    slopes.resize(width, height);
    weights.resize(width, height);
    for_each_pixel(slopes.rect(), [&](int x, int y) {
      const int sx = region.x0 + x % region.width();
      const int sy = region.y0 + y % region.height();
      const Vec2f& slope = source(sx, sy);
      const float weight = validity.empty() ? 1.0F : std::min(validity(sx, sy), 1.0F);
      const bool counts = weight > 0.0F && std::isfinite(slope.x()) && std::isfinite(slope.y());
      slopes(x, y) = slope;
      weights(x, y) = counts ? weight : 0.0F;
    });
  }

  template <class Body>
  static void for_each_pixel(const Rect& rect, const Body& body) {
    parallel_for(static_cast<std::size_t>(rect.height()), 16, [&](std::size_t a, std::size_t b) {
      for (int y = static_cast<int>(a); y < static_cast<int>(b); ++y) {
        for (int x = 0; x < rect.width(); ++x) body(x, y);
      }
    });
  }
  /// Sum of weight * value(x, y) over the pixels.
  template <class Value>
  double sum(const Value& value) const {
    return sum_rows({(weights.width() + 1) / 2, weights.height()}, [&](int y) {
      double all = 0.0;
      for (int x = 0; x < weights.width(); ++x) {
        const float weight = weights(x, y);
        if (weight > 0.0F) all += static_cast<double>(weight) * value(x, y);
      }
      return all;
    });
  }
  Vec2d slope(int x, int y) const { return slopes(x, y).cast<double>(); }
  Vec2d mean() const {
    const double all = sum([](int, int) { return 1.0; });
    if (!(all > 0.0)) return Vec2d::Zero();
    return Vec2d(sum([&](int x, int y) { return slope(x, y).x(); }),
                 sum([&](int x, int y) { return slope(x, y).y(); })) /
           all;
  }
  bool whole() const {
    return sum([](int, int) { return 1.0; }) == static_cast<double>(weights.size());
  }
  Rect rect() const { return {0, 0, region_.width(), region_.height()}; }

  SlopeImage slopes;
  MaskImage weights;  ///< 0: does not count

 private:
  static int repeats(int size) {
    int times = 1;
    while (size * times < 8 || size * times % 2 != 0) ++times;
    return times;
  }

  Rect region_;
};

/// The constant slope that is best beside slopes of a height that repeats. What a mask cuts off all
/// around leaves none.
Vec2d tilt(CornerHeights& system, const Domain& domain, const CornerHeights::Options& options) {
  if (domain.whole()) return domain.mean();
  std::array<Image<double>, 2> heights;
  for (int k = 0; k < 2; ++k) {
    const SlopeImage unit(domain.slopes.width(), domain.slopes.height(),
                          k == 0 ? Vec2f::UnitX() : Vec2f::UnitY());
    heights[static_cast<std::size_t>(k)] = system.solve(unit, options, {}).heights;
  }
  const auto rest = [&](int k, int x, int y) -> Vec2d {
    return Vec2d::Unit(k) - slope_at(heights[static_cast<std::size_t>(k)], x, y);
  };
  Eigen::Matrix2d gram;
  Vec2d right;
  for (int k = 0; k < 2; ++k) {
    for (int l = 0; l < 2; ++l) {
      gram(k, l) = domain.sum([&](int x, int y) { return rest(k, x, y).dot(rest(l, x, y)); });
    }
    right[k] = domain.sum([&](int x, int y) { return rest(k, x, y).dot(domain.slope(x, y)); });
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(gram);
  const double least = 1e-9 * domain.sum([](int, int) { return 1.0; });
  Vec2d result = Vec2d::Zero();
  for (int k = 0; k < 2; ++k) {
    const Vec2d axis = eigen.eigenvectors().col(k);
    if (eigen.eigenvalues()[k] > least) result += axis.dot(right) / eigen.eigenvalues()[k] * axis;
  }
  return result;
}

double removed_share(const Domain& domain, const Image<double>& heights, const Vec2d& constant) {
  const Vec2d mean = domain.mean();
  const double energy =
      domain.sum([&](int x, int y) { return (domain.slope(x, y) - mean).squaredNorm(); });
  if (!(energy > 0.0)) return 0.0;
  const double removed = domain.sum([&](int x, int y) {
    return (domain.slope(x, y) - constant - slope_at(heights, x, y)).squaredNorm();
  });
  return removed / energy;
}

/// Rises from 0 to 1 with slope and curvature 0 at both ends.
double window(double t) {
  const double c = std::clamp(t, 0.0, 1.0);
  return c * c * c * (10.0 + c * (6.0 * c - 15.0));
}

void fade(const Domain& domain, bool wraps, float width, Image<double>& heights) {
  const Image<float> distance = end_distance(domain.weights, wraps, width);
  Domain::for_each_pixel(heights.rect(), [&](int x, int y) {
    heights(x, y) *= window(static_cast<double>(distance(x, y)) / static_cast<double>(width));
  });
}

/// Mean height of each part.
std::vector<double> means(const ConnectedPixels& parts, const Image<double>& heights) {
  std::vector<double> sums(static_cast<std::size_t>(parts.count), 0.0);
  std::vector<double> counts(static_cast<std::size_t>(parts.count), 0.0);
  for (int y = 0; y < parts.labels.height(); ++y) {
    for (int x = 0; x < parts.labels.width(); ++x) {
      if (parts.labels(x, y) < 0) continue;
      const auto part = static_cast<std::size_t>(parts.labels(x, y));
      sums[part] += height_at(heights, x, y);
      counts[part] += 1.0;
    }
  }
  for (std::size_t i = 0; i < sums.size(); ++i) sums[i] /= counts[i];
  return sums;
}

void write_slopes(const Domain& domain, const Image<double>& heights, const Vec2d& constant,
                  const Rect& region, SlopeSpan target) {
  Domain::for_each_pixel(domain.rect(), [&](int x, int y) {
    const bool counts = domain.weights(x, y) > 0.0F;
    target(region.x0 + x, region.y0 + y) =
        counts ? Vec2f((slope_at(heights, x, y) + constant).cast<float>()) : domain.slopes(x, y);
  });
}

/// `level`: parts are moved to mean 0.
void write_height(const Domain& domain, const Image<double>& heights, bool level, bool wraps,
                  const Rect& region, MaskSpan target) {
  const ConnectedPixels parts = connected_pixels(domain.weights, wraps);
  std::vector<double> base(static_cast<std::size_t>(parts.count), 0.0);
  if (level) base = means(parts, heights);
  Domain::for_each_pixel(domain.rect(), [&](int x, int y) {
    const int part = parts.labels(x, y);
    target(region.x0 + x, region.y0 + y) =
        part < 0
            ? std::numeric_limits<float>::quiet_NaN()
            : static_cast<float>(height_at(heights, x, y) - base[static_cast<std::size_t>(part)]);
  });
}

}  // namespace

Projection project_to_integrable(SlopeView source, MaskView validity,
                                 const ProjectionTarget& target, Rect region,
                                 const ProjectOptions& options, const Progress& progress) {
  check(options);
  assert(validity.empty() || validity.rect() == source.rect());
  assert(target.slopes.empty() || target.slopes.rect() == source.rect());
  assert(target.height.empty() || target.height.rect() == source.rect());
  region = intersect(region, source.rect());
  if (region.empty()) return {};
  const bool wraps = options.border == Border::Wrap;
  if (wraps && region != source.rect()) {
    throw InvalidInput("project: border wrap needs the whole image as its region");
  }
  const bool zero = options.ends == HeightEnds::Zero || options.fade > 0.0F;
  Domain domain(source, validity, region, wraps);
  const bool ended = !wraps || !domain.whole();  // there is a border to be 0 at
  const CornerHeights::Options precision = {.tolerance = static_cast<double>(options.tolerance)};

  CornerHeights system(domain.weights, wraps, zero ? Ends::Zero : Ends::Free);
  Vec2d constant = Vec2d::Zero();
  if (wraps && !(zero && ended)) constant = tilt(system, domain, precision);
  SlopeImage level = domain.slopes;
  if (wraps) {
    const Vec2f base = constant.cast<float>();
    Domain::for_each_pixel(level.rect(), [&](int x, int y) { level(x, y) -= base; });
    constant = base.cast<double>();
  }
  CornerHeights::Solution solution = system.solve(level, precision, progress);

  Projection result{region, removed_share(domain, solution.heights, constant), solution.iterations};
  if (options.fade > 0.0F && ended) fade(domain, wraps, options.fade, solution.heights);
  if (!target.slopes.empty()) {
    write_slopes(domain, solution.heights, constant, region, target.slopes);
  }
  if (!target.height.empty()) {
    write_height(domain, solution.heights, !(zero && ended), wraps, region, target.height);
  }
  return result;
}

Projection integrate_height(SlopeView source, MaskView validity, MaskSpan height, Rect region,
                            const ProjectOptions& options, const Progress& progress) {
  return project_to_integrable(source, validity, {.height = height}, region, options, progress);
}

}  // namespace normalshop
