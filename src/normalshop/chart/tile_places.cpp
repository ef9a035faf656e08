#include "normalshop/chart/tile_places.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "normalshop/chart/shared_texels.h"
#include "normalshop/chart/triangle_tiles.h"
#include "normalshop/core/parallel.h"

namespace normalshop {

namespace {

void lower(int& place, int value) {
  const std::atomic_ref atomic(place);
  int now = atomic.load(std::memory_order_relaxed);
  while (value < now && !atomic.compare_exchange_weak(now, value, std::memory_order_relaxed)) {
  }
}

void raise(int& place, int value) {
  const std::atomic_ref atomic(place);
  int now = atomic.load(std::memory_order_relaxed);
  while (value > now && !atomic.compare_exchange_weak(now, value, std::memory_order_relaxed)) {
  }
}

/// A place of what faces away.
constexpr float far_away = -1e9F;

/// Whatever a stray vertex gives stays within what int holds.
int pixel(float v) { return static_cast<int>(v > -1e6F ? std::min(v, 1e6F) : -1e6F); }

/// Those entries of a list, in its order.
template <class Item>
std::vector<Item> sorted(const std::vector<Item>& items, std::vector<std::uint32_t> entries) {
  std::sort(entries.begin(), entries.end());
  std::vector<Item> out;
  out.reserve(entries.size());
  for (const std::uint32_t i : entries) out.push_back(items[i]);
  return out;
}

}  // namespace

TilePlaces::TilePlaces(const Mesh& mesh, const TexelMap& texels, std::uint32_t texture_set,
                       const ChartGrid& grid)
    : mesh_(mesh),
      texels_(texels),
      texture_set_(texture_set),
      grid_(grid),
      columns_(NormalMap::tiles_along(texels.width())) {
  constexpr int most = std::numeric_limits<int>::max();
  boxes_.resize(static_cast<std::size_t>(columns_) *
                    static_cast<std::size_t>(NormalMap::tiles_along(texels.height())),
                Box{most, most, -most, -most});
  gutter_ = by_tile(texels.gutter());
  shared_ = by_tile(texels.shared());
  add_triangles();
  gutter_points_.resize(texels.gutter().size());
  parallel_for(texels.gutter().size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const GutterTexel& g = texels_.gutter()[gutter_.order[i]];
      gutter_points_[i] = add_point(tile_of(g.texel), gutter_source(g));
    }
  });
  box_gutter();
  parallel_for(texels.shared().size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const SharedTexel& s = texels_.shared()[i];
      const auto [x, y] = texel_place(s.texel, texels_.width());
      add_point(tile_of(s.texel), texels_.surface_point(s.triangle, x, y));
    }
  });
}

int TilePlaces::tile_of(std::uint32_t texel) const {
  const auto [x, y] = texel_place(texel, texels_.width());
  return y / NormalMap::tile_size * columns_ + x / NormalMap::tile_size;
}

template <class Item>
TilePlaces::ByTile TilePlaces::by_tile(const std::vector<Item>& items) const {
  ByTile out;
  out.first.assign(boxes_.size() + 1, 0);
  for (const Item& item : items) ++out.first[static_cast<std::size_t>(tile_of(item.texel)) + 1];
  for (std::size_t t = 0; t < boxes_.size(); ++t) out.first[t + 1] += out.first[t];
  std::vector<std::uint32_t> next(out.first.begin(), out.first.end() - 1);
  out.order.resize(items.size());
  for (std::size_t i = 0; i < items.size(); ++i) {
    out.order[next[static_cast<std::size_t>(tile_of(items[i].texel))]++] =
        static_cast<std::uint32_t>(i);
  }
  return out;
}

void TilePlaces::box_gutter() {
  constexpr float most = std::numeric_limits<float>::max();
  const PointBox none{Vec2f::Constant(most), Vec2f::Constant(-most)};
  gutter_boxes_.assign((gutter_points_.size() + gutter_run - 1) / gutter_run, none);
  for (std::size_t i = 0; i < gutter_points_.size(); ++i) {
    const Vec2f& p = gutter_points_[i];
    if (!(p.x() > far_away)) continue;
    PointBox& box = gutter_boxes_[i / gutter_run];
    box.low = box.low.cwiseMin(p);
    box.high = box.high.cwiseMax(p);
  }
}

void TilePlaces::add_triangles() {
  parallel_for(mesh_.triangle_count(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto triangle = static_cast<std::uint32_t>(i);
      if (mesh_.texture_sets[i] != texture_set_ || texels_.affines()[i].degenerate ||
          faces_away(mesh_, triangle, grid_.view.direction)) {
        continue;
      }
      add_triangle(triangle);
    }
  });
}

void TilePlaces::add_triangle(std::uint32_t triangle) {
  const std::size_t corner = 3 * static_cast<std::size_t>(triangle);
  const Vec2f a = grid_.project(mesh_.position(corner)).head<2>();
  const Vec2f b = grid_.project(mesh_.position(corner + 1)).head<2>();
  const Vec2f c = grid_.project(mesh_.position(corner + 2)).head<2>();
  const Vec2f low = a.cwiseMin(b).cwiseMin(c);
  const Vec2f high = a.cwiseMax(b).cwiseMax(c);
  const TexelAffine& affine = texels_.affines()[triangle];
  const auto place = [&](int x, int y) -> Vec2f {
    const Vec2f weights = affine.at(static_cast<float>(x), static_cast<float>(y));
    return a + weights.x() * (b - a) + weights.y() * (c - a);
  };
  visit_tiles(mesh_, triangle, texels_.width(), texels_.height(), [&](int tile, const Rect& r) {
    if (affine.wraps) return grow(tile, low, high);
    const Vec2f p = place(r.x0, r.y0);
    const Vec2f q = place(r.x1, r.y0);
    const Vec2f s = place(r.x0, r.y1);
    const Vec2f t = place(r.x1, r.y1);
    const Vec2f margin = Vec2f::Ones();
    grow(tile, p.cwiseMin(q).cwiseMin(s.cwiseMin(t)).cwiseMax(low) - margin,
         p.cwiseMax(q).cwiseMax(s.cwiseMax(t)).cwiseMin(high) + margin);
  });
}

Vec2f TilePlaces::add_point(int tile, const SurfacePoint& point) {
  if (faces_away(mesh_, point.triangle, grid_.view.direction)) return Vec2f::Constant(far_away);
  const std::size_t corner = 3 * static_cast<std::size_t>(point.triangle);
  const Vec3f position = interpolate(mesh_.position(corner), mesh_.position(corner + 1),
                                     mesh_.position(corner + 2), point.b1, point.b2);
  Vec2f p = grid_.project(position).head<2>();
  grow(tile, p, p);
  return p;
}

void TilePlaces::grow(int tile, const Vec2f& low, const Vec2f& high) {
  if (!low.allFinite() || !high.allFinite()) return;
  Box& box = boxes_[static_cast<std::size_t>(tile)];
  lower(box.x0, pixel(std::floor(low.x())));
  lower(box.y0, pixel(std::floor(low.y())));
  raise(box.x1, pixel(std::floor(high.x())) + 1);
  raise(box.y1, pixel(std::floor(high.y())) + 1);
}

std::vector<int> TilePlaces::meeting(const PixelBlocks& blocks) const {
  const Rect pixels = normalshop::grow(blocks.region(), static_cast<int>(bicubic_reach));
  std::vector<int> out;
  for (std::size_t i = 0; i < boxes_.size(); ++i) {
    const Box& b = boxes_[i];
    const bool meets = b.x0 < pixels.x1 && b.x1 > pixels.x0 && b.y0 < pixels.y1 && b.y1 > pixels.y0;
    if (meets &&
        blocks.any_near(static_cast<float>(b.x0), static_cast<float>(b.y0),
                        static_cast<float>(b.x1), static_cast<float>(b.y1), bicubic_reach)) {
      out.push_back(static_cast<int>(i));
    }
  }
  return out;
}

std::vector<SharedTexel> TilePlaces::shared_of(const std::vector<int>& tiles) const {
  std::vector<std::uint32_t> entries;
  for (const int t : tiles) {
    const auto i = static_cast<std::size_t>(t);
    entries.insert(entries.end(), shared_.order.begin() + shared_.first[i],
                   shared_.order.begin() + shared_.first[i + 1]);
  }
  return sorted(texels_.shared(), std::move(entries));
}

std::vector<GutterTexel> TilePlaces::gutter_of(const std::vector<int>& tiles,
                                               const PixelBlocks& blocks) const {
  const auto near = [&](const Vec2f& low, const Vec2f& high) {
    return low.x() <= high.x() &&
           blocks.any_near(low.x(), low.y(), high.x(), high.y(), bicubic_reach);
  };
  std::vector<std::uint32_t> entries;
  for (const int t : tiles) {
    const auto tile = static_cast<std::size_t>(t);
    const std::uint32_t first = gutter_.first[tile];
    const std::uint32_t last = gutter_.first[tile + 1];
    const auto texel_of = [&](std::uint32_t i) { return texels_.gutter()[gutter_.order[i]].texel; };
    for (std::uint32_t i = first; i < last; ++i) {
      const PointBox& box = gutter_boxes_[i / gutter_run];
      if ((i == first || i % gutter_run == 0) && !near(box.low, box.high)) {
        i |= static_cast<std::uint32_t>(gutter_run - 1);  // the last of the box
        continue;
      }
      const Vec2f& p = gutter_points_[i];
      if (!(p.x() > far_away) || !near(p, p)) continue;
      std::uint32_t begin = i;
      while (begin > first && texel_of(begin - 1) == texel_of(i)) --begin;
      while (i + 1 < last && texel_of(i + 1) == texel_of(i)) ++i;
      entries.insert(entries.end(), gutter_.order.begin() + begin, gutter_.order.begin() + i + 1);
    }
  }
  return sorted(texels_.gutter(), std::move(entries));
}

}  // namespace normalshop
