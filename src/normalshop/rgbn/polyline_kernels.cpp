#include "normalshop/rgbn/detail/polyline_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "normalshop/rgbn/polyline_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

// The operations of PolylineField::beside() in its order: all targets give its bits.
HWY_BEFORE_NAMESPACE();
namespace normalshop::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

void PlainPlacesOf(const std::vector<PlainSegment>& segments, float half_width, float x, float y,
                   PlainPlaces& out) {
  const hn::CappedTag<float, PlainPlaces::count> d;
  const auto lanes = static_cast<int>(hn::Lanes(d));
  const auto zero = hn::Zero(d);
  const auto one = hn::Set(d, 1.0F);
  const auto py = hn::Set(d, y);
  for (int i = 0; i < PlainPlaces::count; i += lanes) {
    const auto px = hn::Iota(d, x + static_cast<float>(i));
    auto best = hn::Set(d, 1e30F);
    auto offset_x = zero;
    auto offset_y = zero;
    auto tangent_x = zero;
    auto tangent_y = zero;
    auto joint = hn::Lt(one, zero);
    for (const PlainSegment& s : segments) {
      const auto dx = hn::Set(d, s.dx);
      const auto dy = hn::Set(d, s.dy);
      const auto length = hn::Set(d, s.length);
      const auto from_x = hn::Sub(px, hn::Set(d, s.ax));
      const auto from_y = hn::Sub(py, hn::Set(d, s.ay));
      const auto reached = hn::Add(hn::Mul(from_x, dx), hn::Mul(from_y, dy));
      const auto along = hn::Min(hn::Max(reached, zero), length);
      const auto ox = hn::Sub(from_x, hn::Mul(along, dx));
      const auto oy = hn::Sub(from_y, hn::Mul(along, dy));
      const auto squared = hn::Add(hn::Mul(ox, ox), hn::Mul(oy, oy));
      const auto nearer = hn::Lt(squared, best);
      const auto at_start = hn::Le(along, zero);
      const auto at_end = hn::Ge(along, length);
      const auto tx = hn::IfThenElse(at_start, hn::Set(d, s.start_x),
                                     hn::IfThenElse(at_end, hn::Set(d, s.end_x), dx));
      const auto ty = hn::IfThenElse(at_start, hn::Set(d, s.start_y),
                                     hn::IfThenElse(at_end, hn::Set(d, s.end_y), dy));
      best = hn::IfThenElse(nearer, squared, best);
      offset_x = hn::IfThenElse(nearer, ox, offset_x);
      offset_y = hn::IfThenElse(nearer, oy, offset_y);
      tangent_x = hn::IfThenElse(nearer, tx, tangent_x);
      tangent_y = hn::IfThenElse(nearer, ty, tangent_y);
      joint = hn::Or(hn::And(nearer, hn::Or(at_start, at_end)), hn::AndNot(nearer, joint));
    }
    const auto distance = hn::Sqrt(best);
    const auto left_y = hn::Neg(tangent_x);
    const auto across = hn::Add(hn::Mul(offset_x, tangent_y), hn::Mul(offset_y, left_y));
    const auto side = hn::IfThenElse(hn::Lt(across, zero), hn::Neg(one), one);
    const auto apart = hn::And(joint, hn::Gt(distance, zero));
    const auto divisor = hn::IfThenElse(apart, distance, one);
    const auto width = hn::Set(d, half_width);
    const auto u = hn::Div(hn::Mul(side, distance), width);
    hn::StoreU(hn::IfThenElse(hn::Lt(distance, width), u, hn::Set(d, 2.0F)), d, out.u.data() + i);
    hn::StoreU(hn::IfThenElse(apart, hn::Mul(side, hn::Div(offset_x, divisor)), tangent_y), d,
               out.x.data() + i);
    hn::StoreU(hn::IfThenElse(apart, hn::Mul(side, hn::Div(offset_y, divisor)), left_y), d,
               out.y.data() + i);
  }
}

}  // namespace normalshop::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace normalshop {

HWY_EXPORT(PlainPlacesOf);

void plain_places(const std::vector<PlainSegment>& segments, float half_width, float x, float y,
                  PlainPlaces& out) {
  HWY_DYNAMIC_DISPATCH(PlainPlacesOf)(segments, half_width, x, y, out);
}

}  // namespace normalshop
#endif
