#pragma once

#include <array>
#include <memory>
#include <vector>

#include "normalshop/chart/push.h"

namespace normalshop {

/// An edit of one view whose chart is too large to be made at once: push() in parts. Every part has
/// a chart of its own on the view's lattice of pixels, which shows its own pixels and a margin.
///
/// The parts see the storage as it is before the edit: it must not change until write(). What they
/// write is what push() would write with the chart in one piece, as far as charts and changes are
/// the same: a texel is edited by the part in whose own pixels its surface point lies. Of parts
/// that both edit one (texels that triangles share, and the gutter) the one with the larger weight
/// decides, of equal ones the texel's owner, then the first that TexelMap lists.
class TiledPush {
 public:
  explicit TiledPush(const StorageAtlas& storage);

  /// `own`: pixels of this chart. edit.own is not read. Deterministic for any number of threads.
  void add(const Mesh& mesh, const EditingChart& chart, const ChartEdit& edit, const Rect& own,
           const StorageAtlas& storage);
  /// Stores what the parts have made. `visited` counts texels once for each part that reached them.
  PushResult write(StorageAtlas& storage);

 private:
  static constexpr int side = NormalMap::tile_size;
  /// What has been written already.
  struct Tile {
    std::array<float, side * side> weight{};  ///< of the effective chart; 0: nothing
    std::array<float, side * side> turn{};
    std::array<std::uint32_t, side * side> rank{};
  };
  struct Target;
  using Tiles = std::vector<std::unique_ptr<Tile>>;

  std::vector<NormalMap> after_;
  std::vector<Tiles> sets_;
  std::size_t visited_ = 0;
};

}  // namespace normalshop
