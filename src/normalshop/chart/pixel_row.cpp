#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "normalshop/chart/pixel_row.cpp"
#include <hwy/foreach_target.h>
// After foreach_target, as Highway asks.
#include <hwy/highway.h>

#include "normalshop/chart/detail/lanes-inl.h"
#include "normalshop/chart/pixel_row.h"
#include "normalshop/core/normal_codes.h"

HWY_BEFORE_NAMESPACE();
namespace normalshop {
namespace HWY_NAMESPACE {

static_assert(PixelRow::padding >= lane_padding);

HWY_INLINE void store_mix(const Mat3f& m, V b1, V b2, std::size_t i, PixelRow::Vectors& out) {
  const D d;
  hn::StoreU(mix(m(0, 0), m(0, 1), m(0, 2), b1, b2), d, &out.x[i]);
  hn::StoreU(mix(m(1, 0), m(1, 1), m(1, 2), b1, b2), d, &out.y[i]);
  hn::StoreU(mix(m(2, 0), m(2, 1), m(2, 2), b1, b2), d, &out.z[i]);
}

void interpolate_run(const PixelTriangle& t, int x, int y, int begin, int end, PixelRow& row) {
  const D d;
  const auto lanes = static_cast<int>(hn::Lanes(d));
  const V zero = hn::Zero(d);
  const V one = hn::Set(d, 1.0F);
  const float py = static_cast<float>(y) - t.y0;
  const V dy1 = hn::Set(d, py * t.dy.x());
  const V dy2 = hn::Set(d, py * t.dy.y());
  for (int i = begin; i < end; i += lanes) {
    const auto k = static_cast<std::size_t>(i);
    const V px = hn::Sub(hn::Iota(d, static_cast<float>(x + i)), hn::Set(d, t.x0));
    V b1 = hn::Add(hn::Mul(px, hn::Set(d, t.dx.x())), dy1);
    V b2 = hn::Add(hn::Mul(px, hn::Set(d, t.dx.y())), dy2);
    // Back into the triangle: a pixel centre may lie a rounding outside it.
    b1 = hn::Min(hn::Max(b1, zero), one);
    b2 = hn::Min(hn::Max(b2, zero), one);
    const V shrink = hn::Div(one, hn::Max(hn::Add(b1, b2), one));
    b1 = hn::Mul(b1, shrink);
    b2 = hn::Mul(b2, shrink);
    store_mix(t.normals, b1, b2, k, row.normal);
    store_mix(t.tangents, b1, b2, k, row.tangent);
    hn::StoreU(mix(t.uv.x(), t.uv1.x(), t.uv2.x(), b1, b2), d, &row.u[k]);
    hn::StoreU(mix(t.uv.y(), t.uv1.y(), t.uv2.y(), b1, b2), d, &row.v[k]);
    hn::StoreU(hn::Set(d, t.sign), d, &row.sign[k]);
  }
}

/// Unit vectors where `keep`, else zero.
HWY_INLINE void store_unit(const V3& v, V length_squared, hn::Mask<D> keep, Vec3f* out) {
  const D d;
  const V one = hn::Set(d, 1.0F);
  const V inverse =
      hn::IfThenElseZero(keep, hn::Div(one, hn::Sqrt(hn::IfThenElse(keep, length_squared, one))));
  const auto component = [&](V c) { return hn::IfThenElseZero(keep, hn::Mul(c, inverse)); };
  hn::StoreInterleaved3(component(v.x), component(v.y), component(v.z), d,
                        reinterpret_cast<float*>(out));
}

HWY_INLINE V3 turn(const View& view, PixelRow::Vectors& v, std::size_t i) {
  const D d;
  const V3 in = load(v, i);
  const auto along = [&](const Vec3f& axis) {
    return dot(in, {hn::Set(d, axis.x()), hn::Set(d, axis.y()), hn::Set(d, axis.z())});
  };
  const V3 out{along(view.right), along(view.up), along(view.direction)};
  hn::Store(out.x, d, &v.x[i]);
  hn::Store(out.y, d, &v.y[i]);
  hn::Store(out.z, d, &v.z[i]);
  return out;
}

void base_normals(int count, const View& view, PixelRow& row) {
  const D d;
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); i += hn::Lanes(d)) {
    const V3 n = turn(view, row.normal, i);
    turn(view, row.tangent, i);
    const V squared = dot(n, n);
    const auto keep =
        hn::And(hn::Gt(hn::Load(d, &row.seen[i]), hn::Zero(d)), hn::Gt(squared, hn::Zero(d)));
    store_unit(n, squared, keep, &row.base_normals[i]);
  }
}

void details(int count, PixelRow& row) {
  const D d;
  const V smallest = hn::Set(d, ChartTriangle::smallest_sine * ChartTriangle::smallest_sine);
  const V shortest = hn::Set(d, codes::shortest_normal * codes::shortest_normal);
  const V longest = hn::Set(d, codes::longest_normal * codes::longest_normal);
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); i += hn::Lanes(d)) {
    const V3 n = load(row.normal, i);
    const V3 t = load(row.tangent, i);
    const V3 stored = load(row.stored, i);
    const V sign = hn::Load(d, &row.sign[i]);
    const V3 b = scaled(cross(n, t), sign);
    const auto direct = hn::Eq(sign, hn::Zero(d));
    const auto mixed = [&](V tc, V bc, V nc, V sc) {
      const V sum =
          hn::Add(hn::Add(hn::Mul(tc, stored.x), hn::Mul(bc, stored.y)), hn::Mul(nc, stored.z));
      return hn::IfThenElse(direct, sc, sum);
    };
    const V3 v{mixed(t.x, b.x, n.x, stored.x), mixed(t.y, b.y, n.y, stored.y),
               mixed(t.z, b.z, n.z, stored.z)};
    const V size = hn::Mul(smallest, dot(n, n));
    const V across = dot(b, b);
    const auto regular =
        hn::Or(direct, hn::And(hn::Gt(across, size), hn::Gt(across, hn::Mul(size, dot(t, t)))));
    const V squared = dot(v, v);
    const V length = dot(stored, stored);
    const auto usable = hn::And(hn::And(hn::Ge(length, shortest), hn::Le(length, longest)),
                                hn::Gt(squared, hn::Zero(d)));
    const auto seen = hn::Gt(hn::Load(d, &row.seen[i]), hn::Zero(d));
    const auto fine = hn::And(regular, usable);
    hn::Store(hn::IfThenElseZero(hn::Or(fine, hn::Not(seen)), hn::Set(d, 1.0F)), d,
              &row.regular[i]);
    store_unit(v, squared, hn::And(fine, seen), &row.details[i]);
  }
}

void colors(int count, PixelRow& row) {
  const D d;
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); i += hn::Lanes(d)) {
    const auto seen = hn::Gt(hn::Load(d, &row.seen[i]), hn::Zero(d));
    const V3 c = load(row.color, i);
    hn::StoreInterleaved3(hn::IfThenElseZero(seen, c.x), hn::IfThenElseZero(seen, c.y),
                          hn::IfThenElseZero(seen, c.z), d,
                          reinterpret_cast<float*>(&row.colors[i]));
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace normalshop
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace normalshop {

HWY_EXPORT(interpolate_run);
HWY_EXPORT(base_normals);
HWY_EXPORT(details);
HWY_EXPORT(colors);

void PixelTriangle::load(const Mesh& mesh, const ChartGrid& grid, std::uint32_t triangle) {
  const Vec3u& index = mesh.triangles[triangle];
  const Vec3f& p0 = mesh.positions[index[0]];
  const Vec3f origin = grid.project(p0);
  x0 = origin.x();
  y0 = origin.y();
  const float scale = 1.0F / grid.pixel;
  const Vec3f right = grid.view.right * scale;
  const Vec3f down = grid.view.up * -scale;
  const Vec3f ab = mesh.positions[index[1]] - p0;
  const Vec3f ac = mesh.positions[index[2]] - p0;
  const float abx = ab.dot(right);
  const float aby = ab.dot(down);
  const float acx = ac.dot(right);
  const float acy = ac.dot(down);
  const float area = abx * acy - acx * aby;
  const float inverse = area != 0.0F ? 1.0F / area : 0.0F;
  dx = {acy * inverse, -aby * inverse};
  dy = {-acx * inverse, abx * inverse};
  const std::size_t corner = 3 * static_cast<std::size_t>(triangle);
  const Vec3f* n = &mesh.normals[corner];
  normals = ChartTriangle::differences(n[0], n[1], n[2]);
  uv = mesh.uvs[corner];
  uv1 = mesh.uvs[corner + 1] - uv;
  uv2 = mesh.uvs[corner + 2] - uv;
  uv_dx = dx.x() * uv1 + dx.y() * uv2;
  uv_dy = dy.x() * uv1 + dy.y() * uv2;
  texture_set = mesh.texture_sets[triangle];
  if (mesh.tangents.empty()) return;
  const Vec4f* t = &mesh.tangents[corner];
  tangents = ChartTriangle::differences(t[0].head<3>(), t[1].head<3>(), t[2].head<3>());
  sign = (t[0].w() + t[1].w() + t[2].w() < 0.0F ? -1.0F : 1.0F) * grid.view.handedness();
}

void interpolate_run(const PixelTriangle& triangle, int x, int y, int begin, int end,
                     PixelRow& row) {
  HWY_DYNAMIC_DISPATCH(interpolate_run)(triangle, x, y, begin, end, row);
}

void finish_base_normals(int count, const View& view, PixelRow& row) {
  HWY_DYNAMIC_DISPATCH(base_normals)(count, view, row);
}

void finish_colors(int count, PixelRow& row) { HWY_DYNAMIC_DISPATCH(colors)(count, row); }

void finish_details(int count, PixelRow& row) { HWY_DYNAMIC_DISPATCH(details)(count, row); }

}  // namespace normalshop
#endif
