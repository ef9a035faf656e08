#pragma once

#include <cstdint>
#include <vector>

#include "normalshop/chart/grid.h"
#include "normalshop/core/image.h"
#include "normalshop/surface/texel_map.h"

namespace normalshop {

/// What each pixel centre of a chart sees.
struct IdBuffer {
  Image<std::uint32_t> triangle;  ///< no_triangle where there is no surface
  Image<float> depth;  ///< object units along the view's direction from its centre; -inf for none
};

/// Do triangles that face away from the viewer show, and hide what is behind them?
enum class BackFaces { Draw, LeaveAway };

/// Our own rasteriser for orthographic charts: exact coverage (vertices snapped to 1/256 pixel,
/// top-left rule), both faces of every triangle. The nearest one wins; of equally near ones a front
/// face before a back face, then the first in file order, so the result does not depend on threads.
/// Keeps its buffers between calls.
class Rasterizer {
 public:
  void rasterize(const Mesh& mesh, const ChartGrid& grid, IdBuffer& out,
                 BackFaces back = BackFaces::Draw);

  /// A vertex in the window: 1/256 pixels (x right, y down) and depth.
  struct Vertex {
    std::int32_t x;
    std::int32_t y;
    float z;
  };
  struct TileBin {
    std::uint32_t tile;
    std::uint32_t triangle;
  };
  /// Triangles of a run of the mesh, sorted by tile.
  struct Chunk {
    std::vector<TileBin> unsorted;
    std::vector<std::uint32_t> triangles;
    std::vector<std::uint32_t> begin;  ///< per tile, plus one: where its triangles start
    std::vector<std::uint32_t> back_facing;
  };

 private:
  void project(const Mesh& mesh, const ChartGrid& grid);
  void bin_front(const Mesh& mesh);
  void bin_back(const Mesh& mesh);
  void draw_tiles(const Mesh& mesh, IdBuffer& out, bool front);

  std::int64_t turn_ = 1;  ///< with it, areas below 0 face the viewer: y runs down
  int width_ = 0;
  int height_ = 0;
  int tile_columns_ = 0;
  int tile_rows_ = 0;
  std::vector<Vertex> vertices_;
  std::vector<Chunk> chunks_;
  Image<float> farthest_;  ///< per block of 8 x 8 pixels: depth behind which nothing shows
};

}  // namespace normalshop
