#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "normalshop/chart/texel_batch.cpp"
#include <hwy/foreach_target.h>
// After foreach_target, as Highway asks.
#include <hwy/highway.h>

#include "normalshop/chart/texel_batch.h"

HWY_BEFORE_NAMESPACE();
namespace normalshop {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<float, 16>;
using V = hn::Vec<D>;

struct V3 {
  V x;
  V y;
  V z;
};

HWY_INLINE V3 load(const TexelBatch::Vectors& v, std::size_t i) {
  const D d;
  return {hn::Load(d, &v.x[i]), hn::Load(d, &v.y[i]), hn::Load(d, &v.z[i])};
}

HWY_INLINE V dot(const V3& a, const V3& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}

HWY_INLINE V3 scaled(const V3& a, V f) {
  return {hn::Mul(a.x, f), hn::Mul(a.y, f), hn::Mul(a.z, f)};
}

HWY_INLINE V3 sum(const V3& a, const V3& b) {
  return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}

HWY_INLINE V3 cross(const V3& a, const V3& b) {
  return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(a.z, b.y)),
          hn::Sub(hn::Mul(a.z, b.x), hn::Mul(a.x, b.z)),
          hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x))};
}

HWY_INLINE V3 unit(const V3& a) {
  return scaled(a, hn::Div(hn::Set(D(), 1.0F), hn::Sqrt(dot(a, a))));
}

struct Edit2 {
  V change_x;
  V change_y;
  V covered;
};

/// Minus the slopes of a unit normal: slope_from_normal().
HWY_INLINE void view_slopes(const V3& n, V& x, V& y) {
  const V inverse = hn::Div(hn::Set(D(), -1.0F), hn::Max(n.z, hn::Set(D(), min_cosine)));
  x = hn::Mul(n.x, inverse);
  y = hn::Mul(n.y, inverse);
}

HWY_INLINE V3 after_view_edit(const V3& before, const V3& base, const Edit2& e) {
  V x;
  V y;
  V base_x;
  V base_y;
  view_slopes(before, x, y);
  view_slopes(base, base_x, base_y);
  const V moved_x = hn::Add(e.change_x, hn::Mul(e.covered, hn::Sub(base_x, x)));
  const V moved_y = hn::Add(e.change_y, hn::Mul(e.covered, hn::Sub(base_y, y)));
  return unit({hn::Neg(hn::Add(x, moved_x)), hn::Neg(hn::Add(y, moved_y)), hn::Set(D(), 1.0F)});
}

HWY_INLINE V3 after_base_edit(const V3& before, const V3& base, const Edit2& e) {
  const V least = hn::Set(D(), min_cosine);
  const V along = dot(before, base);
  const V3 in_plane = sum(before, scaled(base, hn::Neg(along)));
  const V3 sg = scaled(in_plane, hn::Div(hn::Set(D(), -1.0F), hn::Max(along, least)));
  const V z = hn::Div(sg.z, hn::Max(base.z, least));
  const V kept = hn::Sub(hn::Set(D(), 1.0F), e.covered);
  const V h_x = hn::Add(hn::Mul(hn::Sub(sg.x, hn::Mul(base.x, z)), kept), e.change_x);
  const V h_y = hn::Add(hn::Mul(hn::Sub(sg.y, hn::Mul(base.y, z)), kept), e.change_y);
  const V turned = hn::Add(hn::Mul(h_x, base.x), hn::Mul(h_y, base.y));
  return unit({hn::Sub(base.x, hn::Sub(h_x, hn::Mul(turned, base.x))),
               hn::Sub(base.y, hn::Sub(h_y, hn::Mul(turned, base.y))),
               hn::Add(base.z, hn::Mul(turned, base.z))});
}

void apply_lanes(EditMode mode, TexelBatch& batch, std::size_t i) {
  const D d;
  const V3 t = load(batch.tangent, i);
  const V3 b = load(batch.bitangent, i);
  const V3 n = load(batch.normal, i);
  const V3 stored = load(batch.stored, i);
  const V3 before = unit(sum(sum(scaled(t, stored.x), scaled(b, stored.y)), scaled(n, stored.z)));
  const V3 base = unit(load(batch.base, i));
  const Edit2 edit{hn::Load(d, &batch.change_x[i]), hn::Load(d, &batch.change_y[i]),
                   hn::Load(d, &batch.covered[i])};
  const V3 after = mode == EditMode::View ? after_view_edit(before, base, edit)
                                          : after_base_edit(before, base, edit);
  const V3 moved = sum(after, scaled(before, hn::Set(d, -1.0F)));
  hn::Store(hn::Mul(hn::Set(d, 0.5F), dot(moved, moved)), d, &batch.turn[i]);
  // MikkTSpace's exact inverse: by the frame's cofactors.
  const V3 row = cross(b, n);
  const V side = hn::CopySign(hn::Set(d, 1.0F), dot(t, row));
  const V3 v = unit({dot(after, row), dot(after, cross(n, t)), dot(after, cross(t, b))});
  hn::Store(hn::Mul(v.x, side), d, &batch.result.x[i]);
  hn::Store(hn::Mul(v.y, side), d, &batch.result.y[i]);
  hn::Store(hn::Mul(v.z, side), d, &batch.result.z[i]);
}

void apply_all(EditMode mode, TexelBatch& batch) {
  const std::size_t lanes = hn::Lanes(D());
  for (std::size_t i = 0; i < static_cast<std::size_t>(batch.count); i += lanes) {
    apply_lanes(mode, batch, i);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace normalshop
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace normalshop {

HWY_EXPORT(apply_all);

void apply(EditMode mode, TexelBatch& batch) { HWY_DYNAMIC_DISPATCH(apply_all)(mode, batch); }

}  // namespace normalshop
#endif
