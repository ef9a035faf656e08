#pragma once

#include <algorithm>

#include "normalshop/core/normal_map.h"
#include "normalshop/core/rect.h"
#include "normalshop/core/sample.h"
#include "normalshop/surface/mesh.h"

/// The tiles of an atlas, and what of it triangles cover, private to floor 4.
namespace normalshop {

/// Do all corners' base normals point away from the viewer?
inline bool faces_away(const Mesh& mesh, std::uint32_t triangle, const Vec3f& toward_viewer) {
  const std::size_t corner = 3 * static_cast<std::size_t>(triangle);
  return mesh.normals[corner].dot(toward_viewer) <= 0.0F &&
         mesh.normals[corner + 1].dot(toward_viewer) <= 0.0F &&
         mesh.normals[corner + 2].dot(toward_viewer) <= 0.0F;
}

/// The texels of a tile of NormalMap::tile_size, by its index row by row, in a map of that size.
inline Rect tile_texels(int tile, int width, int height) {
  constexpr int side = NormalMap::tile_size;
  const int columns = NormalMap::tiles_along(width);
  const int x = tile % columns * side;
  const int y = tile / columns * side;
  return {x, y, std::min(x + side, width), std::min(y + side, height)};
}

/// visit(tile, texels) for the tiles of NormalMap::tile_size that the box around a triangle's UVs
/// meets, in a repeating map of that size: the tile's index, row by row, and the texels in the box.
/// May visit a tile twice.
template <class Visit>
void visit_tiles(const Mesh& mesh, std::uint32_t triangle, int width, int height,
                 const Visit& visit) {
  constexpr int side = NormalMap::tile_size;
  const Vec2f size(static_cast<float>(width), static_cast<float>(height));
  const std::size_t corner = 3 * static_cast<std::size_t>(triangle);
  const Vec2f a = mesh.uvs[corner].cwiseProduct(size);
  const Vec2f b = mesh.uvs[corner + 1].cwiseProduct(size);
  const Vec2f c = mesh.uvs[corner + 2].cwiseProduct(size);
  const Vec2f low = a.cwiseMin(b).cwiseMin(c);
  const Vec2f high = a.cwiseMax(b).cwiseMax(c);
  const auto wrap = [](int v, int n) { return ((v % n) + n) % n; };
  // Whole maps further on come the same texels again.
  const int x0 = floor_to_int(low.x());
  const int y0 = floor_to_int(low.y());
  const int x1 = std::min(floor_to_int(high.x()), x0 + width) + 1;
  const int y1 = std::min(floor_to_int(high.y()), y0 + height) + 1;
  const auto step = [](int v, int end, int n, int w) {  // to the next tile, or to the next map
    return std::min({side - w % side, n - w, end - v});
  };
  for (int y = y0; y < y1;) {
    const int wy = wrap(y, height);
    const int rows = step(y, y1, height, wy);
    for (int x = x0; x < x1;) {
      const int wx = wrap(x, width);
      const int columns = step(x, x1, width, wx);
      visit(wy / side * NormalMap::tiles_along(width) + wx / side,
            Rect{wx, wy, wx + columns, wy + rows});
      x += columns;
    }
    y += rows;
  }
}

}  // namespace normalshop
