#include "normalshop/chart/rasterizer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "normalshop/chart/raster_kernel.h"
#include "normalshop/core/parallel.h"

namespace normalshop {

namespace {

using raster::block_size;
using raster::covered_pixels;
using raster::tile_size;
using Vertex = Rasterizer::Vertex;

constexpr std::size_t chunk_size = 16384;
constexpr float nothing = -std::numeric_limits<float>::infinity();

std::int64_t twice_area(const Vertex& a, const Vertex& b, const Vertex& c) {
  return std::int64_t(b.x - a.x) * (c.y - a.y) - std::int64_t(c.x - a.x) * (b.y - a.y);
}

void add_to_tiles(Rasterizer::Chunk& chunk, const Rect& pixels, int columns, std::uint32_t id) {
  const int tile_x = pixels.x0 / tile_size;
  const int tile_y = pixels.y0 / tile_size;
  if (tile_x == (pixels.x1 - 1) / tile_size && tile_y == (pixels.y1 - 1) / tile_size) {
    chunk.unsorted.push_back({static_cast<std::uint32_t>(tile_y * columns + tile_x), id});
    return;
  }
  for (int ty = pixels.y0 / tile_size; ty <= (pixels.y1 - 1) / tile_size; ++ty) {
    for (int tx = pixels.x0 / tile_size; tx <= (pixels.x1 - 1) / tile_size; ++tx) {
      chunk.unsorted.push_back({static_cast<std::uint32_t>(ty * columns + tx), id});
    }
  }
}

/// Counting sort by tile; keeps the order of the triangles within a tile.
void sort_by_tile(Rasterizer::Chunk& chunk, std::size_t tiles) {
  chunk.begin.assign(tiles + 1, 0);
  for (const auto& bin : chunk.unsorted) ++chunk.begin[bin.tile + 1];
  for (std::size_t i = 0; i < tiles; ++i) chunk.begin[i + 1] += chunk.begin[i];
  chunk.triangles.resize(chunk.unsorted.size());
  std::vector<std::uint32_t> next(chunk.begin.begin(), chunk.begin.end() - 1);
  for (const auto& bin : chunk.unsorted) chunk.triangles[next[bin.tile]++] = bin.triangle;
}

bool hidden(const Image<float>& farthest, const Rect& pixels, float nearest) {
  for (int y = pixels.y0 / block_size; y <= (pixels.y1 - 1) / block_size; ++y) {
    for (int x = pixels.x0 / block_size; x <= (pixels.x1 - 1) / block_size; ++x) {
      if (nearest > farthest(x, y)) return false;
    }
  }
  return true;
}

void load_tile(const raster::TileRect& rect, const IdBuffer& in, bool fresh, raster::Tile& tile) {
  if (fresh) {
    tile.depth.fill(nothing);
    tile.triangle.fill(no_triangle);
    return;
  }
  for (int y = 0; y < rect.height; ++y) {
    std::copy_n(in.depth.row(rect.y + y) + rect.x, rect.width,
                &tile.depth[std::size_t(y * raster::stride)]);
    std::copy_n(in.triangle.row(rect.y + y) + rect.x, rect.width,
                &tile.triangle[std::size_t(y * raster::stride)]);
  }
}

void store_tile(const raster::TileRect& rect, const raster::Tile& tile, IdBuffer& out) {
  for (int y = 0; y < rect.height; ++y) {
    std::copy_n(&tile.depth[std::size_t(y * raster::stride)], rect.width,
                out.depth.row(rect.y + y) + rect.x);
    std::copy_n(&tile.triangle[std::size_t(y * raster::stride)], rect.width,
                out.triangle.row(rect.y + y) + rect.x);
  }
}

void store_farthest(const raster::TileRect& rect, const raster::Tile& tile,
                    Image<float>& farthest) {
  for (int by = 0; by < rect.height; by += block_size) {
    for (int bx = 0; bx < rect.width; bx += block_size) {
      float value = std::numeric_limits<float>::infinity();
      for (int y = by; y < std::min(by + block_size, rect.height); ++y) {
        const float* row = &tile.depth[std::size_t(y * raster::stride)];
        for (int x = bx; x < std::min(bx + block_size, rect.width); ++x) {
          value = std::min(value, row[x]);
        }
      }
      farthest((rect.x + bx) / block_size, (rect.y + by) / block_size) = value;
    }
  }
}

}  // namespace

void Rasterizer::project(const Mesh& mesh, const ChartGrid& grid) {
  turn_ = grid.view.handedness() < 0.0F ? -1 : 1;
  vertices_.resize(mesh.positions.size());
  const float inverse = 256.0F / grid.pixel;
  const Vec3f right = grid.view.right * inverse;
  const Vec3f down = -grid.view.up * inverse;
  const Vec3f towards = grid.view.direction;
  // Subtracted after rounding: windows of one lattice share their pixels, bit for bit.
  const std::int32_t x0 = 256 * grid.window.x0;
  const std::int32_t y0 = 256 * grid.window.y0;
  const Vec3f center = grid.view.center;
  parallel_for(mesh.positions.size(), 32768, [&](std::size_t begin, std::size_t end) {
    constexpr float limit = 536870912.0F;  // 2^29: two million pixels
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3f p = mesh.positions[i] - center;
      const float x = std::clamp(p.dot(right), -limit, limit);
      const float y = std::clamp(p.dot(down), -limit, limit);
      vertices_[i] = {static_cast<std::int32_t>(std::lrintf(x)) - x0,
                      static_cast<std::int32_t>(std::lrintf(y)) - y0, p.dot(towards)};
    }
  });
}

void Rasterizer::bin_front(const Mesh& mesh) {
  const std::size_t count = mesh.triangle_count();
  chunks_.resize((count + chunk_size - 1) / chunk_size);
  parallel_for(chunks_.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Chunk& chunk = chunks_[i];
      chunk.unsorted.clear();
      chunk.back_facing.clear();
      for (std::size_t t = i * chunk_size; t < std::min(count, (i + 1) * chunk_size); ++t) {
        const Vec3u& index = mesh.triangles[t];
        const Vertex& a = vertices_[index[0]];
        const Vertex& b = vertices_[index[1]];
        const Vertex& c = vertices_[index[2]];
        const Rect pixels = covered_pixels(a, b, c, {0, 0, width_, height_});
        if (pixels.empty()) continue;
        const std::int64_t area = turn_ * twice_area(a, b, c);
        const auto id = static_cast<std::uint32_t>(t);
        if (area < 0) {
          add_to_tiles(chunk, pixels, tile_columns_, id);
        } else if (area > 0) {
          chunk.back_facing.push_back(id);
        }
      }
      sort_by_tile(chunk, static_cast<std::size_t>(tile_columns_ * tile_rows_));
    }
  });
}

void Rasterizer::bin_back(const Mesh& mesh) {
  parallel_for(chunks_.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Chunk& chunk = chunks_[i];
      chunk.unsorted.clear();
      for (const std::uint32_t id : chunk.back_facing) {
        const Vec3u& index = mesh.triangles[id];
        const Vertex& a = vertices_[index[0]];
        const Vertex& b = vertices_[index[1]];
        const Vertex& c = vertices_[index[2]];
        const Rect pixels = covered_pixels(a, b, c, {0, 0, width_, height_});
        if (hidden(farthest_, pixels, std::max({a.z, b.z, c.z}))) continue;
        add_to_tiles(chunk, pixels, tile_columns_, id);
      }
      sort_by_tile(chunk, static_cast<std::size_t>(tile_columns_ * tile_rows_));
    }
  });
}

void Rasterizer::draw_tiles(const Mesh& mesh, IdBuffer& out, bool front) {
  const auto tiles = static_cast<std::size_t>(tile_columns_ * tile_rows_);
  parallel_for(tiles, 4, [&](std::size_t begin, std::size_t end) {
    const auto tile = std::make_unique<raster::Tile>();
    for (std::size_t i = begin; i < end; ++i) {
      const auto used = [&](const Chunk& c) { return c.begin[i] != c.begin[i + 1]; };
      if (!front && std::none_of(chunks_.begin(), chunks_.end(), used)) continue;
      const int x = static_cast<int>(i) % tile_columns_ * tile_size;
      const int y = static_cast<int>(i) / tile_columns_ * tile_size;
      const raster::TileRect rect{x, y, std::min(tile_size, width_ - x),
                                  std::min(tile_size, height_ - y)};
      load_tile(rect, out, front, *tile);
      for (const Chunk& c : chunks_) {
        if (!used(c)) continue;
        const std::span<const std::uint32_t> ids(c.triangles.data() + c.begin[i],
                                                 c.begin[i + 1] - c.begin[i]);
        raster::draw(rect, ids, vertices_.data(), mesh.triangles.data(), *tile);
      }
      store_tile(rect, *tile, out);
      if (front) store_farthest(rect, *tile, farthest_);
    }
  });
}

void Rasterizer::rasterize(const Mesh& mesh, const ChartGrid& grid, IdBuffer& out, BackFaces back) {
  width_ = grid.width();
  height_ = grid.height();
  tile_columns_ = (width_ + tile_size - 1) / tile_size;
  tile_rows_ = (height_ + tile_size - 1) / tile_size;
  out.triangle.resize(width_, height_);
  out.depth.resize(width_, height_);
  farthest_.resize((width_ + block_size - 1) / block_size, (height_ + block_size - 1) / block_size);
  project(mesh, grid);
  bin_front(mesh);
  draw_tiles(mesh, out, true);
  if (back == BackFaces::LeaveAway) return;
  bin_back(mesh);
  draw_tiles(mesh, out, false);
}

}  // namespace normalshop
