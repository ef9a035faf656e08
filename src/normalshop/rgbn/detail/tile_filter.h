#pragma once

#include <algorithm>
#include <cstddef>

#include "normalshop/core/image.h"
#include "normalshop/core/parallel.h"

/// Filters of finite length over tiles that fit the cache; private to this floor.
namespace normalshop {

/// How a region is cut into tiles. A tile is held with the pixels that it reads around it.
struct TileSize {
  TileSize(const Rect& region, int radius_x, int radius_y, int pixel_channels)
      : reach_x(radius_x), reach_y(radius_y), channels(pixel_channels) {
    // Long rows, which memory delivers fastest; more of them where most would be surroundings.
    width = std::min(region.width(), std::max(8192 / channels, 4 * reach_x));
    height = std::min(region.height(), std::max(32, 2 * reach_y));
  }
  std::ptrdiff_t stride() const { return (width + 2 * reach_x) * channels; }
  int reach_x;
  int reach_y;
  int channels;
  int width;
  int height;
};

/// One row of a tile and what it is computed from: numbers, `stride` apart from row to row.
struct Tile {
  const float* at;  ///< the first number of the row
  std::ptrdiff_t stride;
  std::ptrdiff_t count;  ///< numbers of the row
};

/// Computes `region` row by row of every tile: with `rows` being ExtendedRows, it calls
///     filter_row(tile, scratch, out),
/// where `scratch` has room for three rows with their surroundings. out = store.begin(x0, y, free)
/// is the place of the result or `free`, which has room for two rows; then it calls store.end(x0,
/// x1, y, out).
template <class Rows, class FilterRow, class Store>
void filter_tiles(const Rows& rows, const Rect& region, const TileSize& size,
                  const FilterRow& filter_row, const Store& store) {
  constexpr int channels = Rows::channels;
  const auto stride = static_cast<int>(size.stride());
  const int across = (region.width() + size.width - 1) / size.width;
  const int down = (region.height() + size.height - 1) / size.height;
  parallel_for(static_cast<std::size_t>(across * down), 1, [&](std::size_t a, std::size_t b) {
    Image<float> held(stride, size.height + 2 * size.reach_y);
    Image<float> scratch(stride, 5);
    for (int i = static_cast<int>(a); i < static_cast<int>(b); ++i) {
      const int x0 = region.x0 + i % across * size.width;
      const int y0 = region.y0 + i / across * size.height;
      const int x1 = std::min(x0 + size.width, region.x1);
      const int y1 = std::min(y0 + size.height, region.y1);
      for (int y = y0 - size.reach_y; y < y1 + size.reach_y; ++y) {
        rows.read(x0 - size.reach_x, x1 + size.reach_x, y, held.row(y - y0 + size.reach_y));
      }
      for (int y = y0; y < y1; ++y) {
        const float* at = held.row(y - y0 + size.reach_y) + size.reach_x * channels;
        float* out = store.begin(x0, y, scratch.row(3));
        filter_row(Tile{at, stride, (x1 - x0) * channels}, scratch.data(), out);
        store.end(x0, x1, y, out);
      }
    }
  });
}

}  // namespace normalshop
