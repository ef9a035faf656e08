#pragma once

#include "normalshop/chart/depth_steps.h"
#include "normalshop/chart/effective.h"

namespace normalshop::test {

inline ChartGrid with_half_pixels(ChartGrid grid) {
  const Rect& w = grid.window;
  return {grid.view, 0.5F * grid.pixel, {2 * w.x0, 2 * w.y0, 2 * w.x1, 2 * w.y1}};
}

/// How far two charts of one window, the second with pixels half as long, agree about depth steps.
struct StepAgreement {
  int coarse = 0;       ///< steps of the first
  int fine = 0;         ///< of the second
  int coarse_only = 0;  ///< of the first without any of the second within a pixel of the first
  int fine_only = 0;    ///< the other way round
};

inline EditingChart bare_chart(const Mesh& mesh, const ChartGrid& grid) {
  EditingChart chart;
  chart.grid = grid;
  Rasterizer().rasterize(mesh, grid, chart.ids);
  pull_attributes(mesh, {}, chart, {.normals = false, .albedo = false});
  return chart;
}

inline bool any_step(const Image<std::uint8_t>& steps, const Rect& pixels) {
  const Rect r = intersect(pixels, steps.rect());
  for (int y = r.y0; y < r.y1; ++y) {
    for (int x = r.x0; x < r.x1; ++x) {
      if (steps(x, y) != 0) return true;
    }
  }
  return false;
}

inline StepAgreement step_agreement(const Mesh& mesh, const ChartGrid& grid, float least) {
  Image<std::uint8_t> coarse;
  Image<std::uint8_t> fine;
  find_depth_steps(bare_chart(mesh, grid), least, coarse);
  find_depth_steps(bare_chart(mesh, with_half_pixels(grid)), least, fine);
  StepAgreement out;
  for (int y = 0; y < coarse.height(); ++y) {
    for (int x = 0; x < coarse.width(); ++x) {
      if (coarse(x, y) == 0) continue;
      ++out.coarse;
      if (!any_step(fine, {2 * x - 2, 2 * y - 2, 2 * x + 4, 2 * y + 4})) ++out.coarse_only;
    }
  }
  for (int y = 0; y < fine.height(); ++y) {
    for (int x = 0; x < fine.width(); ++x) {
      if (fine(x, y) == 0) continue;
      ++out.fine;
      if (!any_step(coarse, {x / 2 - 1, y / 2 - 1, x / 2 + 2, y / 2 + 2})) ++out.fine_only;
    }
  }
  return out;
}

/// The effective chart at both resolutions, in pixels of the first that show surface.
struct WeightAgreement {
  int pixels = 0;
  int far = 0;        ///< whose weights differ by more than a quarter
  double mean = 0.0;  ///< difference
};

inline WeightAgreement weight_agreement(const Mesh& mesh, const ChartGrid& grid,
                                        const EffectiveOptions& options) {
  EditingChart coarse = bare_chart(mesh, grid);
  EditingChart fine = bare_chart(mesh, with_half_pixels(grid));
  compute_weight(coarse, options);
  compute_weight(fine, options);
  WeightAgreement out;
  for (int y = 0; y < grid.height(); ++y) {
    for (int x = 0; x < grid.width(); ++x) {
      if (coarse.ids.triangle(x, y) == no_triangle) continue;
      const float sum = fine.weight(2 * x, 2 * y) + fine.weight(2 * x + 1, 2 * y) +
                        fine.weight(2 * x, 2 * y + 1) + fine.weight(2 * x + 1, 2 * y + 1);
      const float difference = std::abs(0.25F * sum - coarse.weight(x, y));
      ++out.pixels;
      out.far += difference > 0.25F ? 1 : 0;
      out.mean += static_cast<double>(difference);
    }
  }
  out.mean /= std::max(out.pixels, 1);
  return out;
}

}  // namespace normalshop::test
