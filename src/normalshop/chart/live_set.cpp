#include "normalshop/chart/live_set.h"

#include <algorithm>

#include "normalshop/chart/shared_cursor.h"
#include "normalshop/core/parallel.h"

namespace normalshop {

namespace {

constexpr auto all_triangles = [](std::uint32_t) { return true; };

}  // namespace

LiveSet::LiveSet(const Mesh& mesh, const StorageSet& set, std::uint32_t index,
                 const EditSampler& sampler, const EditReach& everywhere)
    : before_(set.normals),
      everywhere_(everywhere),
      editor_(mesh, sampler, set.texels, before_),
      places_(mesh, set.texels, index, sampler.grid()),
      tiles_(static_cast<std::size_t>(NormalMap::tiles_along(before_.width())) *
             static_cast<std::size_t>(NormalMap::tiles_along(before_.height()))) {}

std::vector<int> LiveSet::update(const PixelBlocks& changed, NormalMap& map) {
  std::vector<int> tiles = places_.meeting(changed);
  if (tiles.empty()) return tiles;
  find_seen(tiles);
  const std::vector<SharedTexel> shared = places_.shared_of(tiles);
  const std::vector<TexelWrite> shared_writes = editor_.shared_writes(shared, all_triangles);
  const std::vector<GutterTexel> gutter = places_.gutter_of(tiles, changed);
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
    SeenTile gathered(everywhere_, before_);
    for (std::size_t i = begin; i < end; ++i) {
      Tile& tile = tiles_[static_cast<std::size_t>(unknown[i])];
      const Rect texels = tile_texels(unknown[i], before_.width(), before_.height());
      rows.visit(texels, [&](TexelLanes& lanes) { gathered.add(lanes, tile.seen); });
      gathered.finish(tile.seen);
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
  NormalMap::TileWriter writer(map, static_cast<std::size_t>(index), before_);
  const auto is_shared = [&](std::size_t place) {
    if (!whole) return false;
    const auto in_tile = static_cast<int>(place);
    const Rect texels = tile_texels(index, before_.width(), before_.height());
    return holds_texel(shared, texel_index(texels.x0 + in_tile % side, texels.y0 + in_tile / side,
                                           before_.width()));
  };
  for (const SeenTexels& seen : tile.seen) {
    if (!whole && !blocks.any_near(seen.left, seen.top, seen.right, seen.bottom, bicubic_reach))
      continue;
    tile.visited += static_cast<std::size_t>(seen.count);
    const bool acts = seen.load(editor_.sampler().reach(), lanes) && editor_.edit_weighed(lanes);
    for (int i = 0; i < seen.count; ++i) {
      const std::size_t place = seen.places[static_cast<std::size_t>(i)];
      if (!acts || !lanes.batch.acts(i)) {
        tile.changed.reset(place);
        if (writer.restore(place)) tile.touched = true;
      } else if (!is_shared(place)) {
        writer.set_normal(place, lanes.batch.result.get(i));
        tile.changed.set(place);
        tile.touched = true;
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
