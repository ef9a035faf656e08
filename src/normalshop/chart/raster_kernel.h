#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "normalshop/chart/rasterizer.h"

/// The rasteriser's inner loop, private to floor 4.
namespace normalshop::raster {

inline constexpr int tile_size = 64;
inline constexpr int block_size = 8;
inline constexpr int row_padding = 16;  ///< room for the widest vector past a row's end
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

inline constexpr int unit_bits = 8;
inline constexpr int unit = 1 << unit_bits;  ///< a vertex's steps a pixel

/// Pixels of an area whose centres lie in a triangle's box; empty when x1 <= x0 or y1 <= y0.
inline Rect covered_pixels(const Rasterizer::Vertex& a, const Rasterizer::Vertex& b,
                           const Rasterizer::Vertex& c, const Rect& area) {
  const auto first = [](int u, int v, int w) {  // centres there or after
    return (std::min(std::min(u, v), w) + unit / 2 - 1) >> unit_bits;
  };
  const auto end = [](int u, int v, int w) {
    return ((std::max(std::max(u, v), w) - unit / 2) >> unit_bits) + 1;
  };
  return {std::max(first(a.x, b.x, c.x), area.x0), std::max(first(a.y, b.y, c.y), area.y0),
          std::min(end(a.x, b.x, c.x), area.x1), std::min(end(a.y, b.y, c.y), area.y1)};
}

/// Draws triangles into a tile in the order given.
void draw(const TileRect& rect, std::span<const std::uint32_t> triangles,
          const Rasterizer::Vertex* vertices, const Vec3u* indices, Tile& tile);

}  // namespace normalshop::raster
