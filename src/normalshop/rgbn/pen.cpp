#include "normalshop/rgbn/pen.h"

#include <cmath>

#include "normalshop/core/error.h"
#include "normalshop/core/sample.h"
#include "normalshop/rgbn/detail/polyline_field.h"
#include "normalshop/rgbn/detail/stroke_line.h"

namespace normalshop {

namespace {

/// Narrower strokes are averaged over several positions in a pixel.
constexpr float narrow_width = 4.0F;
constexpr int narrow_grid = 3;
/// A curve between two stroke points is cut into at most this many pieces.
constexpr int most_pieces = 1000;

void check(std::span<const Stroke> strokes, const PenOptions& o) {
  if (!std::isfinite(o.width) || !std::isfinite(o.height) || !std::isfinite(o.taper) ||
      o.width < 0.0F || o.taper < 0.0F) {
    throw InvalidInput("pen: width, height and taper must be numbers, width and taper at least 0");
  }
  check_strokes("pen", strokes, o.closed);
}

int pieces(float length, float spacing) {
  return std::clamp(static_cast<int>(std::ceil(std::min(length / spacing, 1e6F))), 1, most_pieces);
}

/// Barry and Goldman's pyramid for knots t0..t3 between p1 and p2.
Vec2f catmull_rom(const std::array<Vec2f, 4>& p, const std::array<float, 4>& t, float x) {
  const auto mix = [x](const Vec2f& a, const Vec2f& b, float ta, float tb) -> Vec2f {
    return tb > ta ? Vec2f(((tb - x) * a + (x - ta) * b) / (tb - ta)) : a;
  };
  const Vec2f a1 = mix(p[0], p[1], t[0], t[1]);
  const Vec2f a2 = mix(p[1], p[2], t[1], t[2]);
  const Vec2f a3 = mix(p[2], p[3], t[2], t[3]);
  const Vec2f b1 = mix(a1, a2, t[0], t[2]);
  const Vec2f b2 = mix(a2, a3, t[1], t[3]);
  return mix(b1, b2, t[1], t[2]);
}

float catmull_rom(const std::array<float, 4>& p, float t) {
  if (p[0] == p[1] && p[1] == p[2] && p[2] == p[3]) return std::clamp(p[1], 0.0F, 1.0F);
  const std::array<float, 4> w = cubic_weights(t);
  return std::clamp(p[0] * w[0] + p[1] * w[1] + p[2] * w[2] + p[3] * w[3], 0.0F, 1.0F);
}

Stroke without_repeats(const Stroke& stroke, StrokeEnds ends) {
  Stroke out;
  for (const StrokePoint& p : stroke) {
    if (out.empty() || (p.position - out.back().position).norm() > 1e-3F) out.push_back(p);
  }
  while (ends == StrokeEnds::Closed && out.size() > 1 &&
         (out.front().position - out.back().position).norm() <= 1e-3F) {
    out.pop_back();
  }
  return out;
}

/// 0 at the ends of an open stroke, 1 from `taper` on, parabola between.
float taper_at(float along, float length, float taper) {
  const float reach = std::min(taper, 0.5F * length);
  if (!(reach > 0.0F)) return 1.0F;
  const float t = std::clamp(std::min(along, length - along) / reach, 0.0F, 1.0F);
  return t * (2.0F - t);
}

struct Fades {
  bool width;
  bool height;
};

/// Points with arc length; long segments are cut where the taper bends.
std::vector<FieldVertex> vertices(const Stroke& stroke, const PenOptions& o, const Fades& fades) {
  const std::vector<float> along = lengths_along(stroke);
  const float length = whole_length(stroke, along);
  const float taper = o.closed ? 0.0F : std::min(o.taper, 0.5F * length);
  std::vector<FieldVertex> out;
  const auto push = [&](const Vec2f& position, float pressure, float across, float v) {
    const float p = std::clamp(pressure, 0.0F, 1.0F);
    const float t = taper_at(v, length, taper);
    out.push_back({position, 0.5F * o.width * t * (fades.width ? p : 1.0F) * across,
                   t * t * (fades.height ? p : 1.0F), -1.0F, o.smooth});
  };
  push(stroke.front().position, stroke.front().pressure, stroke.front().across, along.front());
  for (std::size_t i = 1; i < stroke.size(); ++i) {
    const StrokePoint& a = stroke[i - 1];
    const StrokePoint& b = stroke[i];
    const float step = (b.position - a.position).norm();
    const bool bends = taper > 0.0F && (along[i - 1] < taper || along[i] > length - taper);
    const int count = bends ? pieces(step, std::max(1.0F, taper / 32.0F)) : 1;
    for (int k = 1; k <= count; ++k) {
      const float t = static_cast<float>(k) / static_cast<float>(count);
      push(a.position + t * (b.position - a.position), a.pressure + t * (b.pressure - a.pressure),
           a.across + t * (b.across - a.across), along[i - 1] + t * (along[i] - along[i - 1]));
    }
  }
  return out;
}

PolylineField make_field(std::span<const Stroke> strokes, const PenOptions& o,
                         FieldCoverage coverage) {
  check(strokes, o);
  const Profile profile({.shape = o.profile, .closed = o.closed, .curve = o.curve});
  const bool both = o.pressure == PressureTo::Both;
  // Were the height of a level to vary along the stroke, the inside would not fit together.
  const Fades fades = {both || o.pressure == PressureTo::Width,
                       (both || o.pressure == PressureTo::Height) && profile.level() == 0.0F};
  std::vector<FieldShape> shapes;
  for (const Stroke& stroke : strokes) {
    if (stroke.empty() || o.width == 0.0F || o.height == 0.0F) continue;
    FieldShape shape;
    shape.closed = o.closed;
    shape.contours.push_back(vertices(line_of(stroke, o), o, fades));
    shapes.push_back(std::move(shape));
  }
  return {shapes, profile, o.height, coverage};
}

FieldCoverage wanted(MaskSpan coverage) {
  return coverage.empty() ? FieldCoverage::None : FieldCoverage::Band;
}

int grid(const PenOptions& o) { return o.width < narrow_width ? narrow_grid : 1; }

}  // namespace

Rect pen(SlopeSpan details, MaskSpan coverage, Rect region, std::span<const Stroke> strokes,
         const PenOptions& options) {
  const PolylineField field = make_field(strokes, options, wanted(coverage));
  region = intersect(region, details.rect());
  field.render(region, grid(options), [&](const Rect& pixels, int x, int y, const FieldCell& cell) {
    write_cell(pixels, x, y, cell, details, coverage);
  });
  return intersect(region, field.bounds());
}

void redraw_pen(SlopeSpan details, MaskSpan coverage, std::span<const Stroke> before,
                std::span<const Stroke> strokes, const PenOptions& options, PixelBlocks& drawn) {
  static_assert(PixelBlocks::side == cell_side);
  const PolylineField field = make_field(strokes, options, wanted(coverage));
  field.render_changes(make_field(before, options, FieldCoverage::None), drawn.region(),
                       grid(options), [&](const Rect& pixels, int x, int y, const FieldCell& cell) {
                         write_cell(pixels, x, y, cell, details, coverage);
                         drawn.mark(x / cell_side, y / cell_side);
                       });
}

Rect pen_height(MaskSpan height, Rect region, std::span<const Stroke> strokes,
                const PenOptions& options) {
  const PolylineField field = make_field(strokes, options, FieldCoverage::None);
  region = intersect(region, height.rect());
  field.render(region, grid(options), [&](const Rect& pixels, int x, int y, const FieldCell& cell) {
    for (int j = pixels.y0; j < pixels.y1; ++j) {
      const float* row = &cell.height[static_cast<std::size_t>((j - y) * cell_side)];
      std::copy(row + (pixels.x0 - x), row + (pixels.x1 - x), height.row(j) + pixels.x0);
    }
  });
  return intersect(region, field.bounds());
}

int reach(const PenOptions& options) {
  return static_cast<int>(std::ceil(std::min(0.5F * options.width, 1e6F))) + 1;
}

Stroke smooth_stroke(const Stroke& stroke, float spacing, StrokeEnds ends) {
  if (!(spacing > 0.0F)) throw InvalidInput("smooth_stroke: spacing must be greater than 0");
  Stroke p = without_repeats(stroke, ends);
  const bool closed = ends == StrokeEnds::Closed && p.size() > 2;
  if (p.size() < 2) return p;
  const auto count = static_cast<std::ptrdiff_t>(p.size());
  const auto at = [&](std::ptrdiff_t i) -> Vec2f {
    if (closed) return p[static_cast<std::size_t>((i + count) % count)].position;
    if (i < 0) return 2.0F * p[0].position - p[1].position;
    if (i >= count) return 2.0F * p.back().position - p[p.size() - 2].position;
    return p[static_cast<std::size_t>(i)].position;
  };
  const auto pressure = [&](std::ptrdiff_t i) {
    i = closed ? (i + count) % count : std::clamp<std::ptrdiff_t>(i, 0, count - 1);
    return p[static_cast<std::size_t>(i)].pressure;
  };
  Stroke out;
  for (std::ptrdiff_t i = 0; i + (closed ? 0 : 1) < count; ++i) {
    const std::array<Vec2f, 4> q = {at(i - 1), at(i), at(i + 1), at(i + 2)};
    std::array<float, 4> knots = {0.0F, 0.0F, 0.0F, 0.0F};
    for (std::size_t k = 1; k < 4; ++k) {
      knots[k] = knots[k - 1] + std::sqrt((q[k] - q[k - 1]).norm());
    }
    const std::array<float, 4> force = {pressure(i - 1), pressure(i), pressure(i + 1),
                                        pressure(i + 2)};
    const int steps = pieces(1.2F * (q[2] - q[1]).norm(), spacing);
    for (int k = 0; k < steps; ++k) {
      const float t = static_cast<float>(k) / static_cast<float>(steps);
      out.push_back({k == 0 ? q[1] : catmull_rom(q, knots, knots[1] + t * (knots[2] - knots[1])),
                     catmull_rom(force, t)});
    }
  }
  if (!closed) out.push_back(p.back());
  return out;
}

}  // namespace normalshop
