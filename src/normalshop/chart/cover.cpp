#include "normalshop/chart/cover.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "normalshop/chart/edit_reach.h"
#include "normalshop/chart/visible_weight.h"
#include "normalshop/core/error.h"
#include "normalshop/surface/frames.h"

namespace normalshop {

namespace {

constexpr int candidates = 192;
constexpr int sample_count = 16384;
constexpr float pixels_across = 400.0F;  // of the charts in which candidates are judged
/// Views that improve less than this part of the whole area are not worth their time.
constexpr double least_gain = 0.004;
/// A view is left away where it counts less than this of all.
constexpr float least_share = 0.005F;

/// Directions spread evenly over the sphere: a Fibonacci lattice.
std::vector<Vec3f> directions() {
  std::vector<Vec3f> out;
  const double golden = 3.14159265358979 * (3.0 - std::sqrt(5.0));
  for (int i = 0; i < candidates; ++i) {
    const double y = 1.0 - (2.0 * i + 1.0) / candidates;
    const double radius = std::sqrt(1.0 - y * y);
    out.emplace_back(static_cast<float>(radius * std::sin(golden * i)), static_cast<float>(y),
                     static_cast<float>(radius * std::cos(golden * i)));
  }
  return out;
}

/// Surface points of equal area each.
std::vector<SurfacePoint> spread_samples(const Mesh& mesh) {
  std::vector<double> areas(mesh.triangle_count());
  for (std::size_t t = 0; t < areas.size(); ++t) {
    const Vec3f& a = mesh.position(3 * t);
    const double area =
        0.5 * (mesh.position(3 * t + 1) - a).cross(mesh.position(3 * t + 2) - a).norm();
    areas[t] = std::isfinite(area) ? area : 0.0;
  }
  std::partial_sum(areas.begin(), areas.end(), areas.begin());
  const double all = areas.empty() ? 0.0 : areas.back();
  if (!(all > 0.0)) throw InvalidInput("the model has no surface to cover");
  std::vector<SurfacePoint> samples;
  for (int i = 0; i < sample_count; ++i) {
    const auto found = std::upper_bound(areas.begin(), areas.end(), (i + 0.5) / sample_count * all);
    const auto triangle = static_cast<std::uint32_t>(
        std::min<std::ptrdiff_t>(found - areas.begin(), std::ssize(areas) - 1));
    // R2 sequence (Roberts 2018), folded into the triangle.
    double u = std::fmod(0.5 + 0.7548776662466927 * i, 1.0);
    double v = std::fmod(0.5 + 0.5698402909980532 * i, 1.0);
    if (u + v > 1.0) {
      u = 1.0 - u;
      v = 1.0 - v;
    }
    samples.push_back({triangle, static_cast<float>(u), static_cast<float>(v)});
  }
  return samples;
}

/// How a view shows one sample.
struct Seen {
  float weight = 0.0F;  ///< of the effective chart
  float cosine = 0.0F;
};

/// What a view shows of all samples.
std::vector<Seen> look(const Mesh& mesh, const View& view, const EffectiveOptions& effective,
                       const std::vector<SurfacePoint>& samples) {
  EditingChart chart;
  chart.grid = make_grid(view, std::max(view.width, view.height) / pixels_across);
  Rasterizer().rasterize(mesh, chart.grid, chart.ids);
  pull_attributes(mesh, {}, chart, {.normals = false, .albedo = false});
  compute_weight(chart, effective);
  const EditReach reach(chart, chart.weight.rect(), [](int, int) { return true; });
  std::vector<Seen> seen(samples.size());
  TexelBatch batch;
  PushTriangle triangle;
  for (std::size_t begin = 0; begin < samples.size(); begin += TexelBatch::capacity) {
    const std::size_t end = std::min(samples.size(), begin + TexelBatch::capacity);
    batch.count = 0;
    for (std::size_t i = begin; i < end; ++i) {
      triangle.load(mesh, chart.grid, samples[i].triangle);
      batch.add_point(triangle, {1.0F, samples[i].b1, samples[i].b2});
    }
    if (!read_visible_weight(reach, batch)) continue;
    for (int i = 0; i < batch.count; ++i) {
      const Vec3f base = batch.base.get(i);
      seen[begin + static_cast<std::size_t>(i)] = {batch.weight[static_cast<std::size_t>(i)],
                                                   base.z() / base.norm()};
    }
  }
  return seen;
}

/// How well a sample is seen: 1 at best, half as much from 33 degrees.
float quality(const Seen& seen) {
  const float squared = seen.cosine * seen.cosine;
  return seen.weight * squared * squared;
}

float share(const Seen& seen) { return seen.weight * facing_share(seen.cosine); }

/// The view with the part in which it counts; low above high: nowhere.
CoverView with_part(const Mesh& mesh, const View& view, const std::vector<Seen>& seen,
                    const std::vector<float>& all_shares,
                    const std::vector<SurfacePoint>& samples) {
  CoverView out{view, Vec2f::Constant(3.4e38F), Vec2f::Constant(-3.4e38F)};
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (!(share(seen[i]) > least_share * all_shares[i])) continue;
    const Vec2f p = view.to_chart(position_at(mesh, samples[i]) - view.center).head<2>();
    out.low = out.low.cwiseMin(p);
    out.high = out.high.cwiseMax(p);
  }
  // Between samples there is surface, too.
  const float margin = 0.02F * std::max(view.width, view.height);
  out.low -= Vec2f::Constant(margin);
  out.high += Vec2f::Constant(margin);
  return out;
}

}  // namespace

std::vector<CoverView> cover_surface(const Mesh& mesh, const CoverOptions& options) {
  const std::vector<SurfacePoint> samples = spread_samples(mesh);
  std::vector<View> views;
  std::vector<std::vector<Seen>> seen;
  for (const Vec3f& direction : directions()) {
    views.push_back(framing_view(mesh, direction));
    seen.push_back(look(mesh, views.back(), options.effective, samples));
  }
  const auto limit = static_cast<std::size_t>(options.views > 0 ? options.views : candidates);
  std::vector<float> best(samples.size(), 0.0F);
  std::vector<std::size_t> chosen;
  while (chosen.size() < limit) {
    std::size_t next = 0;
    double most = 0.0;
    for (std::size_t v = 0; v < views.size(); ++v) {
      double gain = 0.0;
      for (std::size_t i = 0; i < samples.size(); ++i) {
        gain += static_cast<double>(std::max(0.0F, quality(seen[v][i]) - best[i]));
      }
      if (gain > most) {
        most = gain;
        next = v;
      }
    }
    const bool worth = most > least_gain * sample_count;
    if (!(most > 0.0) || (options.views == 0 && !worth)) break;
    chosen.push_back(next);
    for (std::size_t i = 0; i < samples.size(); ++i) {
      best[i] = std::max(best[i], quality(seen[next][i]));
    }
  }
  std::vector<float> shares(samples.size(), 0.0F);
  for (const std::size_t v : chosen) {
    for (std::size_t i = 0; i < samples.size(); ++i) shares[i] += share(seen[v][i]);
  }
  std::vector<CoverView> out;
  for (const std::size_t v : chosen) {
    const CoverView view = with_part(mesh, views[v], seen[v], shares, samples);
    if (view.low.x() < view.high.x()) out.push_back(view);
  }
  return out;
}

}  // namespace normalshop
