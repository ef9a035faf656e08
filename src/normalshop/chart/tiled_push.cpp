#include "normalshop/chart/tiled_push.h"

#include "normalshop/chart/set_push.h"

namespace normalshop {

struct TiledPush::Target {
  static constexpr auto facing = NormalEditor::Facing::Left;
  NormalMap& after;
  Tiles& tiles;

  void put(int x, int y, const TexelWrite& write) {
    auto& tile = tiles[static_cast<std::size_t>(y / side * NormalMap::tiles_along(after.width()) +
                                                x / side)];
    if (!tile) tile = std::make_unique<Tile>();
    const std::size_t i = NormalMap::index_in_tile(x, y);
    const float weight = tile->weight[i];
    const bool takes = write.rank < tile->rank[i] ? !outweighs(weight, write.weight)
                                                  : outweighs(write.weight, weight);
    if (weight > 0.0F && !takes) return;
    after.set_normal(x, y, write.value);
    tile->weight[i] = write.weight;
    tile->turn[i] = write.turn;
    tile->rank[i] = write.rank;
  }
};

TiledPush::TiledPush(const StorageAtlas& storage) {
  for (const StorageSet& set : storage.sets) {
    after_.push_back(set.normals);
    sets_.emplace_back(static_cast<std::size_t>(NormalMap::tiles_along(set.normals.width())) *
                       static_cast<std::size_t>(NormalMap::tiles_along(set.normals.height())));
  }
}

void TiledPush::add(const Mesh& mesh, const EditingChart& chart, const ChartEdit& edit,
                    const Rect& own, const StorageAtlas& storage) {
  ChartEdit part = edit;
  part.own = own;
  const EditSampler sampler(chart, part);
  for (std::size_t i = 0; i < storage.sets.size(); ++i) {
    Target target{after_[i], sets_[i]};
    SetPush push(mesh, sampler, storage.sets[i], static_cast<std::uint32_t>(i), target);
    visited_ += push.run().visited;
  }
}

PushResult TiledPush::write(StorageAtlas& storage) {
  PushTally tally;
  tally.visited = visited_;
  for (std::size_t s = 0; s < sets_.size(); ++s) {
    const int width = after_[s].width();
    const int columns = NormalMap::tiles_along(width);
    for (std::size_t t = 0; t < sets_[s].size(); ++t) {
      if (!sets_[s][t]) continue;
      const Tile& tile = *sets_[s][t];
      const int x0 = static_cast<int>(t) % columns * side;
      const int y0 = static_cast<int>(t) / columns * side;
      SharedCursor covered(storage.sets[s].texels.shared());
      for (int i = 0; i < side * side; ++i) {
        const auto k = static_cast<std::size_t>(i);
        if (!(tile.weight[k] > 0.0F)) continue;
        tally.largest = std::max(tally.largest, tile.turn[k]);
        ++tally.changed;
        const std::uint32_t texel = texel_index(x0 + i % side, y0 + i / side, width);
        if (covered.holds(texel)) ++tally.shared;
      }
    }
    storage.sets[s].normals = std::move(after_[s]);
  }
  return result_of(tally);
}

}  // namespace normalshop
