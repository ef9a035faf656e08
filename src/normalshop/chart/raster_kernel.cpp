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

/// Pixels of the tile that a triangle may cover, inclusive, relative to the tile.
struct Box {
  int x0;
  int y0;
  int x1;
  int y1;
};

/// Depth as a plane over tile pixels, and its limits, so that edge-on triangles stay in range.
struct Plane {
  float origin;
  float dx;
  float dy;
  float low;
  float high;
};

Plane depth_plane(const Vertex& a, const Vertex& b, const Vertex& c, const TileRect& rect) {
  const double scale = 1.0 / unit;
  const double bx = (double(b.x) - a.x) * scale;
  const double by = (double(b.y) - a.y) * scale;
  const double cx = (double(c.x) - a.x) * scale;
  const double cy = (double(c.y) - a.y) * scale;
  const double bz = double(b.z) - a.z;
  const double cz = double(c.z) - a.z;
  const double inverse = 1.0 / (bx * cy - by * cx);
  const double dx = (bz * cy - cz * by) * inverse;
  const double dy = (cz * bx - bz * cx) * inverse;
  const double ox = rect.x + 0.5 - a.x * scale;
  const double oy = rect.y + 0.5 - a.y * scale;
  return {static_cast<float>(a.z + dx * ox + dy * oy), static_cast<float>(dx),
          static_cast<float>(dy), std::min({a.z, b.z, c.z}), std::max({a.z, b.z, c.z})};
}

Box pixel_box(const Vertex& a, const Vertex& b, const Vertex& c, const TileRect& rect) {
  const Rect covered =
      covered_pixels(a, b, c, {rect.x, rect.y, rect.x + rect.width, rect.y + rect.height});
  return {covered.x0 - rect.x, covered.y0 - rect.y, covered.x1 - 1 - rect.x,
          covered.y1 - 1 - rect.y};
}

/// An edge function dx * (y - py) - dy * (x - px) >= 0 inside, with the top-left rule folded in.
template <class Int>
struct Edge {
  Int value;   // at the box's first pixel centre
  Int step_x;  // per pixel
  Int step_y;
};

template <class Int>
Edge<Int> make_edge(const Vertex& p, const Vertex& q, int x, int y) {
  const Int dx = q.x - p.x;
  const Int dy = q.y - p.y;
  const bool top_left = dy < 0 || (dy == 0 && dx > 0);
  const Int value = dx * (Int(y) - p.y) - dy * (Int(x) - p.x);
  return {value - (top_left ? 0 : 1), -dy * unit, dx * unit};
}

/// Depth test and write for one vector of pixels under `inside`.
template <class D, class M>
void write_pixels(D d, M inside, hn::Vec<D> z, std::uint32_t id, float* depth,
                  std::uint32_t* triangle) {
  const hn::RebindToUnsigned<D> du;
  const auto before = hn::LoadU(d, depth);
  const auto visible = hn::And(inside, hn::Gt(z, before));
  if (hn::AllFalse(d, visible)) return;
  hn::StoreU(hn::IfThenElse(visible, z, before), d, depth);
  const auto ids = hn::LoadU(du, triangle);
  hn::StoreU(hn::IfThenElse(hn::RebindMask(du, visible), hn::Set(du, id), ids), du, triangle);
}

void draw_small(const Vertex& a, const Vertex& b, const Vertex& c, const Box& box,
                const TileRect& rect, std::uint32_t id, Tile& tile) {
  const hn::ScalableTag<float> d;
  const hn::RebindToSigned<decltype(d)> di;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const int cx = (rect.x + box.x0) * unit + unit / 2;
  const int cy = (rect.y + box.y0) * unit + unit / 2;
  Edge<std::int32_t> e0 = make_edge<std::int32_t>(a, b, cx, cy);
  Edge<std::int32_t> e1 = make_edge<std::int32_t>(b, c, cx, cy);
  Edge<std::int32_t> e2 = make_edge<std::int32_t>(c, a, cx, cy);
  const Plane plane = depth_plane(a, b, c, rect);
  const auto iota = hn::Iota(di, 0);
  const auto ramp0 = hn::Mul(iota, hn::Set(di, e0.step_x));
  const auto ramp1 = hn::Mul(iota, hn::Set(di, e1.step_x));
  const auto ramp2 = hn::Mul(iota, hn::Set(di, e2.step_x));
  const auto dz = hn::Set(d, plane.dx);
  const auto low = hn::Set(d, plane.low);
  const auto high = hn::Set(d, plane.high);
  const auto iota_f = hn::Iota(d, 0.0F);
  for (int y = box.y0; y <= box.y1; ++y) {
    float* depth = tile.depth.data() + y * stride;
    std::uint32_t* triangle = tile.triangle.data() + y * stride;
    const auto row_z = hn::Set(d, plane.origin + plane.dy * static_cast<float>(y));
    for (int x = box.x0; x <= box.x1; x += lanes) {
      const int k = x - box.x0;
      const auto v0 = hn::Add(ramp0, hn::Set(di, e0.value + k * e0.step_x));
      const auto v1 = hn::Add(ramp1, hn::Set(di, e1.value + k * e1.step_x));
      const auto v2 = hn::Add(ramp2, hn::Set(di, e2.value + k * e2.step_x));
      const auto limit = hn::Set(di, box.x1 - x + 1);
      const auto negative = hn::Or(hn::Or(v0, v1), v2);
      const auto inside = hn::And(hn::Gt(negative, hn::Set(di, -1)), hn::Lt(iota, limit));
      const auto xs = hn::Add(iota_f, hn::Set(d, static_cast<float>(x)));
      const auto z = hn::Min(hn::Max(hn::Add(row_z, hn::Mul(dz, xs)), low), high);
      write_pixels(d, hn::RebindMask(d, inside), z, id, depth + x, triangle + x);
    }
    e0.value += e0.step_y;
    e1.value += e1.step_y;
    e2.value += e2.step_y;
  }
}

std::int64_t floor_divide(std::int64_t a, std::int64_t b) {
  const std::int64_t q = a / b;
  return q - ((a % b != 0) && ((a < 0) != (b < 0)) ? 1 : 0);
}

/// Narrows [x0, x1] to the pixels where the edge function is not negative.
void clip_span(const Edge<std::int64_t>& e, std::int64_t& x0, std::int64_t& x1) {
  if (e.step_x > 0) {
    x0 = std::max(x0, -floor_divide(e.value, e.step_x));
  } else if (e.step_x < 0) {
    x1 = std::min(x1, floor_divide(e.value, -e.step_x));
  } else if (e.value < 0) {
    x1 = x0 - 1;
  }
}

void draw_large(const Vertex& a, const Vertex& b, const Vertex& c, const Box& box,
                const TileRect& rect, std::uint32_t id, Tile& tile) {
  const hn::ScalableTag<float> d;
  const hn::RebindToSigned<decltype(d)> di;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const int cx = (rect.x + box.x0) * unit + unit / 2;
  const int cy = (rect.y + box.y0) * unit + unit / 2;
  std::array<Edge<std::int64_t>, 3> edges{make_edge<std::int64_t>(a, b, cx, cy),
                                          make_edge<std::int64_t>(b, c, cx, cy),
                                          make_edge<std::int64_t>(c, a, cx, cy)};
  const Plane plane = depth_plane(a, b, c, rect);
  const auto dz = hn::Set(d, plane.dx);
  const auto low = hn::Set(d, plane.low);
  const auto high = hn::Set(d, plane.high);
  const auto iota_f = hn::Iota(d, 0.0F);
  for (int y = box.y0; y <= box.y1; ++y) {
    std::int64_t first = 0;
    std::int64_t last = box.x1 - box.x0;
    for (auto& e : edges) {
      clip_span(e, first, last);
      e.value += e.step_y;
    }
    float* depth = tile.depth.data() + y * stride;
    std::uint32_t* triangle = tile.triangle.data() + y * stride;
    const auto row_z = hn::Set(d, plane.origin + plane.dy * static_cast<float>(y));
    const int end = box.x0 + static_cast<int>(last);
    for (int x = box.x0 + static_cast<int>(first); x <= end; x += lanes) {
      const auto inside = hn::Lt(hn::Iota(di, 0), hn::Set(di, end - x + 1));
      const auto xs = hn::Add(iota_f, hn::Set(d, static_cast<float>(x)));
      const auto z = hn::Min(hn::Max(hn::Add(row_z, hn::Mul(dz, xs)), low), high);
      write_pixels(d, hn::RebindMask(d, inside), z, id, depth + x, triangle + x);
    }
  }
}

void draw_all(const TileRect& rect, std::span<const std::uint32_t> triangles,
              const Vertex* vertices, const Vec3u* indices, Tile& tile) {
  constexpr int small = 64 * unit;  // keeps the edge functions of draw_small within 32 bits
  constexpr std::size_t ahead = 8;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    if (i + 2 * ahead < triangles.size()) hwy::Prefetch(&indices[triangles[i + 2 * ahead]]);
    if (i + ahead < triangles.size()) {
      const Vec3u& next = indices[triangles[i + ahead]];
      hwy::Prefetch(&vertices[next[0]]);
      hwy::Prefetch(&vertices[next[1]]);
      hwy::Prefetch(&vertices[next[2]]);
    }
    const std::uint32_t id = triangles[i];
    const Vec3u& index = indices[id];
    const Vertex& a = vertices[index[0]];
    const Vertex* b = &vertices[index[1]];
    const Vertex* c = &vertices[index[2]];
    const std::int64_t area =
        std::int64_t(b->x - a.x) * (c->y - a.y) - std::int64_t(c->x - a.x) * (b->y - a.y);
    if (area == 0) continue;
    if (area < 0) std::swap(b, c);
    const Box box = pixel_box(a, *b, *c, rect);
    if (box.x0 > box.x1 || box.y0 > box.y1) continue;
    const auto [left, right] = std::minmax({a.x, b->x, c->x});
    const auto [top, bottom] = std::minmax({a.y, b->y, c->y});
    if (right - left <= small && bottom - top <= small) {
      draw_small(a, *b, *c, box, rect, id, tile);
    } else {
      draw_large(a, *b, *c, box, rect, id, tile);
    }
  }
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
