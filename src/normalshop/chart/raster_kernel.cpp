#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "normalshop/chart/raster_kernel.cpp"
#include <hwy/foreach_target.h>
// After foreach_target, as Highway asks.
#include <algorithm>
#include <cstdlib>

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include "normalshop/chart/raster_kernel.h"

HWY_BEFORE_NAMESPACE();
namespace normalshop::raster {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Vertex = Rasterizer::Vertex;

/// Triangles side by side, and what drawing each of them takes.
struct Batch {
  static constexpr int capacity = 16;
  template <class T>
  using Lane = std::array<T, capacity>;
  struct Corner {
    alignas(64) Lane<std::int32_t> x;
    alignas(64) Lane<std::int32_t> y;
    alignas(64) Lane<float> z;
  };
  /// An edge function dx * (y - py) - dy * (x - px) >= 0 inside, with the top-left rule folded in.
  struct Edge {
    alignas(64) Lane<std::int32_t> value;   ///< at the box's first pixel centre
    alignas(64) Lane<std::int32_t> step_x;  ///< per pixel
    alignas(64) Lane<std::int32_t> step_y;
  };

  int count = 0;
  Lane<std::uint32_t> id;
  std::array<Corner, 3> corners;  ///< after set_up() in the order that faces the viewer
  // Filled by set_up(); of triangles that are not large, all but the box.
  // The box holds the pixels of the tile that a triangle may cover, inclusive; depth is a plane
  // over the tile's pixels, with limits so that edge-on triangles stay in range.
  alignas(64) Lane<std::int32_t> x0;
  alignas(64) Lane<std::int32_t> y0;
  alignas(64) Lane<std::int32_t> x1;  ///< below x0 where nothing is to draw
  alignas(64) Lane<std::int32_t> y1;
  alignas(64) Lane<std::int32_t> large;  ///< not 0: the edge functions may not fit
  std::array<Edge, 3> edges;
  alignas(64) Lane<float> origin;
  alignas(64) Lane<float> dx;
  alignas(64) Lane<float> dy;
  alignas(64) Lane<float> low;
  alignas(64) Lane<float> high;

  void add(std::uint32_t triangle, const Vec3u& index, const Vertex* vertices) {
    const auto i = static_cast<std::size_t>(count++);
    id[i] = triangle;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vertex& v = vertices[index[static_cast<Eigen::Index>(k)]];
      corners[k].x[i] = v.x;
      corners[k].y[i] = v.y;
      corners[k].z[i] = v.z;
    }
  }
};

using D = hn::CappedTag<float, Batch::capacity>;
using DI = hn::RebindToSigned<D>;
using VI = hn::Vec<DI>;
static_assert(row_padding >= Batch::capacity);

HWY_INLINE VI least(VI a, VI b, VI c) { return hn::Min(hn::Min(a, b), c); }
HWY_INLINE VI most(VI a, VI b, VI c) { return hn::Max(hn::Max(a, b), c); }

/// Vertices as far apart are of large triangles.
constexpr int small_side = 64 * unit;

/// Boxes of the triangles from `i` on: covered_pixels(), relative to the tile.
void set_up_boxes(const TileRect& rect, std::size_t i, Batch& batch) {
  const DI d;
  const auto set = [&](int v) { return hn::Set(d, v); };
  const auto range = [&](const auto& a, const auto& b, const auto& c, int first, int size,
                         auto& begin, auto& last) {
    const VI va = hn::Load(d, &a[i]);
    const VI vb = hn::Load(d, &b[i]);
    const VI vc = hn::Load(d, &c[i]);
    const VI low = least(va, vb, vc);
    const VI high = most(va, vb, vc);
    const VI from = hn::ShiftRight<unit_bits>(hn::Add(low, set(unit / 2 - 1)));
    const VI to = hn::ShiftRight<unit_bits>(hn::Sub(high, set(unit / 2)));
    hn::Store(hn::Sub(hn::Max(from, set(first)), set(first)), d, &begin[i]);
    hn::Store(hn::Sub(hn::Min(to, set(first + size - 1)), set(first)), d, &last[i]);
    return hn::Gt(hn::Sub(high, low), set(small_side));
  };
  const auto& [a, b, c] = batch.corners;
  const auto wide = range(a.x, b.x, c.x, rect.x, rect.width, batch.x0, batch.x1);
  const auto tall = range(a.y, b.y, c.y, rect.y, rect.height, batch.y0, batch.y1);
  hn::Store(hn::IfThenElseZero(hn::Or(wide, tall), set(1)), d, &batch.large[i]);
}

/// Turns the corners towards the viewer; those without area get an empty box.
void set_up_facing(std::size_t i, Batch& batch) {
  const DI d;
  const D df;
  auto& [a, b, c] = batch.corners;
  const VI ax = hn::Load(d, &a.x[i]);
  const VI ay = hn::Load(d, &a.y[i]);
  const VI bx = hn::Load(d, &b.x[i]);
  const VI by = hn::Load(d, &b.y[i]);
  const VI cx = hn::Load(d, &c.x[i]);
  const VI cy = hn::Load(d, &c.y[i]);
  const VI area =
      hn::Sub(hn::Mul(hn::Sub(bx, ax), hn::Sub(cy, ay)), hn::Mul(hn::Sub(cx, ax), hn::Sub(by, ay)));
  const VI zero = hn::Zero(d);
  const auto small = hn::Eq(hn::Load(d, &batch.large[i]), zero);
  const auto none = hn::And(small, hn::Eq(area, zero));
  hn::Store(hn::IfThenElse(none, hn::Set(d, -1), hn::Load(d, &batch.x1[i])), d, &batch.x1[i]);
  const auto flip = hn::And(small, hn::Lt(area, zero));
  hn::Store(hn::IfThenElse(flip, cx, bx), d, &b.x[i]);
  hn::Store(hn::IfThenElse(flip, bx, cx), d, &c.x[i]);
  hn::Store(hn::IfThenElse(flip, cy, by), d, &b.y[i]);
  hn::Store(hn::IfThenElse(flip, by, cy), d, &c.y[i]);
  const auto bz = hn::Load(df, &b.z[i]);
  const auto cz = hn::Load(df, &c.z[i]);
  const auto flip_z = hn::RebindMask(df, flip);
  hn::Store(hn::IfThenElse(flip_z, cz, bz), df, &b.z[i]);
  hn::Store(hn::IfThenElse(flip_z, bz, cz), df, &c.z[i]);
}

void set_up_edges(const TileRect& rect, std::size_t i, Batch& batch) {
  const DI d;
  const auto centre = [&](const auto& pixel, int origin) {
    return hn::Add(hn::ShiftLeft<unit_bits>(hn::Load(d, &pixel[i])),
                   hn::Set(d, origin * unit + unit / 2));
  };
  const VI x = centre(batch.x0, rect.x);
  const VI y = centre(batch.y0, rect.y);
  for (std::size_t k = 0; k < 3; ++k) {
    const Batch::Corner& p = batch.corners[k];
    const Batch::Corner& q = batch.corners[(k + 1) % 3];
    const VI px = hn::Load(d, &p.x[i]);
    const VI py = hn::Load(d, &p.y[i]);
    const VI dx = hn::Sub(hn::Load(d, &q.x[i]), px);
    const VI dy = hn::Sub(hn::Load(d, &q.y[i]), py);
    const VI zero = hn::Zero(d);
    const auto top_left = hn::Or(hn::Lt(dy, zero), hn::And(hn::Eq(dy, zero), hn::Gt(dx, zero)));
    const VI value = hn::Sub(hn::Mul(dx, hn::Sub(y, py)), hn::Mul(dy, hn::Sub(x, px)));
    const VI rule = hn::IfThenZeroElse(top_left, hn::Set(d, 1));
    hn::Store(hn::Sub(value, rule), d, &batch.edges[k].value[i]);
    hn::Store(hn::ShiftLeft<unit_bits>(hn::Neg(dy)), d, &batch.edges[k].step_x[i]);
    hn::Store(hn::ShiftLeft<unit_bits>(dx), d, &batch.edges[k].step_y[i]);
  }
}

using DD = hn::CappedTag<double, Batch::capacity / 2>;
using VD = hn::Vec<DD>;

/// In double: two faces in one place get the same depths, whichever corner comes first.
void set_up_planes(const TileRect& rect, std::size_t i, Batch& batch) {
  const DD d;
  const hn::Rebind<std::int32_t, DD> di;
  const hn::Rebind<float, DD> df;
  const VD scale = hn::Set(d, 1.0 / unit);
  const auto number = [&](const Batch::Lane<std::int32_t>& v) {
    return hn::PromoteTo(d, hn::Load(di, &v[i]));
  };
  const auto real = [&](const Batch::Lane<float>& v) {
    return hn::PromoteTo(d, hn::Load(df, &v[i]));
  };
  const auto store = [&](VD v, Batch::Lane<float>& out) {
    hn::Store(hn::DemoteTo(df, v), df, &out[i]);
  };
  const auto& [a, b, c] = batch.corners;
  const VD ax = number(a.x);
  const VD ay = number(a.y);
  const VD az = real(a.z);
  const VD bx = hn::Mul(hn::Sub(number(b.x), ax), scale);
  const VD by = hn::Mul(hn::Sub(number(b.y), ay), scale);
  const VD bz = hn::Sub(real(b.z), az);
  const VD cx = hn::Mul(hn::Sub(number(c.x), ax), scale);
  const VD cy = hn::Mul(hn::Sub(number(c.y), ay), scale);
  const VD cz = hn::Sub(real(c.z), az);
  const VD area = hn::Sub(hn::Mul(bx, cy), hn::Mul(by, cx));
  const VD one = hn::Set(d, 1.0);
  const VD inverse = hn::Div(one, hn::IfThenElse(hn::Eq(area, hn::Zero(d)), one, area));
  const VD dx = hn::Mul(hn::Sub(hn::Mul(bz, cy), hn::Mul(cz, by)), inverse);
  const VD dy = hn::Mul(hn::Sub(hn::Mul(cz, bx), hn::Mul(bz, cx)), inverse);
  const VD ox = hn::Sub(hn::Set(d, rect.x + 0.5), hn::Mul(ax, scale));
  const VD oy = hn::Sub(hn::Set(d, rect.y + 0.5), hn::Mul(ay, scale));
  store(hn::Add(hn::Add(az, hn::Mul(dx, ox)), hn::Mul(dy, oy)), batch.origin);
  store(dx, batch.dx);
  store(dy, batch.dy);
  const auto za = hn::Load(df, &a.z[i]);
  const auto zb = hn::Load(df, &b.z[i]);
  const auto zc = hn::Load(df, &c.z[i]);
  hn::Store(hn::Min(hn::Min(za, zb), zc), df, &batch.low[i]);
  hn::Store(hn::Max(hn::Max(za, zb), zc), df, &batch.high[i]);
}

void set_up(const TileRect& rect, Batch& batch) {
  // The rest of the last vector holds old triangles, which nobody draws.
  const auto count = static_cast<std::size_t>(batch.count);
  for (std::size_t i = 0; i < count; i += hn::Lanes(DI())) {
    set_up_boxes(rect, i, batch);
    set_up_facing(i, batch);
    set_up_edges(rect, i, batch);
  }
  for (std::size_t i = 0; i < count; i += hn::Lanes(DD())) set_up_planes(rect, i, batch);
}

/// Depth test and write for one vector of pixels under `inside`.
template <class D>
HWY_INLINE void write_pixels(D d, hn::Mask<D> inside, hn::Vec<D> z, std::uint32_t id, float* depth,
                             std::uint32_t* triangle) {
  const hn::RebindToUnsigned<D> du;
  const auto before = hn::LoadU(d, depth);
  const auto visible = hn::And(inside, hn::Gt(z, before));
  if (hn::AllFalse(d, visible)) return;
  hn::StoreU(hn::IfThenElse(visible, z, before), d, depth);
  const auto ids = hn::LoadU(du, triangle);
  hn::StoreU(hn::IfThenElse(hn::RebindMask(du, visible), hn::Set(du, id), ids), du, triangle);
}

/// By vectors of D, wide enough for most boxes.
template <class D>
HWY_INLINE void draw_small(D d, const Batch& batch, std::size_t i, Tile& tile) {
  const hn::RebindToSigned<D> di;
  using Int = hn::Vec<hn::RebindToSigned<D>>;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const Int iota = hn::Iota(di, 0);
  const auto iota_f = hn::Iota(d, 0.0F);
  const auto at_box = [&](const Batch::Edge& e) {
    return hn::Add(hn::Mul(iota, hn::Set(di, e.step_x[i])), hn::Set(di, e.value[i]));
  };
  const auto& [e0, e1, e2] = batch.edges;
  Int row0 = at_box(e0);
  Int row1 = at_box(e1);
  Int row2 = at_box(e2);
  const auto dz = hn::Set(d, batch.dx[i]);
  const auto low = hn::Set(d, batch.low[i]);
  const auto high = hn::Set(d, batch.high[i]);
  const int x0 = batch.x0[i];
  const int x1 = batch.x1[i];
  for (int y = batch.y0[i]; y <= batch.y1[i]; ++y) {
    float* depth = tile.depth.data() + y * stride;
    std::uint32_t* triangle = tile.triangle.data() + y * stride;
    const auto row_z = hn::Set(d, batch.origin[i] + batch.dy[i] * static_cast<float>(y));
    for (int x = x0; x <= x1; x += lanes) {
      const auto along = [&](Int row, const Batch::Edge& e) {
        return hn::Add(row, hn::Set(di, (x - x0) * e.step_x[i]));
      };
      const Int negative = hn::Or(hn::Or(along(row0, e0), along(row1, e1)), along(row2, e2));
      const auto inside =
          hn::And(hn::Gt(negative, hn::Set(di, -1)), hn::Lt(iota, hn::Set(di, x1 - x + 1)));
      const auto xs = hn::Add(iota_f, hn::Set(d, static_cast<float>(x)));
      const auto z = hn::Min(hn::Max(hn::Add(row_z, hn::Mul(dz, xs)), low), high);
      write_pixels(d, hn::RebindMask(d, inside), z, batch.id[i], depth + x, triangle + x);
    }
    row0 = hn::Add(row0, hn::Set(di, e0.step_y[i]));
    row1 = hn::Add(row1, hn::Set(di, e1.step_y[i]));
    row2 = hn::Add(row2, hn::Set(di, e2.step_y[i]));
  }
}

/// An edge function of a large triangle, as Batch::Edge.
struct LargeEdge {
  std::int64_t value;
  std::int64_t step_x;
  std::int64_t step_y;
};

LargeEdge make_edge(const Vertex& p, const Vertex& q, int x, int y) {
  const std::int64_t dx = q.x - p.x;
  const std::int64_t dy = q.y - p.y;
  const bool top_left = dy < 0 || (dy == 0 && dx > 0);
  const std::int64_t value = dx * (std::int64_t(y) - p.y) - dy * (std::int64_t(x) - p.x);
  return {value - (top_left ? 0 : 1), -dy * unit, dx * unit};
}

std::int64_t floor_divide(std::int64_t a, std::int64_t b) {
  const std::int64_t q = a / b;
  return q - ((a % b != 0) && ((a < 0) != (b < 0)) ? 1 : 0);
}

/// Narrows [x0, x1] to the pixels where the edge function is not negative.
void clip_span(const LargeEdge& e, std::int64_t& x0, std::int64_t& x1) {
  if (e.step_x > 0) {
    x0 = std::max(x0, -floor_divide(e.value, e.step_x));
  } else if (e.step_x < 0) {
    x1 = std::min(x1, floor_divide(e.value, -e.step_x));
  } else if (e.value < 0) {
    x1 = x0 - 1;
  }
}

void draw_large(const Batch& batch, std::size_t i, const TileRect& rect, Tile& tile) {
  const D d;
  const DI di;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const auto vertex = [&](std::size_t k) {
    const Batch::Corner& v = batch.corners[k];
    return Vertex{v.x[i], v.y[i], v.z[i]};
  };
  const Vertex a = vertex(0);
  Vertex b = vertex(1);
  Vertex c = vertex(2);
  const std::int64_t area =
      std::int64_t(b.x - a.x) * (c.y - a.y) - std::int64_t(c.x - a.x) * (b.y - a.y);
  if (area == 0) return;
  if (area < 0) std::swap(b, c);
  const int x0 = batch.x0[i];
  const int y0 = batch.y0[i];
  const int cx = (rect.x + x0) * unit + unit / 2;
  const int cy = (rect.y + y0) * unit + unit / 2;
  std::array<LargeEdge, 3> edges{make_edge(a, b, cx, cy), make_edge(b, c, cx, cy),
                                 make_edge(c, a, cx, cy)};
  const auto dz = hn::Set(d, batch.dx[i]);
  const auto low = hn::Set(d, batch.low[i]);
  const auto high = hn::Set(d, batch.high[i]);
  const auto iota_f = hn::Iota(d, 0.0F);
  for (int y = y0; y <= batch.y1[i]; ++y) {
    std::int64_t first = 0;
    std::int64_t last = batch.x1[i] - x0;
    for (auto& e : edges) {
      clip_span(e, first, last);
      e.value += e.step_y;
    }
    float* depth = tile.depth.data() + y * stride;
    std::uint32_t* triangle = tile.triangle.data() + y * stride;
    const auto row_z = hn::Set(d, batch.origin[i] + batch.dy[i] * static_cast<float>(y));
    const int end = x0 + static_cast<int>(last);
    for (int x = x0 + static_cast<int>(first); x <= end; x += lanes) {
      const auto inside = hn::Lt(hn::Iota(di, 0), hn::Set(di, end - x + 1));
      const auto xs = hn::Add(iota_f, hn::Set(d, static_cast<float>(x)));
      const auto z = hn::Min(hn::Max(hn::Add(row_z, hn::Mul(dz, xs)), low), high);
      write_pixels(d, hn::RebindMask(d, inside), z, batch.id[i], depth + x, triangle + x);
    }
  }
}

/// By vectors no wider than they need to be.
void draw_in_box(const Batch& batch, std::size_t i, int width, Tile& tile) {
  if (width <= 4) return draw_small(hn::CappedTag<float, 4>(), batch, i, tile);
  if (width <= 8) return draw_small(hn::CappedTag<float, 8>(), batch, i, tile);
  draw_small(D(), batch, i, tile);
}

void draw_batch(const TileRect& rect, Batch& batch, Tile& tile) {
  set_up(rect, batch);
  for (std::size_t i = 0; i < static_cast<std::size_t>(batch.count); ++i) {
    const int width = batch.x1[i] - batch.x0[i] + 1;
    if (width <= 0) continue;
    if (batch.large[i] != 0) {
      draw_large(batch, i, rect, tile);
    } else {
      draw_in_box(batch, i, width, tile);
    }
  }
  batch.count = 0;
}

void draw_all(const TileRect& rect, std::span<const std::uint32_t> triangles,
              const Vertex* vertices, const Vec3u* indices, Tile& tile) {
  constexpr std::size_t ahead = 8;
  Batch batch{};
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    if (i + 2 * ahead < triangles.size()) hwy::Prefetch(&indices[triangles[i + 2 * ahead]]);
    if (i + ahead < triangles.size()) {
      const Vec3u& next = indices[triangles[i + ahead]];
      hwy::Prefetch(&vertices[next[0]]);
      hwy::Prefetch(&vertices[next[1]]);
      hwy::Prefetch(&vertices[next[2]]);
    }
    batch.add(triangles[i], indices[triangles[i]], vertices);
    if (batch.count == Batch::capacity) draw_batch(rect, batch, tile);
  }
  draw_batch(rect, batch, tile);
}

}  // namespace HWY_NAMESPACE
}  // namespace normalshop::raster
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace normalshop::raster {

HWY_EXPORT(draw_all);

void draw(const TileRect& rect, std::span<const std::uint32_t> triangles,
          const Rasterizer::Vertex* vertices, const Vec3u* indices, Tile& tile) {
  HWY_DYNAMIC_DISPATCH(draw_all)(rect, triangles, vertices, indices, tile);
}

}  // namespace normalshop::raster
#endif
