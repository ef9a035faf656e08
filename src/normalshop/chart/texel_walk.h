#pragma once

#include <algorithm>
#include <vector>

#include "normalshop/chart/storage.h"
#include "normalshop/chart/texel_writes.h"

/// Walks over the texels of a texture set, private to floor 4.
namespace normalshop {

/// Texels on their way through a walk, as lanes.
struct TexelLanes {
  TexelBatch batch;               ///< with frames as far as add_run() and add_point() give them
  PerLane<std::uint32_t> texels;  ///< y * width + x
  PerLane<std::uint32_t> triangles;
  std::uint32_t first_shared = 0;  ///< of listed lanes: index of the first in TexelMap::shared()
  bool listed = false;             ///< shared texels; else from left to right in one row
};

/// visit(lanes) for the texels that wanted(triangle) owners have, a row of a tile at a time; tiles
/// of NormalMap::tile_size are the tasks.
template <class Wanted, class Visit>
void walk_owned(const Mesh& mesh, const ChartGrid& grid, const TexelMap& map, const Wanted& wanted,
                const Visit& visit) {
  constexpr int side = NormalMap::tile_size;
  static_assert(side <= TexelBatch::capacity);
  const int columns = (map.width() + side - 1) / side;
  const int rows = (map.height() + side - 1) / side;
  const auto add = [&](std::uint32_t owner, int x, int y, int count,
                       TriangleCache<PushTriangle>& triangles, TexelLanes& lanes) {
    const TexelAffine& affine = map.affines()[owner];
    auto lane = static_cast<std::size_t>(lanes.batch.count);
    const auto first = static_cast<std::uint32_t>(y) * static_cast<std::uint32_t>(map.width());
    for (int i = x; i < x + count; ++i, ++lane) {
      lanes.texels[lane] = first + static_cast<std::uint32_t>(i);
      lanes.triangles[lane] = owner;
    }
    if (!affine.wraps) return add_run(triangles.get(owner), affine, x, y, count, lanes.batch);
    for (int i = x; i < x + count; ++i) {
      const SurfacePoint p = map.surface_point(owner, i, y);
      lanes.batch.add_point(triangles.get(owner), {1.0F, p.b1, p.b2});
    }
  };
  parallel_for(static_cast<std::size_t>(columns * rows), 4, [&](std::size_t a, std::size_t b) {
    TriangleCache<PushTriangle> triangles(mesh, grid);
    TexelLanes lanes;
    for (std::size_t i = a; i < b; ++i) {
      const int x0 = static_cast<int>(i) % columns * side;
      const int x1 = std::min(x0 + side, map.width());
      const int y0 = static_cast<int>(i) / columns * side;
      for (int y = y0; y < std::min(y0 + side, map.height()); ++y) {
        const std::uint32_t* owners = map.owner().row(y);
        lanes.batch.count = 0;
        for (int x = x0; x < x1;) {
          const int begin = x;
          const std::uint32_t owner = owners[begin];
          while (x < x1 && owners[x] == owner) ++x;
          if (owner != no_triangle && wanted(owner)) {
            add(owner, begin, y, x - begin, triangles, lanes);
          }
        }
        if (lanes.batch.count > 0) visit(lanes);
      }
    }
  });
}

/// The same for the texels that wanted(triangle) triangles share with their owners.
template <class Wanted, class Visit>
void walk_shared(const Mesh& mesh, const ChartGrid& grid, const TexelMap& map, const Wanted& wanted,
                 const Visit& visit) {
  const std::vector<SharedTexel>& shared = map.shared();
  constexpr std::size_t run = TexelBatch::capacity;
  parallel_for((shared.size() + run - 1) / run, 16, [&](std::size_t begin, std::size_t end) {
    TriangleCache<PushTriangle> triangles(mesh, grid);
    TexelLanes lanes;
    lanes.listed = true;
    for (std::size_t part = begin; part < end; ++part) {
      const std::size_t first = part * run;
      const std::size_t last = std::min(first + run, shared.size());
      lanes.batch.count = 0;
      lanes.first_shared = static_cast<std::uint32_t>(first);
      bool any = false;
      for (std::size_t i = first; i < last; ++i) {
        const SharedTexel& s = shared[i];
        any = any || wanted(s.triangle);
        lanes.texels[i - first] = s.texel;
        lanes.triangles[i - first] = s.triangle;
        const TexelPlace at = texel_place(s.texel, map.width());
        const SurfacePoint p = map.surface_point(s.triangle, at.x, at.y);
        lanes.batch.add_point(triangles.get(s.triangle), {1.0F, p.b1, p.b2});
      }
      if (any) visit(lanes);
    }
  });
}

}  // namespace normalshop
