/// Vectors of vectors for the kernels of floor 4, once for each target: include after highway.h.
#if defined(NORMALSHOP_CHART_LANES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef NORMALSHOP_CHART_LANES_INL
#undef NORMALSHOP_CHART_LANES_INL
#else
#define NORMALSHOP_CHART_LANES_INL
#endif

#include <cstddef>

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace normalshop {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Arrays have this much room past their end.
constexpr int lane_padding = 16;

using D = hn::CappedTag<float, lane_padding>;
using V = hn::Vec<D>;

struct V3 {
  V x;
  V y;
  V z;
};

/// Vectors: arrays of x, y and z, aligned.
template <class Vectors>
HWY_INLINE V3 load(const Vectors& v, std::size_t i) {
  const D d;
  return {hn::Load(d, &v.x[i]), hn::Load(d, &v.y[i]), hn::Load(d, &v.z[i])};
}

HWY_INLINE V dot(const V3& a, const V3& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}

HWY_INLINE V3 scaled(const V3& a, V f) {
  return {hn::Mul(a.x, f), hn::Mul(a.y, f), hn::Mul(a.z, f)};
}

HWY_INLINE V3 cross(const V3& a, const V3& b) {
  return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(a.z, b.y)),
          hn::Sub(hn::Mul(a.z, b.x), hn::Mul(a.x, b.z)),
          hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x))};
}

/// origin + b1 f1 + b2 f2
HWY_INLINE V mix(float origin, float f1, float f2, V b1, V b2) {
  const D d;
  return hn::Add(hn::Add(hn::Set(d, origin), hn::Mul(b1, hn::Set(d, f1))),
                 hn::Mul(b2, hn::Set(d, f2)));
}

}  // namespace HWY_NAMESPACE
}  // namespace normalshop
HWY_AFTER_NAMESPACE();

#endif
