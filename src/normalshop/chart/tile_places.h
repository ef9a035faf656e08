#pragma once

#include <cstdint>
#include <vector>

#include "normalshop/chart/grid.h"
#include "normalshop/core/normal_map.h"
#include "normalshop/core/pixel_blocks.h"
#include "normalshop/surface/texel_map.h"

/// Where the tiles of an atlas lie in a chart, private to floor 4.
namespace normalshop {

/// Pixels beyond a point from which a bicubic kernel may read.
inline constexpr float bicubic_reach = 3.0F;

/// Boxes of chart pixels around what faces the viewer of each tile of one texture set: of the
/// texels themselves, and of the surface points that its gutter and shared texels stand for.
class TilePlaces {
 public:
  TilePlaces(const Mesh& mesh, const TexelMap& texels, std::uint32_t texture_set,
             const ChartGrid& grid);

  /// Tiles with anything in marked blocks or so near that a bicubic kernel reads there, rising.
  std::vector<int> meeting(const PixelBlocks& blocks) const;
  /// All shared texels of some tiles, by texel.
  std::vector<SharedTexel> shared_of(const std::vector<int>& tiles) const;
  bool shares(int tile) const {
    const auto t = static_cast<std::size_t>(tile);
    return shared_.first[t] != shared_.first[t + 1];
  }
  /// All entries of the gutter texels of some tiles of which at least one lies so near to marked
  /// blocks.
  std::vector<GutterTexel> gutter_of(const std::vector<int>& tiles,
                                     const PixelBlocks& blocks) const;

 private:
  struct Box {
    int x0;
    int y0;
    int x1;  ///< one past the end
    int y1;
  };
  /// Entries of a list of texels by tile: those of tile t are order[first[t]] to
  /// order[first[t + 1]].
  struct ByTile {
    std::vector<std::uint32_t> first;
    std::vector<std::uint32_t> order;
  };
  template <class Item>
  ByTile by_tile(const std::vector<Item>& items) const;
  int tile_of(std::uint32_t texel) const;
  void add_triangles();
  void add_triangle(std::uint32_t triangle);
  Vec2f add_point(int tile, const SurfacePoint& point);
  void grow(int tile, const Vec2f& low, const Vec2f& high);
  void box_gutter();

  const Mesh& mesh_;
  const TexelMap& texels_;
  std::uint32_t texture_set_;
  ChartGrid grid_;
  int columns_;
  std::vector<Box> boxes_;
  ByTile gutter_;
  static constexpr std::size_t gutter_run = 32;
  struct PointBox {
    Vec2f low;
    Vec2f high;
  };
  std::vector<PointBox> gutter_boxes_;  // around so many points each, those far away aside
  std::vector<Vec2f> gutter_points_;    // of gutter_.order: pixels, far away where they face away
  ByTile shared_;
};

}  // namespace normalshop
