#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "normalshop/chart/storage.h"
#include "normalshop/chart/texel_writes.h"
#include "normalshop/chart/triangle_tiles.h"

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

/// Adds a texel's surface point on a triangle that covers it.
inline void add_texel(const TexelMap& texels, std::uint32_t triangle, int x, int y,
                      TriangleCache<PushTriangle>& triangles, TexelBatch& batch) {
  const SurfacePoint p = texels.surface_point(triangle, x, y);
  batch.add_point(triangles.get(triangle), {1.0F, p.b1, p.b2});
}

/// Frames that decode the texels, for maps of that space.
inline void fill_frames(const Mesh& mesh, const View& view, NormalSpace space,
                        const PerLane<std::uint32_t>& triangles, TexelBatch& batch) {
  if (space == NormalSpace::Tangent) return finish_frames(batch);
  for (int i = 0; i < batch.count; ++i) {
    Mat3f frame;
    frame << view.right.transpose(), view.up.transpose(), view.direction.transpose();
    if (space == NormalSpace::Object) {
      frame *= mesh.node_frame(triangles[static_cast<std::size_t>(i)]);
    }
    batch.set_frame(i, frame);
  }
}

/// What the map holds at the lanes' texels, for apply(). Texels side by side are read in one go.
inline void read_stored(const NormalMap& map, TexelLanes& lanes) {
  PerLane<Vec3f> row;
  for (int begin = 0; begin < lanes.batch.count;) {
    const std::uint32_t first = lanes.texels[static_cast<std::size_t>(begin)];
    const auto [x, y] = texel_place(first, map.width());
    const int most = std::min(lanes.batch.count - begin, map.width() - x);
    int count = 1;
    while (count < most && lanes.texels[static_cast<std::size_t>(begin + count)] ==
                               first + static_cast<std::uint32_t>(count)) {
      ++count;
    }
    map.read_vectors(x, count, y, row.data());
    for (int i = 0; i < count; ++i) {
      lanes.batch.stored.set(begin + i, row[static_cast<std::size_t>(i)]);
    }
    begin += count;
  }
}

/// The texels whose owners are wanted(triangle), row by row. One for each task: it keeps what tiles
/// have in common.
template <class Wanted>
class TexelRows {
 public:
  TexelRows(const Mesh& mesh, const ChartGrid& grid, const TexelMap& map, const Wanted& wanted)
      : map_(map), wanted_(wanted), triangles_(mesh, grid) {}

  /// visit(lanes) for each row of a tile of NormalMap::tile_size that holds such texels.
  template <class Visit>
  void visit(const Rect& tile, const Visit& visit) {
    for (int row = -4; row < 0; ++row) look_ahead(tile, row);
    for (int row = 0; row < tile.height(); ++row) {
      look_ahead(tile, row);
      add_runs(runs_[static_cast<std::size_t>(row)], tile.y0 + row);
      if (lanes_.batch.count > 0) visit(lanes_);
    }
  }

 private:
  static_assert(NormalMap::tile_size <= TexelBatch::capacity);
  /// Texels side by side of one owner.
  struct Run {
    int x;
    int count;
    std::uint32_t owner;
  };

  /// Rows are looked through 4 ahead, and their triangles fetched in two steps.
  void look_ahead(const Rect& tile, int row) {
    if (row + 4 < tile.height()) {
      std::vector<Run>& runs = runs_[static_cast<std::size_t>(row + 4)];
      find_runs(tile, tile.y0 + row + 4, runs);
      for (const Run& run : runs) triangles_.announce_attributes(run.owner);
    }
    if (row + 2 < 0 || row + 2 >= tile.height()) return;
    for (const Run& run : runs_[static_cast<std::size_t>(row + 2)]) {
      triangles_.announce_positions(run.owner);
    }
  }

  void find_runs(const Rect& tile, int y, std::vector<Run>& runs) const {
    const std::uint32_t* owners = map_.owner().row(y);
    runs.clear();
    for (int x = tile.x0; x < tile.x1;) {
      const int begin = x;
      const std::uint32_t owner = owners[begin];
      while (x < tile.x1 && owners[x] == owner) ++x;
      if (owner != no_triangle && wanted_(owner)) runs.push_back({begin, x - begin, owner});
    }
  }

  void add_runs(const std::vector<Run>& runs, int y) {
    lanes_.batch.count = 0;
    for (const Run& run : runs) {
      const auto lane = static_cast<std::size_t>(lanes_.batch.count);
      for (int i = 0; i < run.count; ++i) {
        const std::size_t k = lane + static_cast<std::size_t>(i);
        lanes_.texels[k] = texel_index(run.x + i, y, map_.width());
        lanes_.triangles[k] = run.owner;
      }
      add(run, y);
    }
  }

  void add(const Run& run, int y) {
    const TexelAffine& affine = map_.affines()[run.owner];
    if (!affine.wraps) {
      add_run(triangles_.get(run.owner), affine, run.x, y, run.count, lanes_.batch);
      return;
    }
    for (int i = 0; i < run.count; ++i) {
      add_texel(map_, run.owner, run.x + i, y, triangles_, lanes_.batch);
    }
  }

  const TexelMap& map_;
  Wanted wanted_;
  TriangleCache<PushTriangle> triangles_;
  std::array<std::vector<Run>, NormalMap::tile_size> runs_;  // by row of the tile
  TexelLanes lanes_;
};

/// visit(lanes) for the texels that wanted(triangle) owners have in all of the map; tiles are the
/// tasks.
template <class Wanted, class Visit>
void walk_owned(const Mesh& mesh, const ChartGrid& grid, const TexelMap& map, const Wanted& wanted,
                const Visit& visit) {
  const int tiles = NormalMap::tiles_along(map.width()) * NormalMap::tiles_along(map.height());
  parallel_for(static_cast<std::size_t>(tiles), 4, [&](std::size_t a, std::size_t b) {
    TexelRows rows(mesh, grid, map, wanted);
    for (std::size_t i = a; i < b; ++i) {
      rows.visit(tile_texels(static_cast<int>(i), map.width(), map.height()), visit);
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
        add_texel(map, s.triangle, at.x, at.y, triangles, lanes.batch);
      }
      if (any) visit(lanes);
    }
  });
}

}  // namespace normalshop
