#pragma once

#include "normalshop/chart/view.h"
#include "normalshop/core/rect.h"

namespace normalshop {

/// The pixels of an editing chart: a window on the lattice of square pixels that a view and a pixel
/// size define. Windows of one view and pixel size share their pixels.
struct ChartGrid {
  View view;
  float pixel = 1.0F;  ///< object units per pixel
  /// Lattice pixels of the window; pixel (0, 0) touches the view's centre from the lower right.
  Rect window;

  int width() const { return window.width(); }
  int height() const { return window.height(); }

  /// Pixel coordinates (centres at integers, y down) of a point given in object units from the
  /// view's centre, y up; and back.
  Vec2f to_pixel(const Vec2f& p) const {
    return {p.x() / pixel - 0.5F - static_cast<float>(window.x0),
            -p.y() / pixel - 0.5F - static_cast<float>(window.y0)};
  }
  Vec2f to_units(const Vec2f& p) const {
    return {(p.x() + 0.5F + static_cast<float>(window.x0)) * pixel,
            -(p.y() + 0.5F + static_cast<float>(window.y0)) * pixel};
  }
  /// Object-space point to pixel coordinates and depth (object units towards the viewer).
  Vec3f project(const Vec3f& position) const {
    const Vec3f p = view.to_chart(position - view.center);
    const Vec2f q = to_pixel({p.x(), p.y()});
    return {q.x(), q.y(), p.z()};
  }
};

/// Largest side of a chart. Beyond it the pixels grow instead, or the view is cut into tiles.
inline constexpr int max_chart_side = 8192;

/// The lattice pixels of that size that hold a part of a view, given as below; one at least.
Rect lattice_window(float pixel, const Vec2f& low, const Vec2f& high);

/// The window of `view` (its whole extent, or the part given in object units from its centre, y up)
/// with pixels of that size, or larger: see max_chart_side. Throws InvalidInput when the window
/// would reach 2 million pixels of that size from the view's centre, or the size is not above 0.
ChartGrid make_grid(const View& view, float pixel);
ChartGrid make_grid(const View& view, float pixel, const Vec2f& low, const Vec2f& high);

}  // namespace normalshop
