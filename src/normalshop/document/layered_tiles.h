#pragma once

#include <span>
#include <vector>

#include "normalshop/document/edit_stack.h"
#include "normalshop/document/map_tiles.h"

namespace normalshop {

/// The lowest layers of a stack, all of what they show, or all but what the last one of them does
/// to it: what an edit in that layer starts from.
struct LayersShown {
  std::span<const Layer> layers;
  bool last_as_edited = false;
};

/// Is one of these layers among those that are shown, and not hidden?
bool any_shown(std::span<const std::int64_t> layers, const LayersShown& shown);

/// Makes a tile of the maps what layers show there. `tiles` are those of all layers at the place,
/// others too, in any order, with the imported colours as a tile of imported_layer. Throws
/// InvalidInput for tiles that are damaged or do not fit; the tile is undefined then.
void show_tile(const TilePlace& place, const std::vector<PackedTile>& tiles,
               const LayersShown& shown, StorageAtlas& storage);

}  // namespace normalshop
