#include "normalshop/document/apply_edit.h"

#include <chrono>
#include <cmath>

#include "normalshop/chart/effective.h"
#include "normalshop/chart/extend.h"
#include "normalshop/chart/resolution.h"
#include "normalshop/core/error.h"
#include "normalshop/core/parallel.h"

namespace normalshop {

namespace {

/// Depth steps fade an edit out over this part of the model's size.
constexpr float step_falloff_share = 0.004F;

class Stopwatch {
 public:
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    const double seconds = std::chrono::duration<double>(now - last_).count();
    last_ = now;
    return seconds;
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

Extent view_extent(const View& view) {
  return {Vec2f(-0.5F * view.width, -0.5F * view.height),
          Vec2f(0.5F * view.width, 0.5F * view.height)};
}

Rect pixel_rect(const ChartGrid& grid, const Extent& extent) {
  const Vec2f low = grid.to_pixel({extent.low.x(), extent.high.y()});
  const Vec2f high = grid.to_pixel({extent.high.x(), extent.low.y()});
  return {static_cast<int>(std::floor(low.x())), static_cast<int>(std::floor(low.y())),
          static_cast<int>(std::ceil(high.x())) + 1, static_cast<int>(std::ceil(high.y())) + 1};
}

std::vector<Stroke> to_pixels(const std::vector<UnitStroke>& strokes, const ChartGrid& grid) {
  std::vector<Stroke> out;
  for (const UnitStroke& stroke : strokes) {
    Stroke pixels;
    for (const UnitPoint& p : stroke) pixels.push_back({grid.to_pixel(p.position), p.pressure});
    out.push_back(std::move(pixels));
  }
  return out;
}

ChartGrid choose_grid(const Edit& edit, const View& view, const Extent& extent, const Mesh& mesh,
                      const StorageAtlas& storage) {
  const float pixel = texel_pixel_size(mesh, storage, view, extent.low, extent.high);
  const float largest =
      std::max(extent.low.cwiseAbs().maxCoeff(), extent.high.cwiseAbs().maxCoeff());
  if (!(largest < 1e5F * std::max(view.width, view.height))) {
    throw InvalidInput(edit.path + ".strokes: points lie far outside the view, which is " +
                       std::to_string(view.width) + " wide");
  }
  const float margin = edit.operation->reach() + 4.0F * pixel;
  const Vec2f wide(margin, margin);
  return make_grid(view, pixel, extent.low - wide, extent.high + wide);
}

/// Does any part of the stroke's path lie over surface that faces the viewer?
bool meets_surface(const Stroke& stroke, const EditingChart& chart) {
  const auto on_surface = [&](const Vec2f& p) {
    const int x = static_cast<int>(std::lround(p.x()));
    const int y = static_cast<int>(std::lround(p.y()));
    return chart.weight.rect().contains(x, y) && chart.weight(x, y) > 0.0F;
  };
  for (std::size_t i = 0; i < stroke.size(); ++i) {
    const Vec2f a = stroke[i].position;
    const Vec2f b = stroke[std::min(i + 1, stroke.size() - 1)].position;
    const int steps = 1 + std::min(static_cast<int>((b - a).norm()), 20000);
    for (int k = 0; k <= steps; ++k) {
      const float t = static_cast<float>(k) / static_cast<float>(steps);
      if (on_surface(a + t * (b - a))) return true;
    }
  }
  return false;
}

void check_on_surface(const Edit& edit, const std::vector<Stroke>& strokes,
                      const EditingChart& chart) {
  for (std::size_t i = 0; i < strokes.size(); ++i) {
    if (meets_surface(strokes[i], chart)) continue;
    throw InvalidInput(edit.path + ".strokes[" + std::to_string(i) +
                       "]: lies off the surface that the view shows; points are in object units "
                       "from the view's centre, x right and y up");
  }
}

/// The two numbers that the operator sees, and where they are real.
struct Source {
  SlopeImage slopes;
  MaskImage validity;
};

Source make_source(const Edit& edit, const EditingChart& chart) {
  constexpr float least_facing = 0.17F;  // beyond 80 degrees slopes say little
  const int width = chart.grid.width();
  const int height = chart.grid.height();
  Source source{SlopeImage(width, height), MaskImage(width, height)};
  const bool ignore = edit.details == DetailsRule::Ignore;
  parallel_for(static_cast<std::size_t>(height), 32, [&](std::size_t a, std::size_t b) {
    for (int y = static_cast<int>(a); y < static_cast<int>(b); ++y) {
      for (int x = 0; x < width; ++x) {
        const Vec3f& base = chart.base_normal(x, y);
        const bool valid = base.z() > least_facing;
        source.validity(x, y) = valid ? 1.0F : 0.0F;
        source.slopes(x, y) = !valid   ? Vec2f(0.0F, 0.0F)
                              : ignore ? base_gradient(base, edit.mode)
                                       : gradient_from_normal(chart.normal(x, y), base, edit.mode);
      }
    }
  });
  extend(source.validity, source.slopes);
  return source;
}

void scale(float factor, Rect region, SlopeSpan change, MaskSpan coverage) {
  if (factor == 1.0F) return;
  for (int y = region.y0; y < region.y1; ++y) {
    for (int x = region.x0; x < region.x1; ++x) {
      change(x, y) *= factor;
      coverage(x, y) *= factor;
    }
  }
}

}  // namespace

EditReport apply_edit(const Edit& edit, const Mesh& mesh, StorageAtlas& storage) {
  EditReport report;
  Stopwatch watch;
  const View view = resolve(edit.view, mesh);
  Extent extent = edit.operation->extent(edit.strokes);
  if (extent.empty()) extent = view_extent(view);

  EditingChart chart;
  chart.grid = choose_grid(edit, view, extent, mesh, storage);
  Rasterizer().rasterize(mesh, chart.grid, chart.ids);
  PullOptions pulled;
  pulled.normals = edit.operation->reads() && edit.details == DetailsRule::Keep;
  pull_attributes(mesh, storage, chart, pulled);
  EffectiveOptions effective;
  effective.full_angle = edit.effective.full;
  effective.zero_angle = edit.effective.zero;
  effective.step_falloff = step_falloff_share * bounds(mesh).diagonal();
  compute_weight(chart, effective);
  report.times.pull = watch.lap();

  OperatorInput input;
  input.strokes = to_pixels(edit.strokes, chart.grid);
  check_on_surface(edit, input.strokes, chart);
  input.pixel = chart.grid.pixel;
  input.view = pixel_rect(chart.grid, view_extent(view));
  input.region = intersect(pixel_rect(chart.grid, extent), chart.weight.rect());
  Source source;
  if (edit.operation->reads()) source = make_source(edit, chart);
  input.source = source.slopes;
  input.validity = source.validity;
  SlopeImage change(chart.grid.width(), chart.grid.height(), Vec2f(0.0F, 0.0F));
  MaskImage coverage(chart.grid.width(), chart.grid.height(), 0.0F);
  Rect region = edit.operation->run(input, change, coverage);
  scale(edit.strength, region, change, coverage);
  report.times.operate = watch.lap();

  ChartEdit result;
  result.mode = edit.mode;
  result.change = change;
  if (edit.details == DetailsRule::Ignore) result.coverage = coverage;
  result.region = region;
  if (edit.strength > 0.0F) report.pushed = push(mesh, chart, result, storage);
  report.times.push = watch.lap();
  report.chart_width = chart.grid.width();
  report.chart_height = chart.grid.height();
  report.pixel = chart.grid.pixel;
  return report;
}

}  // namespace normalshop
