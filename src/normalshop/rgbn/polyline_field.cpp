#include "normalshop/rgbn/detail/polyline_field.h"

#include <cmath>
#include <limits>

#include "normalshop/core/parallel.h"
#include "normalshop/core/sample.h"

namespace normalshop {

namespace {

constexpr int cell_size = PlainPlaces::count;
/// Cells of cells.
constexpr int block_size = 32;
/// Nearer to the line than this, its own orientation says where inside is.
constexpr float touching = 1e-3F;
/// Slope jumps are spread over this many pixels on each side, but not over more of the profile.
constexpr float jump_radius = 1.5F;
constexpr float largest_jump_share = 0.25F;

float jump_share(float half_width) {
  return std::min(jump_radius / half_width, largest_jump_share);
}

/// Left as seen, although y runs down.
Vec2f left_of(const Vec2f& direction) { return {direction.y(), -direction.x()}; }

}  // namespace

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
  const auto columns = [&](int size) {
    return static_cast<std::size_t>((tile.width() + size - 1) / size);
  };
  std::vector<List> blocks(columns(block_size));
  std::vector<Cell> cells(columns(cell_size));
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int x = tile.x0; x < tile.x1; x += cell_size) {
      const auto starts = [&](int size) {
        return (x - tile.x0) % size == 0 && (y - tile.y0) % size == 0;
      };
      const auto square = [&](int size) { return Rect{x, y, x + size, y + size}; };
      List& block = blocks[static_cast<std::size_t>((x - tile.x0) / block_size)];
      Cell& cell = cells[static_cast<std::size_t>((x - tile.x0) / cell_size)];
      if (starts(block_size)) prune(segments, square(block_size), block);
      if (starts(cell_size)) {
        prune(block, square(cell_size), cell.segments);
        find_plain(grid, cell);
      }
      const int count = std::min(cell_size, tile.x1 - x);
      const std::span<FieldSample> out(row.data() + (x - tile.x0), static_cast<std::size_t>(count));
      if (!cell.plain.empty()) {
        plain_row(x, y, cell, out);
        continue;
      }
      for (int i = 0; i < count; ++i) {
        out[static_cast<std::size_t>(i)] = pixel(x + i, y, cell.segments, grid);
      }
    }
    write(tile.x0, y, row);
  }
}

FieldSample PolylineField::pixel(int x, int y, const List& segments, int grid) const {
  FieldSample sum;
  for (int j = 0; j < grid; ++j) {
    for (int i = 0; i < grid; ++i) {
      const float dx = (static_cast<float>(i) + 0.5F) / static_cast<float>(grid) - 0.5F;
      const float dy = (static_cast<float>(j) + 0.5F) / static_cast<float>(grid) - 0.5F;
      const FieldSample s =
          sample({static_cast<float>(x) + dx, static_cast<float>(y) + dy}, segments);
      sum.height += s.height;
      sum.slope += s.slope;
      sum.coverage += s.coverage;
    }
  }
  if (grid == 1) return sum;
  const float scale = 1.0F / static_cast<float>(grid * grid);
  return {sum.height * scale, sum.slope * scale, sum.coverage * scale};
}

void PolylineField::find_plain(int grid, Cell& cell) const {
  cell.plain.clear();
  const bool has_level = profile_.level() != 0.0F || coverage_ == FieldCoverage::Inside;
  if (grid > 1 || pattern_ || has_level || cell.segments.empty()) return;
  const Segment& first = segments_[cell.segments.front()];
  if (shapes_[first.shape].closed || first.half_width < 1e-6F) return;
  for (const std::uint32_t i : cell.segments) {
    const Segment& s = segments_[i];
    if (s.shape != first.shape || !s.even || s.start_cap || s.end_cap ||
        s.half_width != first.half_width || s.fade != first.fade) {
      cell.plain.clear();
      return;
    }
    cell.plain.push_back({s.a.x(), s.a.y(), s.direction.x(), s.direction.y(), s.length,
                          s.start_tangent.x(), s.start_tangent.y(), s.end_tangent.x(),
                          s.end_tangent.y()});
  }
}

/// As pixel() does it.
void PolylineField::plain_row(int x, int y, const Cell& cell, std::span<FieldSample> row) const {
  const Segment& s = segments_[cell.segments.front()];
  PlainPlaces places;
  plain_places(cell.plain, s.half_width, static_cast<float>(x), static_cast<float>(y), places);
  for (std::size_t i = 0; i < row.size(); ++i) {
    row[i] = {};
    if (places.u[i] > 1.0F) continue;
    row[i] = across(places.u[i], {places.x[i], places.y[i]}, s);
    if (row[i].height == 0.0F) row[i].slope = Vec2f::Zero();
  }
}

/// Keeps, of each shape, what can be the nearest segment anywhere in the cell. The gradient of a
/// distance d to a segment turns by at most 1 / d a pixel: seen from afar, the difference of two
/// distances changes little within the cell.
void PolylineField::prune(const List& segments, const Rect& cell, List& kept) const {
  kept.clear();
  const Vec2f center(0.5F * static_cast<float>(cell.x0 + cell.x1 - 1),
                     0.5F * static_cast<float>(cell.y0 + cell.y1 - 1));
  const float radius = 0.5F * static_cast<float>(cell.width()) * std::sqrt(2.0F) + 0.5F;
  const auto offset = [&](const Segment& s) -> Vec2f {
    const float along = std::clamp((center - s.a).dot(s.direction), 0.0F, s.length);
    return center - s.a - along * s.direction;
  };
  for (std::size_t i = 0; i < segments.size();) {
    const std::uint32_t shape = segments_[segments[i]].shape;
    std::size_t end = i;
    Vec2f closest = Vec2f::Zero();
    float squared = std::numeric_limits<float>::infinity();
    for (; end < segments.size() && segments_[segments[end]].shape == shape; ++end) {
      const Vec2f o = offset(segments_[segments[end]]);
      if (o.squaredNorm() < squared) {
        squared = o.squaredNorm();
        closest = o;
      }
    }
    const float least = std::sqrt(squared);
    const bool touched = least <= shapes_[shape].largest_half_width + radius;
    const float turn = least > 2.0F * radius ? radius / (least - radius) : 2.0F;
    const Vec2f away = closest / std::max(least, 1e-6F);
    const float farthest = least + 2.0F * radius + 0.01F;
    for (; touched && i < end; ++i) {
      const Vec2f o = offset(segments_[segments[i]]);
      const float other = o.squaredNorm();
      if (other > farthest * farthest) continue;
      const float distance = std::sqrt(other);
      const float change = (o / std::max(distance, 1e-6F) - away).norm() + turn;
      if (distance <= least + std::min(change, 2.0F) * radius + 0.01F) kept.push_back(segments[i]);
    }
    i = end;
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
  if ((at_start && s.start_cap) || (at_end && s.end_cap)) {
    return pattern_ ? FieldSample() : cap(near);
  }
  // Where along an even line doesn't matter, unless there is a pattern.
  const Along v = s.even && !pattern_ ? Along{&s, 0.0F, Vec2f::Zero()} : along(p, near);
  const float half_width = v.half_width();
  if (!(distance < half_width) || half_width < 1e-6F) return level(p, shape);
  const bool joint = at_start || at_end;
  const Vec2f& tangent = at_start ? s.start_tangent : at_end ? s.end_tangent : s.direction;
  float side = near.offset.dot(left_of(tangent)) < 0.0F ? -1.0F : 1.0F;
  const Vec2f away =
      joint && distance > 0.0F ? Vec2f(near.offset / distance) : Vec2f(side * left_of(tangent));
  if (shape.closed) {
    side = distance < touching ? side * shape.orientation : inside(p, shape) ? 1.0F : -1.0F;
  }
  const float u = side * distance / half_width;
  if (pattern_) return patterned(shape, u, side * away, v);
  if (s.even) return across(u, side * away, s);
  const Profile::Value h = profile_.at(u, jump_share(half_width));
  const float amplitude = height_ * v.fade();
  const float along_rate = height_ * v.segment->fade_rate * h.height -
                           amplitude * h.slope * u * v.segment->half_width_rate / half_width;
  const Vec2f gradient = amplitude * h.slope / half_width * side * away + along_rate * v.gradient;
  return {amplitude * h.height, {gradient.x(), -gradient.y()}, coverage(u, v.fade())};
}

/// Where nothing changes along the line.
FieldSample PolylineField::across(float u, const Vec2f& gradient, const Segment& s) const {
  const Profile::Value h = profile_.at(u, jump_share(s.half_width));
  const float amplitude = height_ * s.fade;
  const Vec2f slope = amplitude * h.slope / s.half_width * gradient;
  return {amplitude * h.height, {slope.x(), -slope.y()}, coverage(u, s.fade)};
}

FieldSample PolylineField::patterned(const Shape& shape, float u, const Vec2f& away,
                                     const Along& along) const {
  const Segment& s = *along.segment;
  // Widths change along the line, too, and not along its picture.
  return pattern_({u, s.start + along.at * s.rate, shape.length, along.half_width(),
                   s.half_width_rate / s.rate, away, s.rate * along.gradient});
}

/// Round end of an open line: the odd part of the profile turns over smoothly from one side to the
/// other, h = even(d) + sin(angle) odd(d).
FieldSample PolylineField::cap(const Nearest& near) const {
  const float half_width = near.half_width();
  const float distance = std::sqrt(near.squared);
  if (!(distance < half_width) || half_width < 1e-6F) return {};
  const float u = distance / half_width;
  const Profile::Value l = profile_.at(u, jump_share(half_width));
  const Profile::Value r = profile_.at(-u, jump_share(half_width));
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
