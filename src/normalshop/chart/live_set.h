#pragma once

#include <bitset>
#include <cstdint>
#include <deque>
#include <vector>

#include "normalshop/chart/normal_editor.h"
#include "normalshop/chart/push_tally.h"
#include "normalshop/chart/seen_texels.h"
#include "normalshop/chart/tile_places.h"
#include "normalshop/core/pixel_blocks.h"

/// One texture set's part of a LivePush, private to floor 4.
namespace normalshop {

/// Texels whose part of the chart changes are edited anew, from the map as it was before the edit,
/// so that they become what push() makes of them.
class LiveSet {
 public:
  /// `sampler` and `everywhere` (each pixel of the chart acts) stay with the LivePush.
  LiveSet(const Mesh& mesh, const StorageSet& set, std::uint32_t index, const EditSampler& sampler,
          const EditReach& everywhere);

  /// Stores what the edit makes of the texels in or beside changed blocks. Returns the tiles that
  /// may look different.
  std::vector<int> update(const PixelBlocks& changed, NormalMap& map);
  /// Of all updates: what they came to, and how `map` differs from before.
  PushTally tally(const NormalMap& map) const;
  const NormalMap& before() const { return before_; }

 private:
  static constexpr int side = NormalMap::tile_size;
  struct Tile {
    bool found = false;
    std::deque<SeenTexels> seen;  ///< by their owners; once found
    bool touched = false;         ///< by the last update
    std::size_t visited = 0;
    std::bitset<side * side> changed;  ///< texels
  };
  void find_seen(const std::vector<int>& tiles);
  void edit_tile(int index, const PixelBlocks& blocks, const std::vector<TexelWrite>& shared,
                 TexelLanes& lanes, NormalMap& map);
  template <class Item>
  void restore(const std::vector<Item>& items, NormalMap& map);
  void put(const std::vector<TexelWrite>& writes, NormalMap& map);
  void put(Tile& tile, const TexelWrite& write, NormalMap& map);
  void restore(Tile& tile, std::uint32_t texel, NormalMap& map);
  Tile& tile_at(std::uint32_t texel);

  NormalMap before_;
  const EditReach& everywhere_;
  NormalEditor editor_;
  TilePlaces places_;
  std::vector<Tile> tiles_;
};

}  // namespace normalshop
