#include "normalshop/document/map_tiles.h"

#include <cstring>
#include <memory>
#include <optional>

#include "normalshop/core/error.h"
#include "normalshop/core/parallel.h"
#include "normalshop/document/store/packing.h"

namespace normalshop {

namespace {

using NormalTile = NormalMap::Tile;

bool same_normals(const NormalTile* a, const NormalTile* b) {
  if (a == b) return true;
  const bool none_a = a == nullptr || a->edited.none();
  const bool none_b = b == nullptr || b->edited.none();
  if (none_a || none_b) return none_a == none_b;
  if (a->edited != b->edited) return false;
  for (std::size_t i = 0; i < a->normals.size(); ++i) {
    if (a->edited[i] && std::memcmp(&a->normals[i], &b->normals[i], sizeof(Vec3f)) != 0)
      return false;
  }
  return true;
}

std::optional<TileChange> normal_change(const NormalMap& before, const NormalMap& after,
                                        std::size_t tile) {
  const auto was = before.tile(tile);
  const auto is = after.tile(tile);
  if (same_normals(was.get(), is.get())) return std::nullopt;
  return TileChange{{}, {}, {}, pack_normals(is ? *is : NormalTile{})};
}

std::optional<TileChange> color_change(const ColorMap& before, const ColorMap& after,
                                       std::size_t tile) {
  std::string was = color_bytes(before.codes(), tile);
  const std::string is = color_bytes(after.codes(), tile);
  if (was == is) return std::nullopt;
  return TileChange{{}, {}, pack(was), pack(is)};
}

/// change(tile) of each of `count` tiles, on all cores; those there are, in order.
template <class Change>
void collect(std::uint32_t set, Attribute attribute, std::size_t count, const Change& change,
             std::vector<TileChange>& out) {
  std::vector<std::optional<TileChange>> found(count);
  parallel_for(count, 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) found[i] = change(i);
  });
  for (std::size_t i = 0; i < count; ++i) {
    if (!found[i]) continue;
    found[i]->place = {set, attribute, static_cast<std::uint32_t>(i)};
    out.push_back(std::move(*found[i]));
  }
}

bool holds_normals(const PackedTile& tile) { return tile.place.attribute == Attribute::Normals; }

void check_place(const TilePlace& place, const StorageAtlas& storage) {
  if (place.set >= storage.sets.size()) throw InvalidInput("is of no texture set");
  const StorageSet& set = storage.sets[place.set];
  const std::size_t count = place.attribute == Attribute::Normals
                                ? set.normals.tile_count()
                                : color_tile_count(set.albedo.codes());
  if (place.tile >= count) throw InvalidInput("lies outside of its map");
}

}  // namespace

MapsBefore::MapsBefore(const StorageAtlas& storage, bool with_colors) {
  for (const StorageSet& set : storage.sets) {
    normals.push_back(set.normals);
    if (with_colors) colors.push_back(set.albedo);
  }
}

void MapsBefore::restore(StorageAtlas& storage) const {
  for (std::size_t i = 0; i < storage.sets.size(); ++i) {
    storage.sets[i].normals = normals[i];
    if (!colors.empty()) storage.sets[i].albedo = colors[i];
  }
}

std::vector<TileChange> changed_tiles(const MapsBefore& before, const StorageAtlas& storage,
                                      std::int64_t layer) {
  std::vector<TileChange> out;
  for (std::size_t i = 0; i < storage.sets.size(); ++i) {
    const StorageSet& set = storage.sets[i];
    const auto index = static_cast<std::uint32_t>(i);
    collect(
        index, Attribute::Normals, set.normals.tile_count(),
        [&](std::size_t t) { return normal_change(before.normals[i], set.normals, t); }, out);
    if (before.colors.empty() || !set.albedo.has_edits()) continue;
    ColorMap was = before.colors[i];
    was.begin_edits();
    collect(
        index, Attribute::Colors, color_tile_count(set.albedo.codes()),
        [&](std::size_t t) { return color_change(was, set.albedo, t); }, out);
  }
  for (TileChange& change : out) change.layer = layer;
  return out;
}

void check_fits(const PackedTile& tile, const StorageAtlas& storage) {
  check_place(tile.place, storage);
  if (tile.bytes.empty()) return;
  if (holds_normals(tile)) {
    unpack_normals(tile);
  } else {
    unpack_colors(tile, storage.sets[tile.place.set].albedo.codes());
  }
}

void put_tile(const PackedTile& tile, StorageAtlas& storage) {
  check_place(tile.place, storage);
  StorageSet& set = storage.sets[tile.place.set];
  if (holds_normals(tile)) {
    set.normals.set_tile(tile.place.tile, unpack_normals(tile));
    return;
  }
  const std::string bytes = unpack_colors(tile, set.albedo.codes());
  set.albedo.begin_edits();
  write_color_bytes(bytes, tile.place.tile, set.albedo);
}

}  // namespace normalshop
