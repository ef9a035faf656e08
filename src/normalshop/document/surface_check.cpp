#include "normalshop/document/surface_check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "normalshop/core/error.h"

namespace normalshop {

namespace {

/// Points may lie this many times the view's size from its centre.
constexpr float farthest = 100.0F;

std::string number_text(float number) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.4g", static_cast<double>(number));
  return text.data();
}

bool on_surface(const EditingChart& chart, const Vec2f& p, const Rect& within) {
  const int x = static_cast<int>(std::lround(p.x()));
  const int y = static_cast<int>(std::lround(p.y()));
  return within.contains(x, y) && chart.weight(x, y) > 0.0F;
}

bool any_surface(const EditingChart& chart, const Rect& pixels) {
  const Rect r = intersect(pixels, chart.weight.rect());
  for (int y = r.y0; y < r.y1; ++y) {
    const float* row = chart.weight.row(y);
    if (std::any_of(row + r.x0, row + std::max(r.x0, r.x1), [](float w) { return w > 0.0F; })) {
      return true;
    }
  }
  return false;
}

/// Cuts the segment to where it runs through the rectangle; false when it doesn't.
bool clip(const Rect& rect, Vec2f& a, Vec2f& b) {
  const Vec2f d = b - a;
  float from = 0.0F;
  float to = 1.0F;
  const auto low = Vec2f(static_cast<float>(rect.x0) - 1.0F, static_cast<float>(rect.y0) - 1.0F);
  const auto high = Vec2f(static_cast<float>(rect.x1), static_cast<float>(rect.y1));
  for (Eigen::Index k = 0; k < 2; ++k) {
    if (d[k] == 0.0F) {
      if (a[k] < low[k] || a[k] > high[k]) return false;
      continue;
    }
    const float t0 = (low[k] - a[k]) / d[k];
    const float t1 = (high[k] - a[k]) / d[k];
    from = std::max(from, std::min(t0, t1));
    to = std::min(to, std::max(t0, t1));
  }
  if (!(from <= to)) return false;
  b = a + to * d;
  a += from * d;
  return true;
}

bool segment_meets(const EditingChart& chart, Vec2f a, Vec2f b, const Rect& within) {
  if (!clip(within, a, b)) return false;
  const int steps = 1 + static_cast<int>((b - a).norm());
  for (int k = 0; k <= steps; ++k) {
    const float t = static_cast<float>(k) / static_cast<float>(steps);
    if (on_surface(chart, a + t * (b - a), within)) return true;
  }
  return false;
}

bool path_meets(const EditingChart& chart, const Stroke& stroke, bool closed, const Rect& within) {
  for (std::size_t i = 0; i + 1 < stroke.size(); ++i) {
    if (segment_meets(chart, stroke[i].position, stroke[i + 1].position, within)) return true;
  }
  const Vec2f& first = stroke.front().position;
  const Vec2f& last = stroke.back().position;
  return on_surface(chart, last, within) || (closed && segment_meets(chart, last, first, within));
}

struct Crossing {
  float x;
  int winding;
};

/// Does the area inside a polygon (winding number not 0) hold any surface?
bool inside_meets(const EditingChart& chart, const Stroke& polygon) {
  std::vector<Crossing> crossings;
  for (int y = 0; y < chart.weight.height(); ++y) {
    crossings.clear();
    const auto line = static_cast<float>(y);
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Vec2f& a = polygon[i].position;
      const Vec2f& b = polygon[(i + 1) % polygon.size()].position;
      if ((a.y() > line) == (b.y() > line)) continue;
      const float t = (line - a.y()) / (b.y() - a.y());
      crossings.push_back({a.x() + t * (b.x() - a.x()), b.y() > a.y() ? 1 : -1});
    }
    std::sort(crossings.begin(), crossings.end(),
              [](const Crossing& a, const Crossing& b) { return a.x < b.x; });
    int winding = 0;
    for (std::size_t i = 0; i + 1 < crossings.size(); ++i) {
      winding += crossings[i].winding;
      if (winding == 0) continue;
      const auto pixel = [&](float x) {
        return static_cast<int>(std::ceil(std::clamp(x, -1.0F, 1e6F)));
      };
      if (any_surface(chart, {pixel(crossings[i].x), y, pixel(crossings[i + 1].x), y + 1})) {
        return true;
      }
    }
  }
  return false;
}

bool copy_meets(const EditingChart& chart, const EditOperator& operation, const UnitPoint& point) {
  return any_surface(chart, pixel_rect(chart.grid, operation.extent({{point}})));
}

}  // namespace

void fail_off_surface(const std::string& field, const Extent& model) {
  throw InvalidInput(field +
                     " lies off the surface that the view shows; points are in object units (in a "
                     "picture: pixels) from the view's centre, x right and y up, and the surface "
                     "spans x " +
                     number_text(model.low.x()) + " to " + number_text(model.high.x()) + ", y " +
                     number_text(model.low.y()) + " to " + number_text(model.high.y()));
}

void check_near_view(const Edit& edit, const View& view) {
  const float limit = farthest * std::max(view.width, view.height);
  for (std::size_t i = 0; i < edit.strokes.size(); ++i) {
    for (std::size_t j = 0; j < edit.strokes[i].size(); ++j) {
      if (edit.strokes[i][j].position.cwiseAbs().maxCoeff() <= limit) continue;
      throw InvalidInput(edit.path + ".strokes[" + std::to_string(i) + "][" + std::to_string(j) +
                         "] must lie within " + number_text(limit) +
                         " object units of the centre of the view, which is " +
                         number_text(view.width) + " wide and " + number_text(view.height) +
                         " high");
    }
  }
}

SurfaceCheck::SurfaceCheck(const Edit& edit, std::size_t strokes) : edit_(edit) {
  for (std::size_t i = 0; i < strokes; ++i) {
    met_.emplace_back(by_points() ? edit.strokes[i].size() : std::size_t{1}, false);
  }
}

void SurfaceCheck::look(const std::vector<Stroke>& strokes, const EditingChart& chart,
                        const Rect& region) {
  const EditOperator& operation = *edit_.operation;
  const StrokeUse use = operation.stroke_use();
  const Rect all = chart.weight.rect();
  const Rect within = operation.picks() ? intersect(region, all) : all;
  const auto meets = [&](std::size_t i, std::size_t j) {
    if (!by_points()) {
      return path_meets(chart, strokes[i], use != StrokeUse::Path, within) ||
             (use == StrokeUse::Inside && inside_meets(chart, strokes[i]));
    }
    return operation.picks() ? on_surface(chart, strokes[i][j].position, within)
                             : copy_meets(chart, operation, edit_.strokes[i][j]);
  };
  for (std::size_t i = 0; i < met_.size(); ++i) {
    for (std::size_t j = 0; j < met_[i].size(); ++j) met_[i][j] = met_[i][j] || meets(i, j);
  }
  any_ = any_ || (strokes.empty() && any_surface(chart, region));
}

void SurfaceCheck::demand(const Extent& model) const {
  for (std::size_t i = 0; i < met_.size(); ++i) {
    for (std::size_t j = 0; j < met_[i].size(); ++j) {
      if (met_[i][j]) continue;
      const std::string point = by_points() ? "[" + std::to_string(j) + "]" : "";
      fail_off_surface(edit_.path + ".strokes[" + std::to_string(i) + "]" + point, model);
    }
  }
  if (met_.empty() && !any_) {
    throw InvalidInput(edit_.path +
                       ".view must show surface that faces the viewer; \"direction\" points from "
                       "the surface to the viewer");
  }
}

void check_on_surface(const Edit& edit, const std::vector<Stroke>& strokes,
                      const EditingChart& chart, const Rect& region, const Extent& model) {
  SurfaceCheck check(edit, strokes.size());
  check.look(strokes, chart, region);
  check.demand(model);
}

Rect pixel_rect(const ChartGrid& grid, const Extent& extent) {
  // On the lattice first, so that windows of it agree.
  const auto pixel = [](float x) { return static_cast<int>(std::clamp(x, -1e8F, 1e8F)); };
  const auto at = [&](float units) { return units / grid.pixel - 0.5F; };
  const Rect lattice{pixel(std::floor(at(extent.low.x()))), pixel(std::floor(at(-extent.high.y()))),
                     pixel(std::ceil(at(extent.high.x()))) + 1,
                     pixel(std::ceil(at(-extent.low.y()))) + 1};
  return shift(lattice, -grid.window.x0, -grid.window.y0);
}

}  // namespace normalshop
