#include "normalshop/chart/texel_rows.h"

namespace normalshop {

void add_texel(const TexelMap& texels, std::uint32_t triangle, int x, int y,
               TriangleCache<PushTriangle>& triangles, TexelBatch& batch) {
  const SurfacePoint p = texels.surface_point(triangle, x, y);
  batch.add_point(triangles.get(triangle), {1.0F, p.b1, p.b2});
}

/// Rows are looked through 4 ahead, and their triangles fetched in two steps.
void TexelRows::look_ahead(const Rect& tile, int row) {
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

void TexelRows::find_runs(const Rect& tile, int y, std::vector<Run>& runs) const {
  const std::uint32_t* owners = texels_.owner().row(y);
  runs.clear();
  for (int x = tile.x0; x < tile.x1;) {
    const int begin = x;
    const std::uint32_t owner = owners[begin];
    while (x < tile.x1 && owners[x] == owner) ++x;
    if (owner == no_triangle || !candidates_.contains(owner)) continue;
    runs.push_back({begin, x - begin, owner});
  }
}

void TexelRows::add_runs(const std::vector<Run>& runs, int y) {
  batch_.count = 0;
  for (const Run& run : runs) {
    const auto lane = static_cast<std::size_t>(batch_.count);
    for (int i = 0; i < run.count; ++i) {
      columns_[lane + static_cast<std::size_t>(i)] = run.x + i;
      owners_[lane + static_cast<std::size_t>(i)] = run.owner;
    }
    add_run_of(run, y);
  }
}

void TexelRows::add_run_of(const Run& run, int y) {
  const TexelAffine& affine = texels_.affines()[run.owner];
  if (!affine.wraps) {
    add_run(triangles_.get(run.owner), affine, run.x, y, run.count, batch_);
    return;
  }
  for (int i = 0; i < run.count; ++i) {
    add_texel(texels_, run.owner, run.x + i, y, triangles_, batch_);
  }
}

}  // namespace normalshop
