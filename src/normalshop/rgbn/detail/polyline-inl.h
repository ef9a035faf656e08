/// What the kernels of fields around polylines have in common, once for each target: include after
/// highway.h.
#if defined(NORMALSHOP_RGBN_POLYLINE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef NORMALSHOP_RGBN_POLYLINE_INL
#undef NORMALSHOP_RGBN_POLYLINE_INL
#else
#define NORMALSHOP_RGBN_POLYLINE_INL
#endif

#include <algorithm>

#include <hwy/highway.h>

#include "normalshop/rgbn/detail/polyline_kernels.h"

HWY_BEFORE_NAMESPACE();
namespace normalshop {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<float, most_lanes>;
using IndexTag = hn::RebindToSigned<Tag>;
using V = hn::Vec<Tag>;
using Index = hn::Vec<IndexTag>;
using M = hn::Mask<Tag>;

constexpr Tag d;
constexpr IndexTag di;

HWY_INLINE V Dot(V ax, V ay, V bx, V by) { return hn::Add(hn::Mul(ax, bx), hn::Mul(ay, by)); }

HWY_INLINE V Clamp(V x, V low, V high) { return hn::Min(hn::Max(x, low), high); }

/// Reads columns for lanes that all have to do with one segment.
struct OneSegment {
  std::size_t segment;
  V operator()(const std::vector<float>& column) const { return hn::Set(d, column[segment]); }
  Index operator()(const std::vector<std::int32_t>& column) const {
    return hn::Set(di, column[segment]);
  }
};

/// Reads columns for lanes each of which has to do with another one: far slower.
struct ManySegments {
  Index segments;
  V operator()(const std::vector<float>& column) const {
    return hn::GatherIndex(d, column.data(), segments);
  }
  Index operator()(const std::vector<std::int32_t>& column) const {
    return hn::GatherIndex(di, column.data(), segments);
  }
};

/// Is it the same for all lanes?
HWY_INLINE bool IsOne(Index segments) {
  return hn::AllTrue(di, hn::Eq(segments, hn::Set(di, hn::GetLane(segments))));
}
HWY_INLINE OneSegment OneOf(Index segments) {
  return {static_cast<std::size_t>(hn::GetLane(segments))};
}

/// The nearest place on a straight segment, and the way from there.
struct Foot {
  V along, x, y, squared;
};

template <class Of>
HWY_INLINE Foot FootOf(const SegmentColumns& s, const Of& of, V px, V py) {
  const V dx = of(s.dx);
  const V dy = of(s.dy);
  const V from_x = hn::Sub(px, of(s.ax));
  const V from_y = hn::Sub(py, of(s.ay));
  const V along = Clamp(Dot(from_x, from_y, dx, dy), hn::Zero(d), of(s.length));
  const V x = hn::Sub(from_x, hn::Mul(along, dx));
  const V y = hn::Sub(from_y, hn::Mul(along, dy));
  return {along, x, y, Dot(x, y, x, y)};
}

}  // namespace HWY_NAMESPACE
}  // namespace normalshop
HWY_AFTER_NAMESPACE();

#endif  // once for each target
