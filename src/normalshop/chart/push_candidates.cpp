#include "normalshop/chart/push_candidates.h"

#include <algorithm>
#include <atomic>

#include "normalshop/chart/triangle_tiles.h"
#include "normalshop/core/parallel.h"

namespace normalshop {

PushCandidates::PushCandidates(const Mesh& mesh, const EditReach& reach, std::uint32_t texture_set,
                               int width, int height)
    : mesh_(mesh),
      texture_set_(texture_set),
      width_(width),
      height_(height),
      tile_columns_(NormalMap::tiles_along(width)),
      triangles_(mesh.triangle_count(), 0),
      tiles_(static_cast<std::size_t>(tile_columns_ * NormalMap::tiles_along(height)), 0) {
  parallel_for(mesh.triangle_count(), 8192, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto triangle = static_cast<std::uint32_t>(i);
      if (!may_change(reach, triangle)) continue;
      triangles_[i] = 1;
      mark_tiles(triangle);
    }
  });
}

bool PushCandidates::may_change(const EditReach& reach, std::uint32_t triangle) const {
  if (mesh_.texture_sets[triangle] != texture_set_) return false;
  const std::size_t corner = 3 * static_cast<std::size_t>(triangle);
  const ChartGrid& grid = reach.grid();
  if (faces_away(mesh_, triangle, grid.view.direction)) return false;
  const Vec3f a = grid.project(mesh_.position(corner));
  const Vec3f b = grid.project(mesh_.position(corner + 1));
  const Vec3f c = grid.project(mesh_.position(corner + 2));
  const Vec3f low = a.cwiseMin(b).cwiseMin(c);
  const Vec3f high = a.cwiseMax(b).cwiseMax(c);
  return reach.reaches(low.x(), low.y(), high.x(), high.y());
}

void PushCandidates::mark_tiles(std::uint32_t triangle) {
  visit_tiles(mesh_, triangle, width_, height_, [&](int tile, const Rect&) {
    // Several threads may mark one tile; the mark is the same.
    std::atomic_ref(tiles_[static_cast<std::size_t>(tile)]).store(1, std::memory_order_relaxed);
  });
}

std::vector<Rect> PushCandidates::tiles() const {
  std::vector<Rect> out;
  for (int i = 0; i < static_cast<int>(tiles_.size()); ++i) {
    if (tiles_[static_cast<std::size_t>(i)] == 0) continue;
    out.push_back(tile_texels(i, width_, height_));
  }
  return out;
}

}  // namespace normalshop
