#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "normalshop/chart/texel_batch.cpp"
#include <hwy/foreach_target.h>
// After foreach_target, as Highway asks.
#include <hwy/highway.h>

#include "normalshop/chart/detail/lanes-inl.h"
#include "normalshop/chart/texel_batch.h"
#include "normalshop/core/normal_codes.h"

HWY_BEFORE_NAMESPACE();
namespace normalshop {
namespace HWY_NAMESPACE {

static_assert(TexelBatch::padding >= lane_padding);

HWY_INLINE void store(const V3& v, TexelBatch::Vectors& out, std::size_t i) {
  const D d;
  hn::Store(v.x, d, &out.x[i]);
  hn::Store(v.y, d, &out.y[i]);
  hn::Store(v.z, d, &out.z[i]);
}

HWY_INLINE V3 sum(const V3& a, const V3& b) {
  return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}

HWY_INLINE V3 unit(const V3& a) {
  return scaled(a, hn::Div(hn::Set(D(), 1.0F), hn::Sqrt(dot(a, a))));
}

HWY_INLINE V3 mix(const Mat3f& m, V b1, V b2) {
  return {mix(m(0, 0), m(0, 1), m(0, 2), b1, b2), mix(m(1, 0), m(1, 1), m(1, 2), b1, b2),
          mix(m(2, 0), m(2, 1), m(2, 2), b1, b2)};
}

HWY_INLINE void store_u(const V3& v, TexelBatch::Vectors& out, std::size_t i) {
  const D d;
  hn::StoreU(v.x, d, &out.x[i]);
  hn::StoreU(v.y, d, &out.y[i]);
  hn::StoreU(v.z, d, &out.z[i]);
}

/// May write beyond the run: runs come one after the other.
void add_run_lanes(const PushTriangle& t, const TexelAffine& affine, int x, int y, int count,
                   TexelBatch& batch) {
  const D d;
  const V dy = hn::Set(d, static_cast<float>(y) - affine.y0);
  const V dy1 = hn::Mul(dy, hn::Set(d, affine.db_dy.x()));
  const V dy2 = hn::Mul(dy, hn::Set(d, affine.db_dy.y()));
  for (int i = 0; i < count; i += static_cast<int>(hn::Lanes(d))) {
    const auto k = static_cast<std::size_t>(batch.count + i);
    const V dx = hn::Sub(hn::Iota(d, static_cast<float>(x + i)), hn::Set(d, affine.x0));
    const V b1 = hn::Add(
        hn::Add(hn::Set(d, affine.origin_weights.x()), hn::Mul(dx, hn::Set(d, affine.db_dx.x()))),
        dy1);
    const V b2 = hn::Add(
        hn::Add(hn::Set(d, affine.origin_weights.y()), hn::Mul(dx, hn::Set(d, affine.db_dx.y()))),
        dy2);
    store_u(mix(t.points, b1, b2), batch.point, k);
    const V3 base = mix(t.normals, b1, b2);
    store_u(base, batch.base, k);
    store_u(base, batch.normal, k);
    store_u(mix(t.tangents, b1, b2), batch.tangent, k);
    hn::StoreU(hn::Set(d, t.sign), d, &batch.sign[k]);
    hn::StoreU(hn::Set(d, t.depth_step.x()), d, &batch.depth_dx[k]);
    hn::StoreU(hn::Set(d, t.depth_step.y()), d, &batch.depth_dy[k]);
    hn::StoreU(hn::Set(d, t.steepness), d, &batch.steepness[k]);
  }
  batch.count += count;
}

/// True when all frames are regular.
bool finish_frame_lanes(TexelBatch& batch) {
  const D d;
  const V smallest = hn::Set(d, ChartTriangle::smallest_sine * ChartTriangle::smallest_sine);
  bool all = true;
  for (std::size_t i = 0; i < static_cast<std::size_t>(batch.count); i += hn::Lanes(d)) {
    const V3 n = load(batch.normal, i);
    const V3 t = load(batch.tangent, i);
    const V3 b = scaled(cross(n, t), hn::Load(d, &batch.sign[i]));
    store(b, batch.bitangent, i);
    const V size = hn::Mul(smallest, dot(n, n));
    const V across = dot(b, b);
    const auto regular = hn::And(hn::Gt(across, size), hn::Gt(across, hn::Mul(size, dot(t, t))));
    hn::Store(hn::IfThenElseZero(regular, hn::Set(d, 1.0F)), d, &batch.regular[i]);
    all = all && hn::AllTrue(d, regular);
  }
  return all;
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

HWY_INLINE V select(hn::Mask<D> mask, V yes, V no) { return hn::IfThenElse(mask, yes, no); }

/// What an edit makes of normals beyond the horizon of its direction, which count as those on it:
/// they keep their distance from these as far as they are not covered, so that a small edit turns
/// them by little.
HWY_INLINE V3 beyond_horizon(hn::Mask<D> beyond, const V3& before, const V3& on_horizon,
                             const V3& after, const Edit2& e) {
  const V kept = hn::Sub(hn::Set(D(), 1.0F), e.covered);
  const V3 distance = sum(before, scaled(on_horizon, hn::Set(D(), -1.0F)));
  const V3 v = unit(sum(after, scaled(distance, kept)));
  return {select(beyond, v.x, after.x), select(beyond, v.y, after.y), select(beyond, v.z, after.z)};
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
  const V one = hn::Set(D(), 1.0F);
  const V3 after = unit({hn::Neg(hn::Add(x, moved_x)), hn::Neg(hn::Add(y, moved_y)), one});
  const auto beyond = hn::Lt(before.z, hn::Set(D(), min_cosine));
  if (HWY_LIKELY(hn::AllFalse(D(), beyond))) return after;
  return beyond_horizon(beyond, before, unit({hn::Neg(x), hn::Neg(y), one}), after, e);
}

/// normal_from_gradient(); `facing` = <base, d>.
HWY_INLINE V3 displaced(V h_x, V h_y, const V3& base, const V3& d, V facing) {
  const V turned = hn::Add(hn::Mul(h_x, d.x), hn::Mul(h_y, d.y));
  return unit({hn::Sub(base.x, hn::Sub(hn::Mul(h_x, facing), hn::Mul(turned, base.x))),
               hn::Sub(base.y, hn::Sub(hn::Mul(h_y, facing), hn::Mul(turned, base.y))),
               hn::Add(base.z, hn::Mul(turned, base.z))});
}

/// `fixed`: along d; otherwise d is the base normal.
HWY_INLINE V3 after_displacement(const V3& before, const V3& base, bool fixed, const V3& d,
                                 const Edit2& e) {
  const V least = hn::Set(D(), min_cosine);
  const V one = hn::Set(D(), 1.0F);
  const V along = dot(before, base);
  const V toward = fixed ? dot(before, d) : along;
  const V facing = fixed ? dot(base, d) : one;
  const V3 in_plane = sum(before, scaled(base, hn::Neg(along)));
  const V3 sg = scaled(in_plane, hn::Div(hn::Set(D(), -1.0F), hn::Max(toward, least)));
  const V z = hn::Div(sg.z, hn::Max(base.z, least));
  const V x = hn::Sub(sg.x, hn::Mul(base.x, z));
  const V y = hn::Sub(sg.y, hn::Mul(base.y, z));
  const V kept = hn::Sub(one, e.covered);
  const V3 after = displaced(hn::Add(hn::Mul(x, kept), e.change_x),
                             hn::Add(hn::Mul(y, kept), e.change_y), base, d, facing);
  const auto beyond = hn::Lt(toward, least);
  if (HWY_LIKELY(hn::AllFalse(D(), beyond))) return after;
  return beyond_horizon(beyond, before, displaced(x, y, base, d, facing), after, e);
}

/// The detailed normal; the base normal where the code holds no direction.
HWY_INLINE V3 before_edit(const V3& t, const V3& b, const V3& n, const V3& stored, const V3& base) {
  const D d;
  constexpr float shortest = codes::shortest_normal * codes::shortest_normal;
  constexpr float longest = codes::longest_normal * codes::longest_normal;
  const V length = dot(stored, stored);
  const auto usable =
      hn::And(hn::Ge(length, hn::Set(d, shortest)), hn::Le(length, hn::Set(d, longest)));
  const V3 v = unit(sum(sum(scaled(t, stored.x), scaled(b, stored.y)), scaled(n, stored.z)));
  return {select(usable, v.x, base.x), select(usable, v.y, base.y), select(usable, v.z, base.z)};
}

void apply_lanes(const EditDirection& direction, TexelBatch& batch, std::size_t i) {
  const D d;
  const Edit2 edit{hn::Load(d, &batch.change_x[i]), hn::Load(d, &batch.change_y[i]),
                   hn::Load(d, &batch.covered[i])};
  const V any = hn::Or(hn::Or(edit.change_x, edit.change_y), edit.covered);
  if (hn::AllTrue(d, hn::Eq(any, hn::Zero(d)))) return;
  const V3 t = load(batch.tangent, i);
  const V3 b = load(batch.bitangent, i);
  const V3 n = load(batch.normal, i);
  const V3 base = unit(load(batch.base, i));
  const V3 before = before_edit(t, b, n, load(batch.stored, i), base);
  const bool fixed = direction.mode == EditMode::Along;
  const V3 along{hn::Set(d, direction.along.x()), hn::Set(d, direction.along.y()),
                 hn::Set(d, direction.along.z())};
  const V3 after = direction.mode == EditMode::View
                       ? after_view_edit(before, base, edit)
                       : after_displacement(before, base, fixed, fixed ? along : base, edit);
  const V3 moved = sum(after, scaled(before, hn::Set(d, -1.0F)));
  hn::Store(hn::Mul(hn::Set(d, 0.5F), dot(moved, moved)), d, &batch.turn[i]);
  // MikkTSpace's exact inverse: by the frame's cofactors.
  const V3 row = cross(b, n);
  const V side = hn::CopySign(hn::Set(d, 1.0F), dot(t, row));
  const V3 v = unit({dot(after, row), dot(after, cross(n, t)), dot(after, cross(t, b))});
  store(scaled(v, side), batch.result, i);
}

void apply_all(const EditDirection& direction, TexelBatch& batch) {
  const std::size_t lanes = hn::Lanes(D());
  for (std::size_t i = 0; i < static_cast<std::size_t>(batch.count); i += lanes) {
    apply_lanes(direction, batch, i);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace normalshop
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace normalshop {

HWY_EXPORT(add_run_lanes);
HWY_EXPORT(finish_frame_lanes);
HWY_EXPORT(apply_all);

void PushTriangle::load(const Mesh& mesh, const ChartGrid& grid, std::uint32_t triangle) {
  ChartTriangle::load(mesh, grid, triangle);
  const Vec3f across = points.col(1).cross(points.col(2));
  const float facing = std::abs(across.z());
  const float steep = across.head<2>().norm();
  // Pixels to depth: the plane's gradient is -across.xy / across.z.
  const float limit = steepest_surface * grid.pixel;
  depth_step.setZero();
  if (facing > 0.0F) {
    depth_step = -across.head<2>() / across.z();
    if (!(steep <= limit * facing)) depth_step *= limit * facing / steep;
  }
  if (!depth_step.allFinite()) depth_step.setZero();
  steepness = depth_step.norm();
}

void TexelBatch::add_point(const PushTriangle& triangle, const Vec3f& weights) {
  point.set(count, triangle.points * weights);
  base.set(count, triangle.normals * weights);
  normal.set(count, base.get(count));
  tangent.set(count, triangle.tangents * weights);
  const auto k = static_cast<std::size_t>(count);
  sign[k] = triangle.sign;
  depth_dx[k] = triangle.depth_step.x();
  depth_dy[k] = triangle.depth_step.y();
  steepness[k] = triangle.steepness;
  ++count;
}

void add_run(const PushTriangle& triangle, const TexelAffine& affine, int x, int y, int count,
             TexelBatch& batch) {
  HWY_DYNAMIC_DISPATCH(add_run_lanes)(triangle, affine, x, y, count, batch);
}

void finish_frames(TexelBatch& batch) {
  if (HWY_DYNAMIC_DISPATCH(finish_frame_lanes)(batch)) return;
  for (int i = 0; i < batch.count; ++i) {
    if (batch.regular[static_cast<std::size_t>(i)] != 0.0F) continue;
    batch.set_frame(i, any_frame(batch.normal.get(i).cast<double>()));
  }
}

void apply(const EditDirection& direction, TexelBatch& batch) {
  HWY_DYNAMIC_DISPATCH(apply_all)(direction, batch);
}

}  // namespace normalshop
#endif
