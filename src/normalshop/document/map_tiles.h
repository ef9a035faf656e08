#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "normalshop/chart/storage.h"
#include "normalshop/document/tile_bytes.h"

namespace normalshop {

/// What an edit made of a tile.
struct TileChange {
  TilePlace place;
  std::int64_t layer = first_layer;
  std::string before;  ///< of colours as they were before; of normals empty
  std::string after;   ///< empty: what the layers below make of it
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

/// The tiles that hold other texels than before, by texture set, attribute and tile, as tiles of a
/// layer.
std::vector<TileChange> changed_tiles(const MapsBefore& before, const StorageAtlas& storage,
                                      std::int64_t layer);

/// Throws InvalidInput for a tile that is damaged or does not fit its map.
void check_fits(const PackedTile& tile, const StorageAtlas& storage);
/// Makes a tile what was packed; an empty one of normals: as they were imported. Throws like
/// check_fits(), and nothing has changed then.
void put_tile(const PackedTile& tile, StorageAtlas& storage);

}  // namespace normalshop
