#include "normalshop/chart/grid.h"

#include <algorithm>
#include <cmath>

#include "normalshop/core/error.h"

namespace normalshop {

Rect lattice_window(float pixel, const Vec2f& low, const Vec2f& high) {
  const auto at = [&](float units) { return units / pixel; };
  Rect window{static_cast<int>(std::floor(at(low.x()))),
              static_cast<int>(std::floor(-at(high.y()))),
              static_cast<int>(std::ceil(at(high.x()))), static_cast<int>(std::ceil(-at(low.y())))};
  window.x1 = std::max(window.x1, window.x0 + 1);
  window.y1 = std::max(window.y1, window.y0 + 1);
  return window;
}

ChartGrid make_grid(const View& view, float pixel) {
  const Vec2f half(0.5F * view.width, 0.5F * view.height);
  return make_grid(view, pixel, -half, half);
}

ChartGrid make_grid(const View& view, float pixel, const Vec2f& low, const Vec2f& high) {
  const float largest = std::max(high.cwiseAbs().maxCoeff(), low.cwiseAbs().maxCoeff());
  if (!(pixel > 0) || !(largest / pixel < 2e6F)) {
    throw InvalidInput("the view is too small beside the model's size");
  }
  ChartGrid grid;
  grid.view = view;
  // Pixels grow when the window would not fit.
  const float side = static_cast<float>(max_chart_side - 2);
  grid.pixel = std::max({pixel, (high.x() - low.x()) / side, (high.y() - low.y()) / side});
  grid.window = lattice_window(grid.pixel, low, high);
  return grid;
}

}  // namespace normalshop
