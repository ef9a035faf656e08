#include "normalshop/rgbn/detail/polyline_kernels.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "normalshop/rgbn/polyline_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace normalshop::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<float, line_lanes>;
using IndexTag = hn::RebindToSigned<Tag>;
using V = hn::Vec<Tag>;
using Index = hn::Vec<IndexTag>;
using M = hn::Mask<Tag>;

constexpr Tag d;
constexpr IndexTag di;

inline V Dot(V ax, V ay, V bx, V by) { return hn::Add(hn::Mul(ax, bx), hn::Mul(ay, by)); }

inline V Clamp(V x, V low, V high) { return hn::Min(hn::Max(x, low), high); }

inline V Gather(const std::vector<float>& column, Index at) {
  return hn::GatherIndex(d, column.data(), at);
}

inline Index Gather(const std::vector<std::int32_t>& column, Index at) {
  return hn::GatherIndex(di, column.data(), at);
}

inline M IsSet(Index flags) { return hn::RebindMask(d, hn::Lt(flags, hn::Zero(di))); }

struct Nearest {
  Index segment;
  V along, x, y, squared;
};

inline Nearest NearestOf(const SegmentColumns& s, std::span<const std::uint32_t> list, V px, V py) {
  const V zero = hn::Zero(d);
  Nearest best{hn::Set(di, static_cast<std::int32_t>(list.front())), zero, zero, zero,
               hn::Set(d, 1e30F)};
  for (const std::uint32_t i : list) {
    const V dx = hn::Set(d, s.dx[i]);
    const V dy = hn::Set(d, s.dy[i]);
    const V from_x = hn::Sub(px, hn::Set(d, s.ax[i]));
    const V from_y = hn::Sub(py, hn::Set(d, s.ay[i]));
    const V along = Clamp(Dot(from_x, from_y, dx, dy), zero, hn::Set(d, s.length[i]));
    const V x = hn::Sub(from_x, hn::Mul(along, dx));
    const V y = hn::Sub(from_y, hn::Mul(along, dy));
    const V squared = Dot(x, y, x, y);
    const M nearer = hn::Lt(squared, best.squared);
    best.segment = hn::IfThenElse(hn::RebindMask(di, nearer),
                                  hn::Set(di, static_cast<std::int32_t>(i)), best.segment);
    best.along = hn::IfThenElse(nearer, along, best.along);
    best.x = hn::IfThenElse(nearer, x, best.x);
    best.y = hn::IfThenElse(nearer, y, best.y);
    best.squared = hn::IfThenElse(nearer, squared, best.squared);
  }
  return best;
}

/// Behind the end of a segment or before its start, the neighbour's part of the line is near.
inline Index BesideOf(const SegmentColumns& s, const Nearest& near, M at_start, M at_end) {
  const V zero = hn::Zero(d);
  const V end_side =
      Dot(near.x, near.y, Gather(s.end_x, near.segment), Gather(s.end_y, near.segment));
  const V start_side =
      Dot(near.x, near.y, Gather(s.start_x, near.segment), Gather(s.start_y, near.segment));
  const M after = hn::And(at_end, hn::Gt(end_side, zero));
  const M before = hn::And(at_start, hn::Lt(start_side, zero));
  const Index next = hn::IfThenElseZero(hn::RebindMask(di, after), Gather(s.next, near.segment));
  const Index previous =
      hn::IfThenElseZero(hn::RebindMask(di, before), Gather(s.previous, near.segment));
  return hn::Add(near.segment, hn::Add(next, previous));
}

struct Along {
  V at, x, y;
};

/// Newton's method for the place whose direction is square to the way to the point.
inline Along AlongOf(const SegmentColumns& s, Index segment, V px, V py) {
  const V from_x = hn::Sub(px, Gather(s.ax, segment));
  const V from_y = hn::Sub(py, Gather(s.ay, segment));
  const V dx = Gather(s.dx, segment);
  const V dy = Gather(s.dy, segment);
  const V length = Gather(s.length, segment);
  const V start_x = Gather(s.start_x, segment);
  const V start_y = Gather(s.start_y, segment);
  const V divisor = hn::Max(length, hn::Set(d, 1e-6F));
  const V turn_x = hn::Div(hn::Sub(Gather(s.end_x, segment), start_x), divisor);
  const V turn_y = hn::Div(hn::Sub(Gather(s.end_y, segment), start_y), divisor);
  const V linear = hn::Sub(Dot(from_x, from_y, turn_x, turn_y), Dot(dx, dy, start_x, start_y));
  const V square = hn::Neg(Dot(dx, dy, turn_x, turn_y));
  const V constant = Dot(from_x, from_y, start_x, start_y);
  V at = Clamp(Dot(from_x, from_y, dx, dy), hn::Zero(d), length);
  V slope = linear;
  for (int i = 0; i < 4; ++i) {
    slope = hn::Add(linear, hn::Mul(hn::Mul(hn::Set(d, 2.0F), at), square));
    slope = hn::Min(slope, hn::Set(d, -0.2F));  // the centre of the bend is singular
    const V value = hn::Add(constant, hn::Mul(at, hn::Add(linear, hn::Mul(at, square))));
    at = Clamp(hn::Sub(at, hn::Div(value, slope)), hn::Zero(d), length);
  }
  const V down = hn::Neg(slope);
  return {at, hn::Div(hn::Add(start_x, hn::Mul(at, turn_x)), down),
          hn::Div(hn::Add(start_y, hn::Mul(at, turn_y)), down)};
}

/// How a point lies to a line: the distance, and the direction away from the line.
struct Away {
  V distance, x, y, side;
};

/// Sides are left and right as seen, although y runs down.
inline Away AwayOf(const SegmentColumns& s, const Nearest& near, M at_start, M at_end) {
  const V zero = hn::Zero(d);
  const V one = hn::Set(d, 1.0F);
  const V distance = hn::Sqrt(near.squared);
  const V tangent_x = hn::IfThenElse(
      at_start, Gather(s.start_x, near.segment),
      hn::IfThenElse(at_end, Gather(s.end_x, near.segment), Gather(s.dx, near.segment)));
  const V tangent_y = hn::IfThenElse(
      at_start, Gather(s.start_y, near.segment),
      hn::IfThenElse(at_end, Gather(s.end_y, near.segment), Gather(s.dy, near.segment)));
  const V left_y = hn::Neg(tangent_x);
  const V side =
      hn::IfThenElse(hn::Lt(Dot(near.x, near.y, tangent_y, left_y), zero), hn::Neg(one), one);
  const M joint = hn::And(hn::Or(at_start, at_end), hn::Gt(distance, zero));
  const V divisor = hn::IfThenElse(joint, distance, one);
  return {distance, hn::IfThenElse(joint, hn::Div(near.x, divisor), hn::Mul(side, tangent_y)),
          hn::IfThenElse(joint, hn::Div(near.y, divisor), hn::Mul(side, left_y)), side};
}

/// The same from a segment that bends: Newton's method for the foot (s, b(s)) in coordinates along
/// the segment and across. Bends being small, it is near the foot on the straight line.
inline Away BentAwayOf(const SegmentColumns& s, Index segment, V px, V py) {
  const V zero = hn::Zero(d);
  const V one = hn::Set(d, 1.0F);
  const auto times = [](float factor, V v) { return hn::Mul(hn::Set(d, factor), v); };
  const V dx = Gather(s.dx, segment);
  const V dy = Gather(s.dy, segment);
  const V from_x = hn::Sub(px, Gather(s.ax, segment));
  const V from_y = hn::Sub(py, Gather(s.ay, segment));
  const V ahead = Dot(from_x, from_y, dx, dy);
  const V across = hn::Sub(hn::Mul(from_y, dx), hn::Mul(from_x, dy));
  const V length = hn::Max(Gather(s.length, segment), hn::Set(d, 1e-6F));
  const V share = hn::Div(one, length);
  const V start = Gather(s.start_bend, segment);
  const V end = Gather(s.end_bend, segment);
  // b(t L) = L (start t + square t^2 + cube t^3).
  const V square = hn::Neg(hn::Add(times(2.0F, start), end));
  const V cube = hn::Add(start, end);
  // The neighbours' parts begin at an angle that is theirs only nearly.
  const V beyond = times(0.25F, length);
  const V low = hn::Neg(beyond);
  const V high = hn::Add(length, beyond);
  constexpr int steps = 2;
  V at = Clamp(ahead, low, high);
  V way_x = zero;
  V way_y = zero;
  V slope = zero;
  for (int i = 0;; ++i) {
    const V t = hn::Mul(at, share);
    const V height = hn::Mul(at, hn::Add(start, hn::Mul(t, hn::Add(square, hn::Mul(t, cube)))));
    slope = hn::Add(start, hn::Mul(t, hn::Add(times(2.0F, square), hn::Mul(t, times(3.0F, cube)))));
    way_x = hn::Sub(ahead, at);
    way_y = hn::Sub(across, height);
    if (i == steps) break;
    const V turn = hn::Mul(hn::Add(times(2.0F, square), hn::Mul(t, times(6.0F, cube))), share);
    V rate = hn::Sub(hn::Mul(way_y, turn), hn::Add(one, hn::Mul(slope, slope)));
    rate = hn::Min(rate, hn::Set(d, -0.2F));  // the centre of the bend is singular
    at = Clamp(hn::Sub(at, hn::Div(hn::Add(way_x, hn::Mul(way_y, slope)), rate)), low, high);
  }
  const V norm = hn::Sqrt(hn::Add(one, hn::Mul(slope, slope)));
  const V left_ahead = hn::Div(slope, norm);
  const V left_across = hn::Neg(hn::Div(one, norm));
  const V to_left = Dot(way_x, way_y, left_ahead, left_across);
  const V side = hn::IfThenElse(hn::Lt(to_left, zero), hn::Neg(one), one);
  const V left_x = hn::Sub(hn::Mul(left_ahead, dx), hn::Mul(left_across, dy));
  const V left_y = hn::Add(hn::Mul(left_ahead, dy), hn::Mul(left_across, dx));
  return {hn::Sqrt(Dot(way_x, way_y, way_x, way_y)), hn::Mul(side, left_x), hn::Mul(side, left_y),
          side};
}

inline M BendsOf(const SegmentColumns& s, const LineList& list, Index segment, M cap) {
  const V zero = hn::Zero(d);
  if (!list.bends) return hn::Lt(zero, zero);
  const M bends = hn::Or(hn::Ne(Gather(s.start_bend, segment), zero),
                         hn::Ne(Gather(s.end_bend, segment), zero));
  return hn::AndNot(cap, bends);
}

inline void PlacesOf(const SegmentColumns& s, const LineList& list, const LinePoints& points, int i,
                     LinePlaces& out) {
  const V zero = hn::Zero(d);
  const V px = hn::LoadU(d, points.x.data() + i);
  const V py = hn::LoadU(d, points.y.data() + i);
  const Nearest near = NearestOf(s, list.segments, px, py);
  const M at_start = hn::Le(near.along, zero);
  const M at_end = hn::Ge(near.along, Gather(s.length, near.segment));
  const M cap = hn::Or(hn::And(at_start, IsSet(Gather(s.start_cap, near.segment))),
                       hn::And(at_end, IsSet(Gather(s.end_cap, near.segment))));
  Index segment = near.segment;
  if ((!list.even || list.bends) && !hn::AllFalse(d, hn::Or(at_start, at_end))) {
    segment = hn::IfThenElse(hn::RebindMask(di, cap), segment, BesideOf(s, near, at_start, at_end));
  }
  Along v{zero, zero, zero};
  if (!list.even) v = AlongOf(s, segment, px, py);
  v.at = hn::IfThenElse(cap, near.along, v.at);
  const M bends = BendsOf(s, list, segment, cap);
  Away away;
  if (!hn::AllTrue(d, bends)) away = AwayOf(s, near, at_start, at_end);
  if (!hn::AllFalse(d, bends)) {
    const Away bent = BentAwayOf(s, segment, px, py);
    if (hn::AllTrue(d, bends)) away = bent;
    away = {hn::IfThenElse(bends, bent.distance, away.distance),
            hn::IfThenElse(bends, bent.x, away.x), hn::IfThenElse(bends, bent.y, away.y),
            hn::IfThenElse(bends, bent.side, away.side)};
  }
  const V half_width =
      hn::Add(Gather(s.half_width, segment), hn::Mul(v.at, Gather(s.half_width_rate, segment)));
  const M inside = hn::And(hn::And(hn::Lt(away.distance, hn::Set(d, list.largest_half_width)),
                                   hn::Lt(away.distance, half_width)),
                           hn::Ge(half_width, hn::Set(d, 1e-6F)));
  const Index kind = hn::IfThenElse(hn::RebindMask(di, cap),
                                    hn::Set(di, static_cast<std::int32_t>(LinePlace::Cap)),
                                    hn::Set(di, static_cast<std::int32_t>(LinePlace::Beside)));
  LineLanes<std::int32_t> kinds;
  hn::StoreU(hn::IfThenElseZero(hn::RebindMask(di, inside), kind), di, kinds.data());
  for (std::size_t k = 0; k < hn::Lanes(d); ++k) {
    out.place[static_cast<std::size_t>(i) + k] = static_cast<LinePlace>(kinds[k]);
  }
  hn::StoreU(segment, di, out.segment.data() + i);
  hn::StoreU(v.at, d, out.at.data() + i);
  hn::StoreU(half_width, d, out.half_width.data() + i);
  hn::StoreU(away.distance, d, out.distance.data() + i);
  hn::StoreU(hn::IfThenElse(cap, near.x, away.x), d, out.x.data() + i);
  hn::StoreU(hn::IfThenElse(cap, near.y, away.y), d, out.y.data() + i);
  hn::StoreU(away.side, d, out.side.data() + i);
  hn::StoreU(v.x, d, out.along_x.data() + i);
  hn::StoreU(v.y, d, out.along_y.data() + i);
}

void LinePlacesOf(const SegmentColumns& segments, const LineList& list, const LinePoints& points,
                  LinePlaces& out) {
  for (int i = 0; i < line_lanes; i += static_cast<int>(hn::Lanes(d))) {
    PlacesOf(segments, list, points, i, out);
  }
}

inline void OffsetsOf(const SegmentColumns& s, Index list, V px, V py, std::size_t i,
                      SegmentOffsets& out) {
  const V dx = Gather(s.dx, list);
  const V dy = Gather(s.dy, list);
  const V from_x = hn::Sub(px, Gather(s.ax, list));
  const V from_y = hn::Sub(py, Gather(s.ay, list));
  const V along = Clamp(Dot(from_x, from_y, dx, dy), hn::Zero(d), Gather(s.length, list));
  const V x = hn::Sub(from_x, hn::Mul(along, dx));
  const V y = hn::Sub(from_y, hn::Mul(along, dy));
  hn::StoreU(x, d, out.x.data() + i);
  hn::StoreU(y, d, out.y.data() + i);
  hn::StoreU(Dot(x, y, x, y), d, out.squared.data() + i);
}

void SegmentOffsetsOf(const SegmentColumns& segments, std::span<const std::uint32_t> list, float x,
                      float y, SegmentOffsets& out) {
  const std::size_t lanes = hn::Lanes(d);
  const V px = hn::Set(d, x);
  const V py = hn::Set(d, y);
  LineLanes<std::int32_t> indices{};
  for (std::size_t i = 0; i < list.size(); i += lanes) {
    const std::size_t count = std::min(lanes, list.size() - i);
    for (std::size_t k = 0; k < count; ++k) indices[k] = static_cast<std::int32_t>(list[i + k]);
    OffsetsOf(segments, hn::LoadU(di, indices.data()), px, py, i, out);
  }
}

}  // namespace normalshop::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace normalshop {

HWY_EXPORT(LinePlacesOf);
HWY_EXPORT(SegmentOffsetsOf);

void SegmentColumns::append(const LineSegment& s) {
  const auto flag = [](bool set) { return set ? -1 : 0; };
  ax.push_back(s.a.x());
  ay.push_back(s.a.y());
  dx.push_back(s.direction.x());
  dy.push_back(s.direction.y());
  length.push_back(s.length);
  start_x.push_back(s.start_tangent.x());
  start_y.push_back(s.start_tangent.y());
  end_x.push_back(s.end_tangent.x());
  end_y.push_back(s.end_tangent.y());
  start_bend.push_back(s.start_bend);
  end_bend.push_back(s.end_bend);
  half_width.push_back(s.half_width);
  half_width_rate.push_back(s.half_width_rate);
  start_cap.push_back(flag(s.start_cap));
  end_cap.push_back(flag(s.end_cap));
  previous.push_back(static_cast<std::int32_t>(s.previous));
  next.push_back(static_cast<std::int32_t>(s.next));
}

void line_places(const SegmentColumns& segments, const LineList& list, const LinePoints& points,
                 LinePlaces& out) {
  HWY_DYNAMIC_DISPATCH(LinePlacesOf)(segments, list, points, out);
}

void segment_offsets(const SegmentColumns& segments, std::span<const std::uint32_t> list,
                     const Vec2f& point, SegmentOffsets& out) {
  const std::size_t padded = list.size() + line_lanes;
  if (out.squared.size() < padded) {
    for (std::vector<float>* column : {&out.x, &out.y, &out.squared}) column->resize(padded);
  }
  HWY_DYNAMIC_DISPATCH(SegmentOffsetsOf)(segments, list, point.x(), point.y(), out);
}

}  // namespace normalshop
#endif
