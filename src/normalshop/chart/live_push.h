#pragma once

#include <memory>
#include <vector>

#include "normalshop/chart/push.h"
#include "normalshop/core/pixel_blocks.h"

namespace normalshop {

/// A tile of NormalMap::tile_size texels a side, counted from the top left.
struct MapTile {
  std::uint32_t set;
  int column;
  int row;

  bool operator==(const MapTile&) const = default;
};

/// Pushes an edit again and again while it grows, a stroke under the pointer: what push() would
/// store of the whole edit, bit for bit, at the price of what has changed: the texels that the
/// changed pixels show. Which tiles hold these is found once for a chart, and where a tile's texels
/// lie in it when they are first asked for: some 60 bytes are kept for each of these texels.
///
/// Source: thesis 5.5 (selective update), with tiles of the atlas in place of pixels.
class LivePush {
 public:
  /// The storage is the one before the edit; the chart has its weight and must stay as it is.
  /// `change` and `coverage` (may be empty) have its size: they are read by each update().
  LivePush(const Mesh& mesh, const StorageAtlas& storage, const EditingChart& chart,
           const EditDirection& direction, SlopeView change, MaskView coverage);
  ~LivePush();
  LivePush(const LivePush&) = delete;
  LivePush& operator=(const LivePush&) = delete;

  /// Stores what the edit has become, given that since the last time change and coverage are
  /// different in marked blocks only. Returns the tiles that may look different, by set and row.
  const std::vector<MapTile>& update(const PixelBlocks& changed, StorageAtlas& storage);
  /// The same for all blocks that meet these pixels.
  const std::vector<MapTile>& update(const Rect& changed, StorageAtlas& storage);
  /// Of all updates together, given what they stored: `visited` counts a texel once for each update
  /// that came to it, `largest_change` is from what the maps held before.
  PushResult result(const StorageAtlas& storage) const;
  /// Takes the edit back.
  void restore(StorageAtlas& storage) const;
  /// The maps before the edit, by texture set.
  std::vector<const NormalMap*> before() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
  std::vector<MapTile> tiles_;  // of the last update
};

}  // namespace normalshop
