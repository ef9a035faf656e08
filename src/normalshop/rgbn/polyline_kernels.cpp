#include "normalshop/rgbn/detail/polyline_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "normalshop/rgbn/polyline_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "normalshop/rgbn/detail/polyline-inl.h"

HWY_BEFORE_NAMESPACE();
namespace normalshop::HWY_NAMESPACE {

inline M IsSet(Index flags) { return hn::RebindMask(d, hn::Lt(flags, hn::Zero(di))); }

/// Of equally near ones the first.
inline Index NearestOf(const SegmentColumns& s, std::span<const std::uint32_t> list, V px, V py) {
  Index nearest = hn::Set(di, static_cast<std::int32_t>(list.front()));
  V least = hn::Set(d, 1e30F);
  for (const std::uint32_t i : list) {
    const V squared = FootOf(s, OneSegment{i}, px, py).squared;
    const M nearer = hn::Lt(squared, least);
    nearest = hn::IfThenElse(hn::RebindMask(di, nearer), hn::Set(di, static_cast<std::int32_t>(i)),
                             nearest);
    least = hn::IfThenElse(nearer, squared, least);
  }
  return nearest;
}

/// Behind the end of a segment or before its start, the neighbour's part of the line is near.
template <class Of>
inline Index BesideOf(const SegmentColumns& s, const Of& of, Index segment, const Foot& near,
                      M at_start, M at_end) {
  const V zero = hn::Zero(d);
  const V end_side = Dot(near.x, near.y, of(s.end_x), of(s.end_y));
  const V start_side = Dot(near.x, near.y, of(s.start_x), of(s.start_y));
  const M after = hn::And(at_end, hn::Gt(end_side, zero));
  const M before = hn::And(at_start, hn::Lt(start_side, zero));
  const Index next = hn::IfThenElseZero(hn::RebindMask(di, after), of(s.next));
  const Index previous = hn::IfThenElseZero(hn::RebindMask(di, before), of(s.previous));
  return hn::Add(segment, hn::Add(next, previous));
}

struct Along {
  V at, x, y;
};

/// Newton's method for the place whose direction is square to the way to the point.
template <class Of>
inline Along AlongOf(const SegmentColumns& s, const Of& of, V px, V py) {
  const V from_x = hn::Sub(px, of(s.ax));
  const V from_y = hn::Sub(py, of(s.ay));
  const V dx = of(s.dx);
  const V dy = of(s.dy);
  const V length = of(s.length);
  const V start_x = of(s.start_x);
  const V start_y = of(s.start_y);
  const V divisor = hn::Max(length, hn::Set(d, 1e-6F));
  const V turn_x = hn::Div(hn::Sub(of(s.end_x), start_x), divisor);
  const V turn_y = hn::Div(hn::Sub(of(s.end_y), start_y), divisor);
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
template <class Of>
inline Away AwayOf(const SegmentColumns& s, const Of& of, const Foot& near, M at_start, M at_end) {
  const V zero = hn::Zero(d);
  const V one = hn::Set(d, 1.0F);
  const V distance = hn::Sqrt(near.squared);
  const V tangent_x =
      hn::IfThenElse(at_start, of(s.start_x), hn::IfThenElse(at_end, of(s.end_x), of(s.dx)));
  const V tangent_y =
      hn::IfThenElse(at_start, of(s.start_y), hn::IfThenElse(at_end, of(s.end_y), of(s.dy)));
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
template <class Of>
inline Away BentAwayOf(const SegmentColumns& s, const Of& of, V px, V py) {
  const V zero = hn::Zero(d);
  const V one = hn::Set(d, 1.0F);
  const auto times = [](float factor, V v) { return hn::Mul(hn::Set(d, factor), v); };
  const V dx = of(s.dx);
  const V dy = of(s.dy);
  const V from_x = hn::Sub(px, of(s.ax));
  const V from_y = hn::Sub(py, of(s.ay));
  const V ahead = Dot(from_x, from_y, dx, dy);
  const V across = hn::Sub(hn::Mul(from_y, dx), hn::Mul(from_x, dy));
  const V length = of(s.length);
  const V share = of(s.share);
  const V start = of(s.start_bend);
  const V end = of(s.end_bend);
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

template <class Of>
inline M BendsOf(const SegmentColumns& s, const LineList& list, const Of& of, M cap) {
  const V zero = hn::Zero(d);
  if (!list.bends) return hn::Lt(zero, zero);
  const M bends = hn::Or(hn::Ne(of(s.start_bend), zero), hn::Ne(of(s.end_bend), zero));
  return hn::AndNot(cap, bends);
}

/// Sixteen points of a cell, or fewer.
struct Points {
  V x, y;
  std::size_t first;
};

/// Where a point lies to the straight segment that is nearest.
struct Ends {
  M start, end, cap;
};

/// Of points whose nearest segments are `near` and that lie beside those of `beside`.
template <class Near, class Beside>
inline void PlacesBeside(const SegmentColumns& s, const LineList& list, const Points& points,
                         const Near& near, const Foot& foot, const Ends& at, Index segment,
                         const Beside& beside, LinePlaces& out) {
  const V zero = hn::Zero(d);
  Along v{zero, zero, zero};
  if (!list.even) v = AlongOf(s, beside, points.x, points.y);
  v.at = hn::IfThenElse(at.cap, foot.along, v.at);
  const M bends = BendsOf(s, list, beside, at.cap);
  Away away;
  if (!hn::AllTrue(d, bends)) away = AwayOf(s, near, foot, at.start, at.end);
  if (!hn::AllFalse(d, bends)) {
    const Away bent = BentAwayOf(s, beside, points.x, points.y);
    if (hn::AllTrue(d, bends)) away = bent;
    away = {hn::IfThenElse(bends, bent.distance, away.distance),
            hn::IfThenElse(bends, bent.x, away.x), hn::IfThenElse(bends, bent.y, away.y),
            hn::IfThenElse(bends, bent.side, away.side)};
  }
  const V half_width = hn::Add(beside(s.half_width), hn::Mul(v.at, beside(s.half_width_rate)));
  const M inside = hn::And(hn::And(hn::Lt(away.distance, hn::Set(d, list.largest_half_width)),
                                   hn::Lt(away.distance, half_width)),
                           hn::Ge(half_width, hn::Set(d, 1e-6F)));
  const Index kind =
      hn::IfThenElse(hn::RebindMask(di, at.cap), hn::Set(di, line_cap), hn::Set(di, line_beside));
  const std::size_t i = points.first;
  hn::Store(hn::IfThenElseZero(hn::RebindMask(di, inside), kind), di, out.place.data() + i);
  hn::Store(segment, di, out.segment.data() + i);
  hn::Store(v.at, d, out.at.data() + i);
  hn::Store(half_width, d, out.half_width.data() + i);
  hn::Store(away.distance, d, out.distance.data() + i);
  hn::Store(hn::IfThenElse(at.cap, foot.x, away.x), d, out.x.data() + i);
  hn::Store(hn::IfThenElse(at.cap, foot.y, away.y), d, out.y.data() + i);
  hn::Store(away.side, d, out.side.data() + i);
  hn::Store(v.x, d, out.along_x.data() + i);
  hn::Store(v.y, d, out.along_y.data() + i);
}

template <class Near>
inline void PlacesNear(const SegmentColumns& s, const LineList& list, const Points& points,
                       Index nearest, const Near& near, LinePlaces& out) {
  const Foot foot = FootOf(s, near, points.x, points.y);
  const M at_start = hn::Le(foot.along, hn::Zero(d));
  const M at_end = hn::Ge(foot.along, near(s.length));
  const M cap =
      hn::Or(hn::And(at_start, IsSet(near(s.start_cap))), hn::And(at_end, IsSet(near(s.end_cap))));
  const Ends at{at_start, at_end, cap};
  Index segment = nearest;
  if ((!list.even || list.bends) && !hn::AllFalse(d, hn::Or(at_start, at_end))) {
    segment = hn::IfThenElse(hn::RebindMask(di, cap), segment,
                             BesideOf(s, near, nearest, foot, at_start, at_end));
  }
  if (IsOne(segment)) {
    PlacesBeside(s, list, points, near, foot, at, segment, OneOf(segment), out);
  } else {
    PlacesBeside(s, list, points, near, foot, at, segment, ManySegments{segment}, out);
  }
}

void LinePlacesOf(const SegmentColumns& s, const LineList& list, const LinePoints& all,
                  LinePlaces& out) {
  for (std::size_t i = 0; i < all.x.size(); i += hn::Lanes(d)) {
    const Points points{hn::Load(d, all.x.data() + i), hn::Load(d, all.y.data() + i), i};
    const Index nearest = NearestOf(s, list.segments, points.x, points.y);
    if (IsOne(nearest)) {
      PlacesNear(s, list, points, nearest, OneOf(nearest), out);
    } else {
      PlacesNear(s, list, points, nearest, ManySegments{nearest}, out);
    }
  }
}

}  // namespace normalshop::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace normalshop {

HWY_EXPORT(LinePlacesOf);

void line_places(const SegmentColumns& segments, const LineList& list, const LinePoints& points,
                 LinePlaces& out) {
  HWY_DYNAMIC_DISPATCH(LinePlacesOf)(segments, list, points, out);
}

}  // namespace normalshop
#endif
