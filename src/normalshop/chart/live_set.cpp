#include "normalshop/chart/live_set.h"

#include <algorithm>

#include "normalshop/chart/shared_cursor.h"
#include "normalshop/core/parallel.h"

namespace normalshop {

namespace {

constexpr auto all_triangles = [](std::uint32_t) { return true; };

/// Do any of these blocks hold what these texels read?
bool meets(const PixelBlocks& blocks, const SeenTexels& seen) {
  constexpr int beyond = 3;  // pixels, of a bicubic kernel
  const auto block = [](float pixel) {
    return static_cast<int>(std::max(pixel, 0.0F)) / PixelBlocks::side;
  };
  return blocks.any({block(seen.left - beyond), block(seen.top - beyond),
                     block(seen.right + beyond) + 1, block(seen.bottom + beyond) + 1});
}

}  // namespace

LiveSet::LiveSet(const Mesh& mesh, const StorageSet& set, std::uint32_t index,
                 const EditSampler& sampler, const EditReach& everywhere)
    : before_(set.normals),
      everywhere_(everywhere),
      editor_(mesh, sampler, set.texels, before_),
      places_(mesh, set.texels, index, sampler.grid()),
      tiles_(static_cast<std::size_t>(NormalMap::tiles_along(before_.width())) *
             static_cast<std::size_t>(NormalMap::tiles_along(before_.height()))) {}

std::vector<int> LiveSet::update(const Rect& pixels, const PixelBlocks& changed, NormalMap& map) {
  std::vector<int> tiles = places_.meeting(pixels);
  if (tiles.empty()) return tiles;
  find_seen(tiles);
  const std::vector<SharedTexel> shared = places_.shared_of(tiles);
  const std::vector<TexelWrite> shared_writes = editor_.shared_writes(shared, all_triangles);
  const std::vector<GutterTexel> gutter = places_.gutter_of(tiles, pixels);
  const std::vector<TexelWrite> gutter_writes = editor_.gutter_writes(gutter, all_triangles);
  for (const int t : tiles) tiles_[static_cast<std::size_t>(t)].touched = false;
  restore(shared, map);
  restore(gutter, map);
  parallel_for(tiles.size(), 1, [&](std::size_t begin, std::size_t end) {
    TexelLanes lanes;
    for (std::size_t i = begin; i < end; ++i) {
      edit_tile(tiles[i], changed, shared_writes, lanes, map);
    }
  });
  put(shared_writes, map);
  put(gutter_writes, map);
  std::erase_if(tiles, [&](int t) { return !tiles_[static_cast<std::size_t>(t)].touched; });
  return tiles;
}

void LiveSet::find_seen(const std::vector<int>& tiles) {
  std::vector<int> unknown;
  for (const int t : tiles) {
    if (!tiles_[static_cast<std::size_t>(t)].found) unknown.push_back(t);
  }
  parallel_for(unknown.size(), 1, [&](std::size_t begin, std::size_t end) {
    TexelRows rows(editor_.mesh(), editor_.sampler().grid(), editor_.texels(), all_triangles);
    for (std::size_t i = begin; i < end; ++i) {
      Tile& tile = tiles_[static_cast<std::size_t>(unknown[i])];
      const Rect texels = tile_texels(unknown[i], before_.width(), before_.height());
      rows.visit(texels, [&](TexelLanes& lanes) { append_seen(everywhere_, lanes, tile.seen); });
      tile.found = true;
    }
  });
}

/// The tile's texels by their owners. Those on which the edit does not act become what they were.
void LiveSet::edit_tile(int index, const PixelBlocks& blocks, const std::vector<TexelWrite>& shared,
                        TexelLanes& lanes, NormalMap& map) {
  Tile& tile = tiles_[static_cast<std::size_t>(index)];
  // What shared texels become may depend on pixels far away.
  const bool whole = places_.shares(index);
  for (const SeenTexels& seen : tile.seen) {
    if (!whole && !meets(blocks, seen)) continue;
    tile.visited += static_cast<std::size_t>(seen.count);
    const bool acts = seen.load(editor_.sampler().reach(), lanes) && editor_.edit_weighed(lanes);
    for (int i = 0; i < seen.count; ++i) {
      const std::uint32_t texel = seen.texels[static_cast<std::size_t>(i)];
      if (acts && lanes.batch.acts(i)) {
        const std::uint32_t owner = seen.triangles[static_cast<std::size_t>(i)];
        if (!holds_texel(shared, texel)) {
          put(tile, editor_.write_of(lanes.batch, i, texel, owner), map);
        }
      } else {
        restore(tile, texel, map);
      }
    }
  }
}

template <class Item>
void LiveSet::restore(const std::vector<Item>& items, NormalMap& map) {
  for (const Item& item : items) restore(tile_at(item.texel), item.texel, map);
}

void LiveSet::put(const std::vector<TexelWrite>& writes, NormalMap& map) {
  for (const TexelWrite& w : writes) put(tile_at(w.texel), w, map);
}

void LiveSet::put(Tile& tile, const TexelWrite& write, NormalMap& map) {
  const auto [x, y] = texel_place(write.texel, before_.width());
  map.set_normal(x, y, write.value);
  tile.changed.set(NormalMap::index_in_tile(x, y));
  tile.touched = true;
}

void LiveSet::restore(Tile& tile, std::uint32_t texel, NormalMap& map) {
  const auto [x, y] = texel_place(texel, before_.width());
  tile.changed.reset(NormalMap::index_in_tile(x, y));
  if (map.restore(x, y, before_)) tile.touched = true;
}

LiveSet::Tile& LiveSet::tile_at(std::uint32_t texel) {
  const auto [x, y] = texel_place(texel, before_.width());
  return tiles_[static_cast<std::size_t>(y / side * NormalMap::tiles_along(before_.width()) +
                                         x / side)];
}

PushTally LiveSet::tally(const NormalMap& map) const {
  PushTally all;
  const int columns = NormalMap::tiles_along(before_.width());
  for (std::size_t t = 0; t < tiles_.size(); ++t) {
    const Tile& tile = tiles_[t];
    all.visited += tile.visited;
    all.changed += tile.changed.count();
    if (tile.changed.none()) continue;
    SharedCursor covered(editor_.texels().shared());
    for (int i = 0; i < side * side; ++i) {
      if (!tile.changed[static_cast<std::size_t>(i)]) continue;
      const int x = static_cast<int>(t) % columns * side + i % side;
      const int y = static_cast<int>(t) / columns * side + i / side;
      if (covered.holds(texel_index(x, y, map.width()))) ++all.shared;
      const Vec3f moved = map.normal(x, y).normalized() - before_.normal(x, y).normalized();
      all.largest = std::max(all.largest, 0.5F * moved.squaredNorm());
    }
  }
  return all;
}

}  // namespace normalshop
