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

constexpr int direction_count = 96;
constexpr int sample_count = 12288;
constexpr float pixels_across = 256.0F;  // of the charts in which candidates are judged
/// Views that improve less than this part of the whole area are not worth their time.
constexpr double least_gain = 0.004;
/// The same of hidden surface, of which there is little.
constexpr double least_inner_gain = 0.02;
/// Surface below surface: how often what hides it is left away, and which part of the whole area is
/// worth that.
constexpr int most_layers = 4;
constexpr double least_layer = 0.001;
/// A view is left away where it counts less than this of all.
constexpr float least_share = 0.005F;

/// The axes, which faces of made things look along, and directions spread evenly over the sphere: a
/// Fibonacci lattice.
std::vector<Vec3f> directions() {
  std::vector<Vec3f> out;
  for (int axis = 0; axis < 3; ++axis) {
    out.push_back(Vec3f::Unit(axis));
    out.push_back(-Vec3f::Unit(axis));
  }
  const double golden = 3.14159265358979 * (3.0 - std::sqrt(5.0));
  const int count = direction_count - 6;
  for (int i = 0; i < count; ++i) {
    const double y = 1.0 - (2.0 * i + 1.0) / count;
    const double radius = std::sqrt(1.0 - y * y);
    out.emplace_back(static_cast<float>(radius * std::sin(golden * i)), static_cast<float>(y),
                     static_cast<float>(radius * std::cos(golden * i)));
  }
  return out;
}

double area_of(const Mesh& mesh, std::size_t triangle) {
  const Vec3f& a = mesh.position(3 * triangle);
  const Vec3f normal =
      (mesh.position(3 * triangle + 1) - a).cross(mesh.position(3 * triangle + 2) - a);
  const auto area = static_cast<double>(0.5F * normal.norm());
  return std::isfinite(area) ? area : 0.0;
}

/// The i-th of points that fill a triangle evenly: the R2 sequence (Roberts 2018), folded.
SurfacePoint point_in(std::uint32_t triangle, int i) {
  double u = std::fmod(1.0 / 3.0 + 0.7548776662466927 * i, 1.0);
  double v = std::fmod(1.0 / 3.0 + 0.5698402909980532 * i, 1.0);
  if (u + v > 1.0) {
    u = 1.0 - u;
    v = 1.0 - v;
  }
  return {triangle, static_cast<float>(u), static_cast<float>(v)};
}

double total_area(const Mesh& mesh) {
  double area = 0.0;
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) area += area_of(mesh, t);
  return area;
}

/// Surface points of equal area each on the shown triangles; none without area.
std::vector<SurfacePoint> spread_samples(const Mesh& shown) {
  std::vector<double> areas(shown.triangle_count());
  for (std::size_t t = 0; t < areas.size(); ++t) areas[t] = area_of(shown, t);
  std::partial_sum(areas.begin(), areas.end(), areas.begin());
  const double all = areas.empty() ? 0.0 : areas.back();
  std::vector<SurfacePoint> samples;
  if (!(all > 0.0)) return samples;
  for (int i = 0; i < sample_count; ++i) {
    const auto found = std::upper_bound(areas.begin(), areas.end(), (i + 0.5) / sample_count * all);
    const auto triangle = static_cast<std::uint32_t>(
        std::min<std::ptrdiff_t>(found - areas.begin(), std::ssize(areas) - 1));
    samples.push_back(point_in(triangle, i));
  }
  return samples;
}

/// How a view shows one sample.
struct Seen {
  float weight = 0.0F;  ///< of the effective chart
  float cosine = 0.0F;
};

/// What a view shows of all samples.
std::vector<Seen> look(const Mesh& mesh, const CoverView& cover, const EffectiveOptions& effective,
                       const std::vector<SurfacePoint>& samples) {
  const View& view = cover.view;
  EditingChart chart;
  chart.grid = make_grid(view, std::max(view.width, view.height) / pixels_across);
  cover.rasterize(mesh, chart.grid, chart.ids);
  pull_attributes(mesh, {}, chart, {.normals = false, .albedo = false});
  compute_weight(chart, effective);
  const EditReach reach(chart, chart.weight.rect(), [](int, int) { return true; });
  std::vector<Seen> seen(samples.size());
  TexelBatch batch;
  TriangleCache<PushTriangle> triangles(mesh, chart.grid);  // samples come by triangle
  for (std::size_t begin = 0; begin < samples.size(); begin += TexelBatch::capacity) {
    const std::size_t end = std::min(samples.size(), begin + TexelBatch::capacity);
    batch.count = 0;
    for (std::size_t i = begin; i < end; ++i) {
      batch.add_point(triangles.get(samples[i].triangle), {1.0F, samples[i].b1, samples[i].b2});
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

float counted(const Seen& seen) { return seen.weight * facing_share(seen.cosine); }

/// The part in which the view counts; low above high: nowhere.
void choose_part(const Mesh& mesh, const std::vector<Seen>& seen,
                 const std::vector<float>& all_shares, const std::vector<SurfacePoint>& samples,
                 CoverView& cover) {
  const View& view = cover.view;
  cover.low = Vec2f::Constant(3.4e38F);
  cover.high = -cover.low;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (!(counted(seen[i]) > least_share * all_shares[i])) continue;
    const Vec2f p = view.to_chart(position_at(mesh, samples[i]) - view.center).head<2>();
    cover.low = cover.low.cwiseMin(p);
    cover.high = cover.high.cwiseMax(p);
  }
  // Between samples there is surface, too.
  const float margin = 0.02F * std::max(view.width, view.height);
  cover.low -= Vec2f::Constant(margin);
  cover.high += Vec2f::Constant(margin);
}

/// Indices of the views that improve most, one after the other.
std::vector<std::size_t> choose(const std::vector<std::vector<Seen>>& seen, std::size_t limit,
                                double worth) {
  std::vector<float> best(seen.front().size(), 0.0F);
  std::vector<std::size_t> chosen;
  while (chosen.size() < limit) {
    std::size_t next = 0;
    double most = 0.0;
    for (std::size_t v = 0; v < seen.size(); ++v) {
      double gain = 0.0;
      for (std::size_t i = 0; i < best.size(); ++i) {
        gain += static_cast<double>(std::max(0.0F, quality(seen[v][i]) - best[i]));
      }
      if (gain > most) {
        most = gain;
        next = v;
      }
    }
    if (!(most > worth)) break;
    chosen.push_back(next);
    for (std::size_t i = 0; i < best.size(); ++i) {
      best[i] = std::max(best[i], quality(seen[next][i]));
    }
  }
  return chosen;
}

/// Points of every shown triangle, more of large ones.
std::vector<SurfacePoint> points_of_all(const Mesh& shown) {
  const double spacing = total_area(shown) / sample_count;
  std::vector<SurfacePoint> points;
  for (std::size_t t = 0; t < shown.triangle_count(); ++t) {
    const double area = area_of(shown, t);
    if (!(area > 0.0)) continue;
    const int count = static_cast<int>(std::clamp(area / spacing, 1.0, 16.0));
    for (int i = 0; i < count; ++i) points.push_back(point_in(static_cast<std::uint32_t>(t), i));
  }
  return points;
}

/// Triangles of which the views show a point with less than full weight: what they leave to be
/// shown; all others are points.
std::shared_ptr<const Mesh> what_is_left(const Mesh& mesh, const Mesh& shown,
                                         const std::vector<CoverView>& views,
                                         const EffectiveOptions& effective) {
  const std::vector<SurfacePoint> points = points_of_all(shown);
  std::vector<float> sums(points.size(), 0.0F);
  for (const CoverView& view : views) {
    const std::vector<Seen> seen = look(mesh, view, effective, points);
    for (std::size_t i = 0; i < seen.size(); ++i) sums[i] += seen[i].weight;
  }
  std::vector<float> weights(mesh.triangle_count(), 1.0F);
  for (std::size_t i = 0; i < points.size(); ++i) {
    weights[points[i].triangle] = std::min(weights[points[i].triangle], sums[i]);
  }
  auto left = std::make_shared<Mesh>();
  left->positions = mesh.positions;
  left->triangles = shown.triangles;
  for (std::size_t t = 0; t < weights.size(); ++t) {
    if (weights[t] > 0.95F) left->triangles[t] = Vec3u::Zero();
  }
  return left;
}

/// Views of the triangles that are shown.
std::vector<CoverView> cover_layer(const Mesh& mesh, const std::vector<View>& candidates,
                                   const std::shared_ptr<const Mesh>& shown,
                                   const CoverOptions& options, double least_area) {
  const std::vector<SurfacePoint> samples = spread_samples(shown ? *shown : mesh);
  std::vector<CoverView> views;
  std::vector<std::vector<Seen>> seen;
  for (const View& view : candidates) {
    views.push_back({view, Vec2f::Zero(), Vec2f::Zero(), shown});
    seen.push_back(look(mesh, views.back(), options.effective, samples));
  }
  const bool given = options.views > 0 && !shown;
  const auto limit = static_cast<std::size_t>(given ? options.views : direction_count);
  const std::vector<std::size_t> chosen =
      choose(seen, limit, given ? 0.0 : least_area * sample_count);
  std::vector<float> shares(samples.size(), 0.0F);
  for (const std::size_t v : chosen) {
    for (std::size_t i = 0; i < samples.size(); ++i) shares[i] += counted(seen[v][i]);
  }
  std::vector<CoverView> out;
  for (const std::size_t v : chosen) {
    CoverView& view = views[v];
    choose_part(mesh, seen[v], shares, samples, view);
    if (view.low.x() < view.high.x()) out.push_back(std::move(view));
  }
  return out;
}

}  // namespace

void CoverView::rasterize(const Mesh& mesh, const ChartGrid& grid, IdBuffer& out) const {
  const BackFaces back = shown ? BackFaces::LeaveAway : BackFaces::Draw;
  Rasterizer().rasterize(shown ? *shown : mesh, grid, out, back);
}

std::vector<CoverView> cover_surface(const Mesh& mesh, const CoverOptions& options) {
  const double all = total_area(mesh);
  if (!(all > 0.0)) throw InvalidInput("the model has no surface to cover");
  std::vector<View> candidates;
  for (const Vec3f& direction : directions()) candidates.push_back(framing_view(mesh, direction));
  std::vector<CoverView> views = cover_layer(mesh, candidates, nullptr, options, least_gain);
  std::shared_ptr<const Mesh> shown = what_is_left(mesh, mesh, views, options.effective);
  for (int layer = 1; layer < most_layers; ++layer) {
    if (!(total_area(*shown) > least_layer * all)) break;
    const std::vector<CoverView> inner =
        cover_layer(mesh, candidates, shown, options, least_inner_gain);
    if (inner.empty()) break;
    shown = what_is_left(mesh, *shown, inner, options.effective);
    views.insert(views.end(), inner.begin(), inner.end());
  }
  return views;
}

}  // namespace normalshop
