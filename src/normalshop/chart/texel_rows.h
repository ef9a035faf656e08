#pragma once

#include <array>
#include <vector>

#include "normalshop/chart/push_candidates.h"
#include "normalshop/chart/texel_writes.h"

/// Walking the texels of a map for a push, private to floor 4.
namespace normalshop {

/// Adds a texel's surface point on a triangle that covers it.
void add_texel(const TexelMap& texels, std::uint32_t triangle, int x, int y,
               TriangleCache<PushTriangle>& triangles, TexelBatch& batch);

/// The texels that candidates own, row by row. One for each task: it keeps what tiles have in
/// common.
class TexelRows {
 public:
  /// A row of a tile: batch.count texels, from left to right, with their surface points.
  struct Row {
    int y;
    const PerLane<int>& columns;
    const PerLane<std::uint32_t>& owners;
    TexelBatch& batch;
  };

  TexelRows(const Mesh& mesh, const ChartGrid& grid, const TexelMap& texels,
            const PushCandidates& candidates)
      : texels_(texels), candidates_(candidates), triangles_(mesh, grid) {}

  /// Calls visit(row) for each row of a tile of NormalMap::tile_size that holds such texels.
  template <class Visit>
  void visit(const Rect& tile, const Visit& visit);

 private:
  /// Texels side by side that one candidate owns.
  struct Run {
    int x;
    int count;
    std::uint32_t owner;
  };
  void look_ahead(const Rect& tile, int row);
  void find_runs(const Rect& tile, int y, std::vector<Run>& runs) const;
  void add_runs(const std::vector<Run>& runs, int y);
  void add_run_of(const Run& run, int y);

  const TexelMap& texels_;
  const PushCandidates& candidates_;
  TriangleCache<PushTriangle> triangles_;
  std::array<std::vector<Run>, NormalMap::tile_size> runs_;  // by row of the tile
  TexelBatch batch_;
  PerLane<int> columns_;
  PerLane<std::uint32_t> owners_;
};

template <class Visit>
void TexelRows::visit(const Rect& tile, const Visit& visit) {
  for (int row = -4; row < 0; ++row) look_ahead(tile, row);
  for (int row = 0; row < tile.height(); ++row) {
    look_ahead(tile, row);
    add_runs(runs_[static_cast<std::size_t>(row)], tile.y0 + row);
    if (batch_.count > 0) visit(Row{tile.y0 + row, columns_, owners_, batch_});
  }
}

}  // namespace normalshop
