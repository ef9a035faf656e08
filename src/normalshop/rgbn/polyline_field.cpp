#include "normalshop/rgbn/detail/polyline_field.h"

#include <algorithm>
#include <cmath>

namespace normalshop {

namespace {

/// Nearer to the line than this, its own orientation says where inside is.
constexpr float touching = 1e-3F;
constexpr float touching_bent = 0.5F;  // inside is told by straight lines

/// Where its |height| is larger a sample counts.
void add_at(const FieldSample& sample, std::size_t k, FieldCell& field) {
  field.coverage[k] = std::max(field.coverage[k], sample.coverage);
  if (!(std::abs(sample.height) > std::abs(field.height[k]))) return;
  field.height[k] = sample.height;
  field.slope_x[k] = sample.slope.x();
  field.slope_y[k] = sample.slope.y();
}

void clear(FieldCell& cell) {
  cell.height.fill(0.0F);
  cell.slope_x.fill(0.0F);
  cell.slope_y.fill(0.0F);
  cell.coverage.fill(0.0F);
}

void add_to(FieldCell& sum, const FieldCell& samples) {
  for (std::size_t k = 0; k < sum.height.size(); ++k) {
    sum.height[k] += samples.height[k];
    sum.slope_x[k] += samples.slope_x[k];
    sum.slope_y[k] += samples.slope_y[k];
    sum.coverage[k] += samples.coverage[k];
  }
}

void multiply(FieldCell& cell, float factor) {
  for (std::size_t k = 0; k < cell.height.size(); ++k) {
    cell.height[k] *= factor;
    cell.slope_x[k] *= factor;
    cell.slope_y[k] *= factor;
    cell.coverage[k] *= factor;
  }
}

/// Points of the cell that begins at (x, y), so far off the centres of its pixels.
void place(int x, int y, float dx, float dy, LinePoints& points) {
  std::size_t k = 0;
  for (int j = 0; j < cell_side; ++j) {
    for (int i = 0; i < cell_side; ++i, ++k) {
      points.x[k] = static_cast<float>(x + i) + dx;
      points.y[k] = static_cast<float>(y + j) + dy;
    }
  }
}

Vec2f point_at(const LinePoints& points, std::size_t k) { return {points.x[k], points.y[k]}; }

}  // namespace

void PolylineField::look_at(Cell& cell) const {
  const auto even = [&](std::uint32_t i) { return segments_[i].even; };
  const auto bends = [&](std::uint32_t i) { return segments_[i].bends(); };
  cell.even = !pattern_ && std::all_of(cell.segments.begin(), cell.segments.end(), even);
  cell.bends = std::any_of(cell.segments.begin(), cell.segments.end(), bends);
}

/// Of the cell that begins at (x, y).
void PolylineField::pixels(int x, int y, const Cell& cell, int grid, FieldCell& out) const {
  LinePoints points;
  if (grid == 1) {
    place(x, y, 0.0F, 0.0F, points);
    return sample(points, cell, out);
  }
  FieldCell samples;
  clear(out);
  for (int j = 0; j < grid; ++j) {
    for (int i = 0; i < grid; ++i) {
      const float dx = (static_cast<float>(i) + 0.5F) / static_cast<float>(grid) - 0.5F;
      const float dy = (static_cast<float>(j) + 0.5F) / static_cast<float>(grid) - 0.5F;
      place(x, y, dx, dy, points);
      sample(points, cell, samples);
      add_to(out, samples);
    }
  }
  multiply(out, 1.0F / static_cast<float>(grid * grid));
}

/// The shape with the largest |height| counts.
void PolylineField::sample(const LinePoints& points, const Cell& cell, FieldCell& field) const {
  clear(field);
  const bool has_level = profile_.level() != 0.0F || coverage_ == FieldCoverage::Inside;
  const List& segments = cell.segments;
  std::size_t at = 0;
  for (std::size_t i = 0; i < shapes_.size(); ++i) {
    if (at < segments.size() && segments_[segments[at]].shape == i) {
      const std::size_t first = at;
      while (at < segments.size() && segments_[segments[at]].shape == i) ++at;
      const auto list = std::span(segments).subspan(first, at - first);
      add_beside(points, shapes_[i], {list, shapes_[i].largest_half_width, cell.even, cell.bends},
                 field);
    } else if (has_level) {
      for (std::size_t k = 0; k < points.x.size(); ++k) {
        add_at(level(point_at(points, k), shapes_[i]), k, field);
      }
    } else if (at == segments.size()) {
      break;
    } else {
      i = segments_[segments[at]].shape - 1;
    }
  }
}

FieldSample PolylineField::level(const Vec2f& p, const Shape& shape) const {
  FieldSample s;
  if (!shape.closed || !inside(p, shape)) return s;
  s.height = height_ * profile_.level();
  s.coverage = coverage_ == FieldCoverage::Inside ? 1.0F : 0.0F;
  return s;
}

void PolylineField::add_beside(const LinePoints& points, const Shape& shape, const LineList& list,
                               FieldCell& field) const {
  LinePlaces places;
  line_places(columns_, list, points, places);
  if (shape.closed) turn_in(points, shape, places);
  if (!pattern_) add_line(columns_, {profile_, height_, coverage_}, list.even, places, field);
  for (std::size_t k = 0; (pattern_ || shape.closed) && k < places.place.size(); ++k) {
    if (pattern_ && places.place[k] == line_beside) add_at(patterned(shape, places, k), k, field);
    if (places.place[k] == line_beyond) add_at(level(point_at(points, k), shape), k, field);
  }
}

/// A closed shape's sides are inside and outside.
void PolylineField::turn_in(const LinePoints& points, const Shape& shape,
                            LinePlaces& places) const {
  for (std::size_t k = 0; k < places.place.size(); ++k) {
    if (places.place[k] != line_beside) continue;
    const bool touches =
        places.distance[k] < (segment_of(places, k).bends() ? touching_bent : touching);
    places.side[k] = touches                              ? places.side[k] * shape.orientation
                     : inside(point_at(points, k), shape) ? 1.0F
                                                          : -1.0F;
  }
}

FieldSample PolylineField::patterned(const Shape& shape, const LinePlaces& places,
                                     std::size_t k) const {
  const LineSegment& s = segment_of(places, k);
  const float half_width = places.half_width[k];
  const float u = places.side[k] * places.distance[k] / half_width;
  const Vec2f away(places.x[k], places.y[k]);
  // Widths change along the line, too, and not along its picture.
  return pattern_({u, s.start + places.at[k] * s.rate, shape.length, half_width,
                   s.half_width_rate / s.rate, places.side[k] * away,
                   s.rate * Vec2f(places.along_x[k], places.along_y[k])});
}

bool PolylineField::inside(const Vec2f& p, const Shape& shape) const {
  const float band = std::floor((p.y() - shape.top) / band_rows);
  if (!(band >= 0.0F) || band >= static_cast<float>(shape.bands.size())) return false;
  int winding = 0;
  for (const std::uint32_t i : shape.bands[static_cast<std::size_t>(band)]) {
    const LineSegment& s = segments_[i];
    const Vec2f& a = s.a;
    const Vec2f& b = s.b;
    if ((a.y() <= p.y()) == (b.y() <= p.y())) continue;
    const bool left = (cross(s.direction, p - a) > 0.0F) == (b.y() > a.y());
    if (left) winding += b.y() > a.y() ? 1 : -1;
  }
  return winding != 0;
}

}  // namespace normalshop
