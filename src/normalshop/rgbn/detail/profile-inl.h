/// Heights across a stroke, many at once, once for each target: include after highway.h.
#if defined(NORMALSHOP_RGBN_PROFILE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef NORMALSHOP_RGBN_PROFILE_INL
#undef NORMALSHOP_RGBN_PROFILE_INL
#else
#define NORMALSHOP_RGBN_PROFILE_INL
#endif

#include <hwy/highway.h>

#include "normalshop/rgbn/profile.h"

HWY_BEFORE_NAMESPACE();
namespace normalshop {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

template <class V>
struct ProfileValues {
  V height;
  V slope;  ///< dh/du
};

// All profiles end with slope and curvature 0: a kink at a stroke's border would be read
// differently from the texels left and right of a seam.

/// (1 - u^2)^3.
template <class D, class V = hn::Vec<D>>
HWY_INLINE ProfileValues<V> bump(D tag, V u) {
  const V s = hn::Sub(hn::Set(tag, 1.0F), hn::Mul(u, u));
  return {hn::Mul(hn::Mul(s, s), s), hn::Mul(hn::Mul(hn::Mul(hn::Set(tag, -6.0F), u), s), s)};
}

/// -(1 - a)^3 (1 - 2 a), a = |u|: straight into the valley, with shoulders slightly above 0.
template <class D, class V = hn::Vec<D>>
HWY_INLINE ProfileValues<V> crease(D tag, V u) {
  const V zero = hn::Zero(tag);
  const V one = hn::Set(tag, 1.0F);
  const V a = hn::Abs(u);
  const V s = hn::Sub(one, a);
  const V slope =
      hn::Mul(hn::Mul(s, s), hn::Sub(hn::Set(tag, 5.0F), hn::Mul(hn::Set(tag, 8.0F), a)));
  const V side = hn::IfThenElse(hn::Eq(u, zero), zero, hn::CopySign(one, u));
  const V cube = hn::Mul(hn::Mul(hn::Neg(s), s), s);
  return {hn::Mul(cube, hn::Sub(one, hn::Mul(hn::Set(tag, 2.0F), a))), hn::Mul(side, slope)};
}

/// (1 - u^2)^3 (6 u^2 - 1): two fifths as wide as the stroke, lips 0.3 times as high as it is deep.
template <class D, class V = hn::Vec<D>>
HWY_INLINE ProfileValues<V> scratch(D tag, V u) {
  const V one = hn::Set(tag, 1.0F);
  const V t = hn::Mul(u, u);
  const V s = hn::Sub(one, t);
  const V height = hn::Mul(hn::Mul(hn::Mul(s, s), s), hn::Sub(hn::Mul(hn::Set(tag, 6.0F), t), one));
  const V rise = hn::Sub(hn::Set(tag, 9.0F), hn::Mul(hn::Set(tag, 24.0F), t));
  return {height, hn::Mul(hn::Mul(hn::Mul(hn::Mul(hn::Set(tag, 2.0F), u), s), s), rise)};
}

/// Quintic from 0 at -1 to 1 at 1: its curvature ends at 0 too.
template <class D, class V = hn::Vec<D>>
HWY_INLINE ProfileValues<V> step(D tag, V u) {
  const V one = hn::Set(tag, 1.0F);
  const V t = hn::Mul(hn::Set(tag, 0.5F), hn::Add(u, one));
  const V s = hn::Sub(one, t);
  const V cube = hn::Mul(hn::Mul(t, t), t);
  const V bend = hn::Add(hn::Sub(hn::Set(tag, 10.0F), hn::Mul(hn::Set(tag, 15.0F), t)),
                         hn::Mul(hn::Mul(hn::Set(tag, 6.0F), t), t));
  const V slope = hn::Mul(hn::Mul(hn::Mul(hn::Mul(hn::Set(tag, 15.0F), t), t), s), s);
  return {hn::Mul(cube, bend), slope};
}

/// A shape within [-1, 1]; beyond, the level continues. Not of Custom.
template <class D, class V = hn::Vec<D>>
HWY_INLINE ProfileValues<V> shape_at(D tag, ProfileShape shape, float level, V u) {
  const V zero = hn::Zero(tag);
  const V one = hn::Set(tag, 1.0F);
  ProfileValues<V> v = shape == ProfileShape::Bump      ? bump(tag, u)
                       : shape == ProfileShape::Crease  ? crease(tag, u)
                       : shape == ProfileShape::Scratch ? scratch(tag, u)
                                                        : step(tag, u);
  const auto before = hn::Le(u, hn::Neg(one));
  const auto after = hn::Ge(u, one);
  v.height = hn::IfThenElse(after, hn::Set(tag, level), hn::IfThenElse(before, zero, v.height));
  v.slope = hn::IfThenElse(hn::Or(before, after), zero, v.slope);
  return v;
}

/// A crease whose jump is spread: Profile::at(u, radius) of many u.
template <class D, class V = hn::Vec<D>>
HWY_INLINE ProfileValues<V> crease_at(D tag, V u, V radius) {
  const auto at = [&](V x) { return shape_at(tag, ProfileShape::Crease, 0.0F, x); };
  ProfileValues<V> v = at(u);
  const auto near = hn::Lt(hn::Abs(u), radius);
  if (hn::AllFalse(tag, near)) return v;
  const V rise = hn::Sub(at(hn::Add(u, radius)).height, at(hn::Sub(u, radius)).height);
  v.slope = hn::IfThenElse(near, hn::Div(rise, hn::Mul(hn::Set(tag, 2.0F), radius)), v.slope);
  return v;
}

}  // namespace HWY_NAMESPACE
}  // namespace normalshop
HWY_AFTER_NAMESPACE();

#endif  // once for each target
