#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "normalshop/chart/storage.h"

namespace normalshop {

/// What a texel has: a normal and a colour.
enum class Attribute { Normals, Colors };
constexpr auto names_of(Attribute) { return std::array<std::string_view, 2>{"normals", "colors"}; }

/// NormalMap::tile_size texels a side of one map of a texture set; tiles count in rows from the top
/// left.
struct TilePlace {
  std::uint32_t set = 0;
  Attribute attribute = Attribute::Normals;
  std::uint32_t tile = 0;
};

/// A tile's edited texels as bytes, the same on every machine (docs/document.md), packed
/// (store/packing.h).
struct PackedTile {
  TilePlace place;
  std::string bytes;
};

/// What an edit made of a tile.
struct TileChange {
  TilePlace place;
  std::string before;  ///< of colours that no edit had reached; else empty: it is known
  std::string after;
};

/// The maps as they are now. Copies of normals share what nobody edits; colours are copied whole,
/// and only where they may move.
struct MapsBefore {
  MapsBefore(const StorageAtlas& storage, bool colors);
  /// Makes the maps what they were.
  void restore(StorageAtlas& storage) const;

  std::vector<NormalMap> normals;
  std::vector<ColorMap> colors;  ///< empty: they don't move
};

/// The tiles that hold other texels than before, by texture set, attribute and tile.
std::vector<TileChange> changed_tiles(const MapsBefore& before, const StorageAtlas& storage);

/// Throws InvalidInput unless the bytes are those of a tile; empty ones are normals as they were
/// imported.
void check_tile(const PackedTile& tile);
/// The same, for a tile that does not fit its map too.
void check_fits(const PackedTile& tile, const StorageAtlas& storage);
/// Makes a tile what was packed. Throws like check_fits(), and nothing has changed then.
void put_tile(const PackedTile& tile, StorageAtlas& storage);

}  // namespace normalshop
