#include <cmath>
#include <cstring>
#include <limits>
#include <tuple>

#include "normalshop/rgbn/detail/polyline_field.h"

// From vertices to segments, and the lists that find them again.
namespace normalshop {

namespace {

int clamped_int(float x, int low, int high) {
  return static_cast<int>(
      std::clamp(x, static_cast<float>(low), static_cast<float>(std::max(low, high))));
}

/// Where two pieces of a curve meet: the parabola through their ends tells its direction.
void bend(LineSegment& s, LineSegment& next) {
  constexpr float corner = 0.1F;
  if (s.direction.dot(next.direction) < 0.0F) return;
  if (std::abs(cross(s.direction, next.direction)) > corner) return;
  const Vec2f tangent = next.length * s.direction + s.length * next.direction;
  s.end_bend = cross(s.direction, tangent) / s.direction.dot(tangent);
  next.start_bend = cross(next.direction, tangent) / next.direction.dot(tangent);
}

}  // namespace

void SegmentColumns::append(const LineSegment& s) {
  const auto flag = [](bool set) { return set ? -1 : 0; };
  ax.push_back(s.a.x());
  ay.push_back(s.a.y());
  dx.push_back(s.direction.x());
  dy.push_back(s.direction.y());
  length.push_back(s.length);
  share.push_back(1.0F / std::max(s.length, 1e-6F));
  start_x.push_back(s.start_tangent.x());
  start_y.push_back(s.start_tangent.y());
  end_x.push_back(s.end_tangent.x());
  end_y.push_back(s.end_tangent.y());
  start_bend.push_back(s.start_bend);
  end_bend.push_back(s.end_bend);
  half_width.push_back(s.half_width);
  half_width_rate.push_back(s.half_width_rate);
  fade.push_back(s.fade);
  fade_rate.push_back(s.fade_rate);
  start_cap.push_back(flag(s.start_cap));
  end_cap.push_back(flag(s.end_cap));
  even.push_back(flag(s.even));
  previous.push_back(static_cast<std::int32_t>(s.previous));
  next.push_back(static_cast<std::int32_t>(s.next));
}

namespace {

constexpr std::tuple float_columns{
    &SegmentColumns::ax,         &SegmentColumns::ay,         &SegmentColumns::dx,
    &SegmentColumns::dy,         &SegmentColumns::length,     &SegmentColumns::share,
    &SegmentColumns::start_x,    &SegmentColumns::start_y,    &SegmentColumns::end_x,
    &SegmentColumns::end_y,      &SegmentColumns::start_bend, &SegmentColumns::end_bend,
    &SegmentColumns::half_width, &SegmentColumns::fade,       &SegmentColumns::half_width_rate,
    &SegmentColumns::fade_rate};
constexpr std::tuple index_columns{&SegmentColumns::start_cap, &SegmentColumns::end_cap,
                                   &SegmentColumns::even, &SegmentColumns::previous,
                                   &SegmentColumns::next};

}  // namespace

void SegmentColumns::pad() {
  const auto room = [this](auto... column) {
    (..., (this->*column).resize((this->*column).size() + most_lanes));
  };
  std::apply(room, float_columns);
  std::apply(room, index_columns);
}

bool SegmentColumns::same(std::size_t i, const SegmentColumns& others, std::size_t k) const {
  const auto equal = [&](auto... column) {
    const auto bits = [&](const auto& ours, const auto& theirs) {
      return std::memcmp(&ours[i], &theirs[k], sizeof(ours[i])) == 0;
    };
    return (... && bits(this->*column, others.*column));
  };
  return std::apply(equal, float_columns) && std::apply(equal, index_columns);
}

PolylineField::PolylineField(const std::vector<FieldShape>& shapes, const Profile& profile,
                             float height, FieldCoverage coverage)
    : profile_(profile), height_(height), coverage_(coverage) {
  for (const FieldShape& shape : shapes) add(shape);
  columns_.pad();
}

PolylineField::PolylineField(const std::vector<FieldShape>& shapes, FieldPattern pattern)
    : PolylineField(shapes, Profile({}), 1.0F, FieldCoverage::Band) {
  pattern_ = std::move(pattern);
}

void PolylineField::add(const FieldShape& source) {
  const std::size_t first = segments_.size();
  shapes_.emplace_back();
  shapes_.back().closed = source.closed;
  shapes_.back().first = static_cast<std::uint32_t>(first);
  for (const auto& contour : source.contours) add_contour(contour, source.closed);
  Shape& shape = shapes_.back();
  shape.end = static_cast<std::uint32_t>(segments_.size());
  if (source.length >= 0.0F) shape.length = source.length;
  double area = 0.0;
  float bottom = -std::numeric_limits<float>::infinity();
  shape.top = std::numeric_limits<float>::infinity();
  for (std::size_t i = first; i < segments_.size(); ++i) {
    const LineSegment& s = segments_[i];
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
  shape.chunks = chunks(first);
  // With y down, a positive sum means clockwise as seen: inside is to the right.
  shape.orientation = area > 0.0 ? -1.0F : 1.0F;
  if (shape.closed && first < segments_.size()) fill_bands(shape, first, bottom);
}

void PolylineField::fill_bands(Shape& shape, std::size_t first, float bottom) const {
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
  float& along = shapes_.back().length;
  for (std::size_t i = 0; i < count; ++i) {
    const FieldVertex& a = v[i];
    const FieldVertex& b = v[(i + 1) % v.size()];
    LineSegment s{};
    s.a = a.position;
    s.b = b.position;
    s.length = (b.position - a.position).norm();
    s.direction = s.length > 0.0F ? Vec2f((b.position - a.position) / s.length) : Vec2f(1.0F, 0.0F);
    s.start = along;
    s.rate = 1.0F;
    along += s.length;
    if (a.along >= 0.0F) {
      s.start = a.along;
      // A picture shortens, but for rounding.
      if (s.length > 0.0F) s.rate = std::max(1.0F, (b.along - a.along) / s.length);
    }
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
    LineSegment& s = segments_[first + i];
    LineSegment& next = segments_[first + (i + 1) % count];
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
    if (v[i].smooth && v[(i + 1) % v.size()].smooth) bend(s, next);
  }
  const auto constant = [](const LineSegment& s) {
    return s.half_width_rate == 0.0F && s.fade_rate == 0.0F;
  };
  for (std::size_t i = first; i < segments_.size(); ++i) {
    LineSegment& s = segments_[i];
    s.even = constant(s) && constant(*(&s + s.previous)) && constant(*(&s + s.next));
    columns_.append(s);
  }
}

void PolylineField::grow_bounds(const LineSegment& s, float half_width) {
  const float margin = half_width + 1.0F;
  constexpr int limit = 1 << 24;
  const Vec2f low = s.a.cwiseMin(s.b).array() - margin;
  const Vec2f high = s.a.cwiseMax(s.b).array() + margin;
  bounds_ = unite(bounds_, {clamped_int(std::floor(low.x()), -limit, limit),
                            clamped_int(std::floor(low.y()), -limit, limit),
                            clamped_int(std::ceil(high.x()), -limit, limit) + 1,
                            clamped_int(std::ceil(high.y()), -limit, limit) + 1});
}

/// Of the segments from `first` on.
std::vector<PolylineField::Chunk> PolylineField::chunks(std::size_t first) const {
  constexpr std::size_t size = 16;
  std::vector<Chunk> out;
  for (; first < segments_.size(); first += size) {
    const std::size_t end = std::min(first + size, segments_.size());
    Vec2f low = segments_[first].a;
    Vec2f high = low;
    for (std::size_t i = first; i < end; ++i) {
      low = low.cwiseMin(segments_[i].a).cwiseMin(segments_[i].b);
      high = high.cwiseMax(segments_[i].a).cwiseMax(segments_[i].b);
    }
    out.push_back({static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(end),
                   0.5F * (low + high), 0.5F * (high - low).norm()});
  }
  return out;
}

}  // namespace normalshop
