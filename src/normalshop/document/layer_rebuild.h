#pragma once

#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "normalshop/core/progress.h"
#include "normalshop/document/document_file.h"
#include "normalshop/document/layered_tiles.h"

namespace normalshop {

/// Makes the tiles of layers anew after their edits, or what lies below them, have changed: edits
/// that still stand on what they stood on are not made again, and the others start from the nearest
/// state that the history holds.
class LayerRebuild {
 public:
  /// Applies an edit to the maps.
  using Run = std::function<void(const Edit&)>;
  /// The edit that a step holds.
  using Load = std::function<Edit(std::int64_t step)>;

  /// `storage` holds what the document shows; it is left in any state.
  LayerRebuild(const DocumentFile& file, StorageAtlas& storage, Load load, Run run);

  /// What becomes of the tiles. Throws whatever load and run throw, and Cancelled.
  std::vector<TileChange> rebuild(const EditStack& before, const EditStack& after,
                                  const Progress& progress = {});

 private:
  /// Tiles by places, each of all layers.
  using Tiles = std::map<TilePlace, std::vector<PackedTile>>;
  /// The edits of a layer that are to be made, on what its first ones left.
  struct Plan {
    std::size_t kept = 0;
    std::vector<PackedTile> changed_since;
  };

  Plan plan_for(const EditStack& before, const EditStack& after, std::size_t layer) const;
  void rebuild_layer(const EditStack& after, std::size_t layer, const Plan& plan,
                     const Progress& progress);
  void drop(std::int64_t layer);
  void show(const LayersShown& shown);
  std::vector<std::int64_t> color_layers(std::size_t set) const;
  void put(const TilePlace& place, std::int64_t layer, const std::string& bytes,
           const std::string& imported);
  std::vector<TileChange> changes();
  PackedTile* find(const TilePlace& place, std::int64_t layer);

  const DocumentFile& file_;
  StorageAtlas& storage_;
  Load load_;
  Run run_;
  Tiles tiles_;
  std::map<std::pair<std::int64_t, TilePlace>, std::string> earlier_;  ///< of tiles that were put
};

}  // namespace normalshop
