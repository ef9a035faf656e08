#include "normalshop/rgbn/detail/polyline_field.h"

#include <algorithm>
#include <cmath>

#include "normalshop/core/parallel.h"
#include "normalshop/core/sample.h"

namespace normalshop {

namespace {

constexpr int cell_size = line_lanes;
/// Cells of cells.
constexpr int block_size = 32;
/// Nearer to the line than this, its own orientation says where inside is.
constexpr float touching = 1e-3F;
constexpr float touching_bent = 0.5F;  // inside is told by straight lines
/// Slope jumps are spread over this many pixels on each side, but not over more of the profile.
constexpr float jump_radius = 1.5F;
constexpr float largest_jump_share = 0.25F;

float jump_share(float half_width) {
  return std::min(jump_radius / half_width, largest_jump_share);
}

struct Circle {
  Vec2f center;
  float radius;
};

/// Around the pixels of a square, and half a pixel more.
Circle circle_around(const Rect& square) {
  return {Vec2f(0.5F * static_cast<float>(square.x0 + square.x1 - 1),
                0.5F * static_cast<float>(square.y0 + square.y1 - 1)),
          0.5F * static_cast<float>(square.width()) * std::sqrt(2.0F) + 0.5F};
}

/// Left as seen, although y runs down.
Vec2f left_of(const Vec2f& direction) { return {direction.y(), -direction.x()}; }

}  // namespace

void PolylineField::render(const Rect& region, int grid, const Write& write) const {
  if (region.empty()) return;
  const int columns = (region.width() + tile_size - 1) / tile_size;
  const int rows = (region.height() + tile_size - 1) / tile_size;
  const auto tiles = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  parallel_for(tiles, 1, [&](std::size_t a, std::size_t b) {
    for (std::size_t i = a; i < b; ++i) {
      const int x = region.x0 + static_cast<int>(i) % columns * tile_size;
      const int y = region.y0 + static_cast<int>(i) / columns * tile_size;
      render_tile(intersect({x, y, x + tile_size, y + tile_size}, region), grid, write);
    }
  });
}

void PolylineField::render_tile(const Rect& tile, int grid, const Write& write) const {
  std::vector<FieldSample> row(static_cast<std::size_t>(tile.width() + cell_size - 1));
  const auto hand_over = [&](int y) {
    write(tile.x0, y, std::span(row).first(static_cast<std::size_t>(tile.width())));
  };
  SegmentOffsets offsets;
  const Rect square_tile{tile.x0, tile.y0, tile.x0 + tile_size, tile.y0 + tile_size};
  List segments;
  prune(near(square_tile), square_tile, offsets, segments);
  if (segments.empty()) {
    // No line comes near: one value for the whole tile.
    const Samples all = pixels(tile.x0, tile.y0, {}, 1);
    std::fill(row.begin(), row.end(), all.front());
    for (int y = tile.y0; y < tile.y1; ++y) hand_over(y);
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
      if (starts(block_size)) prune(segments, square(block_size), offsets, block);
      if (starts(cell_size)) {
        prune(block, square(cell_size), offsets, cell.segments);
        look_at(cell);
      }
      const Samples samples = pixels(x, y, cell, grid);
      std::copy(samples.begin(), samples.end(), row.begin() + (x - tile.x0));
    }
    hand_over(y);
  }
}

void PolylineField::look_at(Cell& cell) const {
  const auto even = [&](std::uint32_t i) { return segments_[i].even; };
  const auto bends = [&](std::uint32_t i) { return segments_[i].bends(); };
  cell.even = !pattern_ && std::all_of(cell.segments.begin(), cell.segments.end(), even);
  cell.bends = std::any_of(cell.segments.begin(), cell.segments.end(), bends);
}

/// Of (x, y), (x + 1, y) ...
PolylineField::Samples PolylineField::pixels(int x, int y, const Cell& cell, int grid) const {
  Samples sum{};
  LinePoints points;
  for (int j = 0; j < grid; ++j) {
    for (int i = 0; i < grid; ++i) {
      const float dx = (static_cast<float>(i) + 0.5F) / static_cast<float>(grid) - 0.5F;
      const float dy = (static_cast<float>(j) + 0.5F) / static_cast<float>(grid) - 0.5F;
      for (int k = 0; k < line_lanes; ++k) {
        points.x[static_cast<std::size_t>(k)] = static_cast<float>(x + k) + dx;
      }
      points.y.fill(static_cast<float>(y) + dy);
      const Samples samples = sample(points, cell);
      for (std::size_t k = 0; k < sum.size(); ++k) {
        sum[k].height += samples[k].height;
        sum[k].slope += samples[k].slope;
        sum[k].coverage += samples[k].coverage;
      }
    }
  }
  if (grid == 1) return sum;
  const float scale = 1.0F / static_cast<float>(grid * grid);
  for (FieldSample& s : sum) s = {s.height * scale, s.slope * scale, s.coverage * scale};
  return sum;
}

/// Those whose chunks may have the nearest segment of their shape anywhere in a square.
PolylineField::List PolylineField::near(const Rect& square) const {
  const auto [center, radius] = circle_around(square);
  List list;
  for (const Shape& shape : shapes_) {
    const auto distance = [&, c = center](const Chunk& chunk) { return (c - chunk.center).norm(); };
    float farthest = shape.largest_half_width + radius;
    for (const Chunk& chunk : shape.chunks) {
      farthest = std::min(farthest, distance(chunk) + chunk.radius + 2.0F * radius + 0.01F);
    }
    for (const Chunk& chunk : shape.chunks) {
      if (distance(chunk) - chunk.radius > farthest) continue;
      for (std::uint32_t i = chunk.first; i < chunk.end; ++i) list.push_back(i);
    }
  }
  return list;
}

/// Keeps, of each shape, what can be the nearest segment anywhere in the cell. The gradient of a
/// distance d to a segment turns by at most 1 / d a pixel: seen from afar, the difference of two
/// distances changes little within the cell.
void PolylineField::prune(const List& segments, const Rect& cell, SegmentOffsets& offsets,
                          List& kept) const {
  kept.clear();
  const auto [center, radius] = circle_around(cell);
  segment_offsets(columns_, segments, center, offsets);
  for (std::size_t i = 0; i < segments.size();) {
    const std::uint32_t shape = segments_[segments[i]].shape;
    std::size_t end = i + 1;
    while (end < segments.size() && segments_[segments[end]].shape == shape) ++end;
    const auto squared = offsets.squared.begin();
    const auto closest =
        static_cast<std::size_t>(std::min_element(squared + static_cast<std::ptrdiff_t>(i),
                                                  squared + static_cast<std::ptrdiff_t>(end)) -
                                 squared);
    const float least = std::sqrt(offsets.squared[closest]);
    const bool touched = least <= shapes_[shape].largest_half_width + radius;
    const float turn = least > 2.0F * radius ? radius / (least - radius) : 2.0F;
    const Vec2f away = offsets.at(closest) / std::max(least, 1e-6F);
    const float farthest = least + 2.0F * radius + 0.01F;
    for (; touched && i < end; ++i) {
      const float other = offsets.squared[i];
      if (other > farthest * farthest) continue;
      const float distance = std::sqrt(other);
      const float change = (offsets.at(i) / std::max(distance, 1e-6F) - away).norm() + turn;
      if (distance <= least + std::min(change, 2.0F) * radius + 0.01F) kept.push_back(segments[i]);
    }
    i = end;
  }
}

/// The shape with the largest |height| counts.
PolylineField::Samples PolylineField::sample(const LinePoints& points, const Cell& cell) const {
  Samples best{};
  const auto take = [&](const Samples& samples) {
    for (std::size_t k = 0; k < best.size(); ++k) {
      const float coverage = std::max(best[k].coverage, samples[k].coverage);
      if (std::abs(samples[k].height) > std::abs(best[k].height)) best[k] = samples[k];
      best[k].coverage = coverage;
    }
  };
  const bool has_level = profile_.level() != 0.0F || coverage_ == FieldCoverage::Inside;
  const List& segments = cell.segments;
  std::size_t at = 0;
  for (std::size_t i = 0; i < shapes_.size(); ++i) {
    if (at < segments.size() && segments_[segments[at]].shape == i) {
      const std::size_t first = at;
      while (at < segments.size() && segments_[segments[at]].shape == i) ++at;
      const auto list = std::span(segments).subspan(first, at - first);
      take(
          beside(points, shapes_[i], {list, shapes_[i].largest_half_width, cell.even, cell.bends}));
    } else if (has_level) {
      take(levels(points, shapes_[i]));
    } else if (at == segments.size()) {
      break;
    } else {
      i = segments_[segments[at]].shape - 1;
    }
  }
  return best;
}

PolylineField::Samples PolylineField::levels(const LinePoints& points, const Shape& shape) const {
  Samples out{};
  for (std::size_t k = 0; k < out.size(); ++k) {
    out[k] = level({points.x[k], points.y[k]}, shape);
  }
  return out;
}

FieldSample PolylineField::level(const Vec2f& p, const Shape& shape) const {
  FieldSample s;
  if (!shape.closed || !inside(p, shape)) return s;
  s.height = height_ * profile_.level();
  s.coverage = coverage_ == FieldCoverage::Inside ? 1.0F : 0.0F;
  return s;
}

PolylineField::Samples PolylineField::beside(const LinePoints& points, const Shape& shape,
                                             const LineList& list) const {
  LinePlaces places;
  line_places(columns_, list, points, places);
  Samples out{};
  for (std::size_t k = 0; k < out.size(); ++k) {
    const Vec2f p(points.x[k], points.y[k]);
    switch (places.place[k]) {
      case LinePlace::Beyond:
        if (shape.closed) out[k] = level(p, shape);
        break;
      case LinePlace::Beside:
        if (shape.closed) turn_in(p, shape, k, places);
        out[k] = pattern_ ? patterned(shape, places, k) : profiled(places, k);
        break;
      case LinePlace::Cap:
        if (!pattern_) out[k] = cap(places, k);
        break;
    }
  }
  return out;
}

/// A closed shape's sides are inside and outside.
void PolylineField::turn_in(const Vec2f& p, const Shape& shape, std::size_t k,
                            LinePlaces& places) const {
  const bool touches =
      places.distance[k] < (segment_of(places, k).bends() ? touching_bent : touching);
  const float side = touches ? places.side[k] * shape.orientation : inside(p, shape) ? 1.0F : -1.0F;
  places.side[k] = side;
}

FieldSample PolylineField::profiled(const LinePlaces& places, std::size_t k) const {
  const LineSegment& s = segment_of(places, k);
  const float half_width = places.half_width[k];
  const float side = places.side[k];
  const float u = side * places.distance[k] / half_width;
  const float fade = s.fade + places.at[k] * s.fade_rate;
  const Profile::Value h = profile_.at(u, jump_share(half_width));
  const float amplitude = height_ * fade;
  const Vec2f away(places.x[k], places.y[k]);
  Vec2f gradient = amplitude * h.slope / half_width * (side * away);
  if (!s.even) {
    // Where width or fade change along the line.
    const float along_rate =
        height_ * s.fade_rate * h.height - amplitude * h.slope * u * s.half_width_rate / half_width;
    gradient += along_rate * Vec2f(places.along_x[k], places.along_y[k]);
  }
  return {amplitude * h.height, {gradient.x(), -gradient.y()}, coverage(u, fade)};
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

/// Round end of an open line: the odd part of the profile turns over smoothly from one side to the
/// other, h = even(d) + sin(angle) odd(d).
FieldSample PolylineField::cap(const LinePlaces& places, std::size_t k) const {
  const LineSegment& s = segment_of(places, k);
  const float half_width = places.half_width[k];
  const float distance = places.distance[k];
  const float u = distance / half_width;
  const Profile::Value l = profile_.at(u, jump_share(half_width));
  const Profile::Value r = profile_.at(-u, jump_share(half_width));
  const float even = 0.5F * (l.height + r.height);
  const float odd = 0.5F * (l.height - r.height);
  const float even_slope = 0.5F * (l.slope - r.slope);
  const float odd_slope = 0.5F * (l.slope + r.slope);
  const Vec2f left = left_of(s.direction);
  const float fade = s.fade + places.at[k] * s.fade_rate;
  const float amplitude = height_ * fade;
  Vec2f gradient = odd_slope / half_width * left;
  float sine = 0.0F;
  if (distance > 1e-5F) {
    const Vec2f away = Vec2f(places.x[k], places.y[k]) / distance;
    sine = away.dot(left);
    gradient =
        (even_slope + sine * odd_slope) / half_width * away + odd / distance * (left - sine * away);
  }
  gradient *= amplitude;
  return {amplitude * (even + sine * odd), {gradient.x(), -gradient.y()}, coverage(u, fade)};
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
