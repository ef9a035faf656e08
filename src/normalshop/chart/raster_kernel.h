#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "normalshop/chart/rasterizer.h"

/// The rasteriser's inner loop, private to floor 4.
namespace normalshop::raster {

inline constexpr int tile_size = 64;
inline constexpr int block_size = 8;
inline constexpr int row_padding = 64;  ///< room for the widest vector past a row's end
inline constexpr int stride = tile_size + row_padding;

/// A tile's pixels while its triangles are drawn: rows of `stride`.
struct Tile {
  alignas(64) std::array<float, tile_size * stride> depth;
  alignas(64) std::array<std::uint32_t, tile_size * stride> triangle;
};

/// Where a tile lies in the window (pixels) and how much of it is in the image.
struct TileRect {
  int x;
  int y;
  int width;
  int height;
};

/// Draws triangles into a tile in the order given.
void draw(const TileRect& rect, std::span<const std::uint32_t> triangles,
          const Rasterizer::Vertex* vertices, const Vec3u* indices, Tile& tile);

}  // namespace normalshop::raster
