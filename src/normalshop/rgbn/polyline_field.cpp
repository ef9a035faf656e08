#include "normalshop/rgbn/polyline_field.h"

#include <cmath>
#include <limits>

#include "normalshop/core/parallel.h"
#include "normalshop/core/sample.h"

namespace normalshop {

namespace {

constexpr int tile_size = 64;
constexpr int cell_size = 8;
/// Rows that share a list of the segments that may cross them.
constexpr float band_rows = 8.0F;
/// Nearer to the line than this, its own orientation says where inside is.
constexpr float on_line = 1e-3F;

float cross(const Vec2f& a, const Vec2f& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Left as seen, although y runs down.
Vec2f left_of(const Vec2f& direction) { return {direction.y(), -direction.x()}; }

int clamped_int(float x, int low, int high) {
  return static_cast<int>(
      std::clamp(x, static_cast<float>(low), static_cast<float>(std::max(low, high))));
}

}  // namespace

struct PolylineField::Segment {
  Vec2f a, b;
  Vec2f direction;
  float length;
  float half_width, half_width_rate;
  float fade, fade_rate;
  Vec2f start_tangent, end_tangent;  ///< mean direction at the joints
  bool start_cap = false;
  bool end_cap = false;
  std::uint32_t shape = 0;
  std::ptrdiff_t previous = 0;  ///< from this to its neighbours in the list of segments
  std::ptrdiff_t next = 0;
};

struct PolylineField::Shape {
  bool closed = false;
  float largest_half_width = 0.0F;
  float orientation = 1.0F;  ///< 1: inside is to the left
  float top = 0.0F;
  std::vector<List> bands;  ///< of segments by rows, for winding numbers
};

struct PolylineField::Nearest {
  const Segment* segment = nullptr;
  float along = 0.0F;
  Vec2f offset = Vec2f::Zero();
  float squared = std::numeric_limits<float>::infinity();

  float half_width() const { return segment->half_width + along * segment->half_width_rate; }
  float fade() const { return segment->fade + along * segment->fade_rate; }
};

struct PolylineField::Along {
  const Segment* segment;
  float at;
  Vec2f gradient;

  float half_width() const { return segment->half_width + at * segment->half_width_rate; }
  float fade() const { return segment->fade + at * segment->fade_rate; }
};

PolylineField::PolylineField(const std::vector<FieldShape>& shapes, const Profile& profile,
                             float height, FieldCoverage coverage)
    : profile_(profile), height_(height), coverage_(coverage) {
  for (const FieldShape& shape : shapes) add(shape);
}

PolylineField::~PolylineField() = default;

void PolylineField::add(const FieldShape& source) {
  const std::size_t first = segments_.size();
  shapes_.emplace_back();
  shapes_.back().closed = source.closed;
  for (const auto& contour : source.contours) add_contour(contour, source.closed);
  Shape& shape = shapes_.back();
  double area = 0.0;
  float bottom = -std::numeric_limits<float>::infinity();
  shape.top = std::numeric_limits<float>::infinity();
  for (std::size_t i = first; i < segments_.size(); ++i) {
    const Segment& s = segments_[i];
    const float end_width = s.half_width + s.length * s.half_width_rate;
    shape.largest_half_width = std::max({shape.largest_half_width, s.half_width, end_width});
    shape.top = std::min({shape.top, s.a.y(), s.b.y()});
    bottom = std::max({bottom, s.a.y(), s.b.y()});
    const Vec2f from = s.a - segments_[first].a;
    const Vec2f to = s.b - segments_[first].a;
    area += static_cast<double>(cross(from, to));
  }
  for (std::size_t i = first; i < segments_.size(); ++i) {
    grow_bounds(segments_[i], shape.largest_half_width);
  }
  if (!shape.closed || first == segments_.size()) return;
  // With y down, a positive sum means clockwise as seen: inside is to the right.
  shape.orientation = area > 0.0 ? -1.0F : 1.0F;
  const int bands = 1 + clamped_int((bottom - shape.top) / band_rows, 0, 1 << 20);
  shape.bands.resize(static_cast<std::size_t>(bands));
  for (std::size_t i = first; i < segments_.size(); ++i) {
    const float y0 = std::min(segments_[i].a.y(), segments_[i].b.y());
    const float y1 = std::max(segments_[i].a.y(), segments_[i].b.y());
    const int b0 = clamped_int(std::floor((y0 - 0.01F - shape.top) / band_rows), 0, bands - 1);
    const int b1 = clamped_int(std::floor((y1 + 0.01F - shape.top) / band_rows), 0, bands - 1);
    for (int b = b0; b <= b1; ++b) {
      shape.bands[static_cast<std::size_t>(b)].push_back(static_cast<std::uint32_t>(i));
    }
  }
}

void PolylineField::add_contour(const std::vector<FieldVertex>& contour, bool closed) {
  std::vector<FieldVertex> v;
  for (const FieldVertex& vertex : contour) {
    if (v.empty() || (vertex.position - v.back().position).norm() > 1e-4F) v.push_back(vertex);
  }
  while (closed && v.size() > 1 && (v.front().position - v.back().position).norm() <= 1e-4F) {
    v.pop_back();
  }
  if (v.empty()) return;
  const bool ring = closed && v.size() > 1;
  const std::size_t count = ring ? v.size() : std::max<std::size_t>(1, v.size() - 1);
  const std::size_t first = segments_.size();
  for (std::size_t i = 0; i < count; ++i) {
    const FieldVertex& a = v[i];
    const FieldVertex& b = v[(i + 1) % v.size()];
    Segment s{};
    s.a = a.position;
    s.b = b.position;
    s.length = (b.position - a.position).norm();
    s.direction = s.length > 0.0F ? Vec2f((b.position - a.position) / s.length) : Vec2f(1.0F, 0.0F);
    s.half_width = a.half_width;
    s.fade = a.fade;
    if (s.length > 0.0F) {
      s.half_width_rate = (b.half_width - a.half_width) / s.length;
      s.fade_rate = (b.fade - a.fade) / s.length;
    }
    s.start_tangent = s.end_tangent = s.direction;
    s.shape = static_cast<std::uint32_t>(shapes_.size() - 1);
    segments_.push_back(s);
  }
  for (std::size_t i = 0; i < count; ++i) {
    Segment& s = segments_[first + i];
    Segment& next = segments_[first + (i + 1) % count];
    s.end_cap = !ring && i + 1 == count;
    s.next = s.end_cap
                 ? 0
                 : static_cast<std::ptrdiff_t>((i + 1) % count) - static_cast<std::ptrdiff_t>(i);
    next.previous = s.end_cap ? next.previous : -s.next;
    if (i == 0) s.start_cap = !ring;
    if (s.end_cap) continue;
    const Vec2f mean = 0.5F * (s.direction + next.direction);
    // At a hairpin there is no mean direction: both keep their own.
    if (mean.norm() > 0.1F) s.end_tangent = next.start_tangent = mean.normalized();
  }
}

void PolylineField::grow_bounds(const Segment& s, float half_width) {
  const float margin = half_width + 1.0F;
  constexpr int limit = 1 << 24;
  const Vec2f low = s.a.cwiseMin(s.b).array() - margin;
  const Vec2f high = s.a.cwiseMax(s.b).array() + margin;
  bounds_ = unite(bounds_, {clamped_int(std::floor(low.x()), -limit, limit),
                            clamped_int(std::floor(low.y()), -limit, limit),
                            clamped_int(std::ceil(high.x()), -limit, limit) + 1,
                            clamped_int(std::ceil(high.y()), -limit, limit) + 1});
}

/// The segments that may matter in each tile of a region, in order.
struct PolylineField::Bins {
  int columns = 0;
  std::vector<List> tiles;
};

PolylineField::Bins PolylineField::bin(const Rect& region) const {
  Bins bins;
  bins.columns = (region.width() + tile_size - 1) / tile_size;
  const int rows = (region.height() + tile_size - 1) / tile_size;
  bins.tiles.resize(static_cast<std::size_t>(bins.columns) * static_cast<std::size_t>(rows));
  const Vec2f origin(static_cast<float>(region.x0), static_cast<float>(region.y0));
  constexpr float size = tile_size;
  const float radius = 0.5F * size * std::sqrt(2.0F);
  for (std::size_t i = 0; i < segments_.size(); ++i) {
    const Segment& s = segments_[i];
    const float width = shapes_[s.shape].largest_half_width + 1.0F;
    const Vec2f low = (s.a.cwiseMin(s.b).array() - width - origin.array()) / size;
    const Vec2f high = (s.a.cwiseMax(s.b).array() + width - origin.array()) / size;
    if (high.x() < 0.0F || high.y() < 0.0F) continue;
    const int x1 = clamped_int(high.x(), 0, bins.columns - 1);
    const int y1 = clamped_int(high.y(), 0, rows - 1);
    for (int y = clamped_int(std::floor(low.y()), 0, rows); y <= y1; ++y) {
      for (int x = clamped_int(std::floor(low.x()), 0, bins.columns); x <= x1; ++x) {
        const Vec2f center =
            origin + size * Vec2f(static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F);
        const float along = std::clamp((center - s.a).dot(s.direction), 0.0F, s.length);
        if ((center - s.a - along * s.direction).norm() > radius + width + 1.0F) continue;
        bins.tiles[static_cast<std::size_t>(y * bins.columns + x)].push_back(
            static_cast<std::uint32_t>(i));
      }
    }
  }
  return bins;
}

void PolylineField::render(const Rect& region, int grid, const Write& write) const {
  if (region.empty()) return;
  const Bins bins = bin(region);
  parallel_for(bins.tiles.size(), 1, [&](std::size_t a, std::size_t b) {
    for (std::size_t i = a; i < b; ++i) {
      const int x = region.x0 + static_cast<int>(i) % bins.columns * tile_size;
      const int y = region.y0 + static_cast<int>(i) / bins.columns * tile_size;
      render_tile(intersect({x, y, x + tile_size, y + tile_size}, region), bins.tiles[i], grid,
                  write);
    }
  });
}

void PolylineField::render_tile(const Rect& tile, const List& segments, int grid,
                                const Write& write) const {
  std::vector<FieldSample> row(static_cast<std::size_t>(tile.width()));
  if (segments.empty()) {
    // No line comes near: one value for the whole tile.
    const Vec2f p(static_cast<float>(tile.x0), static_cast<float>(tile.y0));
    std::fill(row.begin(), row.end(), sample(p, segments));
    for (int y = tile.y0; y < tile.y1; ++y) write(tile.x0, y, row);
    return;
  }
  const float radius = 0.5F * cell_size * std::sqrt(2.0F) + 0.5F;
  std::vector<List> cells(static_cast<std::size_t>((tile.width() + cell_size - 1) / cell_size));
  const float scale = 1.0F / static_cast<float>(grid * grid);
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int x = tile.x0; x < tile.x1; ++x) {
      List& cell = cells[static_cast<std::size_t>((x - tile.x0) / cell_size)];
      if ((y - tile.y0) % cell_size == 0 && (x - tile.x0) % cell_size == 0) {
        const Vec2f center(static_cast<float>(x) + 0.5F * (cell_size - 1),
                           static_cast<float>(y) + 0.5F * (cell_size - 1));
        prune(segments, center, radius, cell);
      }
      FieldSample sum;
      for (int j = 0; j < grid; ++j) {
        for (int i = 0; i < grid; ++i) {
          const float dx = (static_cast<float>(i) + 0.5F) / static_cast<float>(grid) - 0.5F;
          const float dy = (static_cast<float>(j) + 0.5F) / static_cast<float>(grid) - 0.5F;
          const FieldSample s =
              sample({static_cast<float>(x) + dx, static_cast<float>(y) + dy}, cell);
          sum.height += s.height;
          sum.slope += s.slope;
          sum.coverage += s.coverage;
        }
      }
      if (grid > 1) {
        sum.height *= scale;
        sum.slope *= scale;
        sum.coverage *= scale;
      }
      row[static_cast<std::size_t>(x - tile.x0)] = sum;
    }
    write(tile.x0, y, row);
  }
}

/// Keeps, of each shape, what can be the nearest segment anywhere within `radius` of `center`.
void PolylineField::prune(const List& segments, const Vec2f& center, float radius,
                          List& kept) const {
  kept.clear();
  const auto distance = [&](const Segment& s) {
    const float along = std::clamp((center - s.a).dot(s.direction), 0.0F, s.length);
    return (center - s.a - along * s.direction).norm();
  };
  for (std::size_t i = 0; i < segments.size();) {
    const std::uint32_t shape = segments_[segments[i]].shape;
    std::size_t end = i;
    float least = std::numeric_limits<float>::infinity();
    for (; end < segments.size() && segments_[segments[end]].shape == shape; ++end) {
      least = std::min(least, distance(segments_[segments[end]]));
    }
    const bool touched = least <= shapes_[shape].largest_half_width + radius;
    for (; i < end; ++i) {
      if (touched && distance(segments_[segments[i]]) <= least + 2.0F * radius + 0.01F) {
        kept.push_back(segments[i]);
      }
    }
  }
}

/// Nearest segment of the shape that `at` points into; moves `at` behind that shape.
PolylineField::Nearest PolylineField::nearest(const Vec2f& p, const List& segments,
                                              std::size_t& at) const {
  Nearest best;
  const std::uint32_t shape = segments_[segments[at]].shape;
  for (; at < segments.size() && segments_[segments[at]].shape == shape; ++at) {
    const Segment& s = segments_[segments[at]];
    const float along = std::clamp((p - s.a).dot(s.direction), 0.0F, s.length);
    const Vec2f offset = p - s.a - along * s.direction;
    const float squared = offset.squaredNorm();
    if (squared < best.squared) best = {&s, along, offset, squared};
  }
  return best;
}

/// The shape with the largest |height| counts.
FieldSample PolylineField::sample(const Vec2f& p, const List& segments) const {
  FieldSample best;
  float coverage = 0.0F;
  const auto take = [&](const FieldSample& s) {
    coverage = std::max(coverage, s.coverage);
    if (std::abs(s.height) > std::abs(best.height)) best = s;
  };
  const bool has_level = profile_.level() != 0.0F || coverage_ == FieldCoverage::Inside;
  std::size_t at = 0;
  for (std::size_t i = 0; i < shapes_.size(); ++i) {
    if (at < segments.size() && segments_[segments[at]].shape == i) {
      take(beside(p, shapes_[i], nearest(p, segments, at)));
    } else if (has_level) {
      take(level(p, shapes_[i]));
    } else if (at == segments.size()) {
      break;
    } else {
      i = segments_[segments[at]].shape - 1;
    }
  }
  best.coverage = coverage;
  return best;
}

/// Arc length with directions that turn evenly along each segment instead of at its ends: the s
/// with (p - q(s)) . t(s) = 0. It is continuous beside a bend, where the nearest point jumps in
/// speed.
PolylineField::Along PolylineField::along(const Vec2f& p, const Nearest& near) {
  const Segment* s = near.segment;
  const bool after = near.along >= s->length && near.offset.dot(s->end_tangent) > 0.0F;
  const bool before = near.along <= 0.0F && near.offset.dot(s->start_tangent) < 0.0F;
  if (after) s += s->next;
  if (before) s += s->previous;
  const Vec2f from_start = p - s->a;
  const Vec2f turn = (s->end_tangent - s->start_tangent) / std::max(s->length, 1e-6F);
  const float linear = from_start.dot(turn) - s->direction.dot(s->start_tangent);
  const float square = -s->direction.dot(turn);
  float at = std::clamp(from_start.dot(s->direction), 0.0F, s->length);
  float slope = linear;
  for (int i = 0; i < 4; ++i) {
    slope = std::min(linear + 2.0F * at * square, -0.2F);  // the centre of the bend is singular
    const float value = from_start.dot(s->start_tangent) + at * (linear + at * square);
    at = std::clamp(at - value / slope, 0.0F, s->length);
  }
  return {s, at, (s->start_tangent + at * turn) / -slope};
}

FieldSample PolylineField::level(const Vec2f& p, const Shape& shape) const {
  FieldSample s;
  if (!shape.closed || !inside(p, shape)) return s;
  s.height = height_ * profile_.level();
  s.coverage = coverage_ == FieldCoverage::Inside ? 1.0F : 0.0F;
  return s;
}

FieldSample PolylineField::beside(const Vec2f& p, const Shape& shape, const Nearest& near) const {
  const float distance = std::sqrt(near.squared);
  if (!(distance < shape.largest_half_width)) return level(p, shape);
  const Segment& s = *near.segment;
  const bool at_start = near.along <= 0.0F;
  const bool at_end = near.along >= s.length;
  if ((at_start && s.start_cap) || (at_end && s.end_cap)) return cap(near);
  const Along v = along(p, near);
  const float half_width = v.half_width();
  if (!(distance < half_width) || half_width < 1e-6F) return level(p, shape);
  const bool joint = at_start || at_end;
  const Vec2f& tangent = at_start ? s.start_tangent : at_end ? s.end_tangent : s.direction;
  float side = near.offset.dot(left_of(tangent)) < 0.0F ? -1.0F : 1.0F;
  const Vec2f away =
      joint && distance > 0.0F ? Vec2f(near.offset / distance) : Vec2f(side * left_of(tangent));
  if (shape.closed) {
    side = distance < on_line ? side * shape.orientation : inside(p, shape) ? 1.0F : -1.0F;
  }
  const float u = side * distance / half_width;
  const Profile::Value h = profile_.at(u);
  const float amplitude = height_ * v.fade();
  const float along_rate = height_ * v.segment->fade_rate * h.height -
                           amplitude * h.slope * u * v.segment->half_width_rate / half_width;
  const Vec2f gradient = amplitude * h.slope / half_width * side * away + along_rate * v.gradient;
  return {amplitude * h.height, {gradient.x(), -gradient.y()}, coverage(u, v.fade())};
}

/// Round end of an open line: the odd part of the profile turns over smoothly from one side to the
/// other, h = even(d) + sin(angle) odd(d).
FieldSample PolylineField::cap(const Nearest& near) const {
  const float half_width = near.half_width();
  const float distance = std::sqrt(near.squared);
  if (!(distance < half_width) || half_width < 1e-6F) return {};
  const float u = distance / half_width;
  const Profile::Value l = profile_.at(u);
  const Profile::Value r = profile_.at(-u);
  const float even = 0.5F * (l.height + r.height);
  const float odd = 0.5F * (l.height - r.height);
  const float even_slope = 0.5F * (l.slope - r.slope);
  const float odd_slope = 0.5F * (l.slope + r.slope);
  const Vec2f left = left_of(near.segment->direction);
  const float amplitude = height_ * near.fade();
  Vec2f gradient = odd_slope / half_width * left;
  float sine = 0.0F;
  if (distance > 1e-5F) {
    const Vec2f away = near.offset / distance;
    sine = away.dot(left);
    gradient =
        (even_slope + sine * odd_slope) / half_width * away + odd / distance * (left - sine * away);
  }
  gradient *= amplitude;
  return {amplitude * (even + sine * odd), {gradient.x(), -gradient.y()}, coverage(u, near.fade())};
}

float PolylineField::coverage(float u, float fade) const {
  if (coverage_ == FieldCoverage::Inside) return smoothstep(-1.0F, 0.0F, u);
  return fade * (1.0F - smoothstep(0.7F, 1.0F, std::abs(u)));
}

bool PolylineField::inside(const Vec2f& p, const Shape& shape) const {
  const float band = std::floor((p.y() - shape.top) / band_rows);
  if (!(band >= 0.0F) || band >= static_cast<float>(shape.bands.size())) return false;
  int winding = 0;
  for (const std::uint32_t i : shape.bands[static_cast<std::size_t>(band)]) {
    const Segment& s = segments_[i];
    const Vec2f& a = s.a;
    const Vec2f& b = s.b;
    if ((a.y() <= p.y()) == (b.y() <= p.y())) continue;
    const bool left = (cross(s.direction, p - a) > 0.0F) == (b.y() > a.y());
    if (left) winding += b.y() > a.y() ? 1 : -1;
  }
  return winding != 0;
}

}  // namespace normalshop
