#include "normalshop/chart/live_push.h"

#include <algorithm>

#include "normalshop/chart/live_set.h"

namespace normalshop {

struct LivePush::State {
  State(const Mesh& mesh, const StorageAtlas& storage, const EditingChart& chart,
        const EditDirection& direction, SlopeView change, MaskView coverage)
      : edit{direction, change, coverage, chart.weight.rect()},
        sampler(EditSampler::growing(chart, edit)),
        everywhere(chart, chart.weight.rect(), [](int, int) { return true; }) {
    for (std::size_t i = 0; i < storage.sets.size(); ++i) {
      sets.push_back(std::make_unique<LiveSet>(mesh, storage.sets[i], static_cast<std::uint32_t>(i),
                                               sampler, everywhere));
    }
  }

  ChartEdit edit;
  EditSampler sampler;
  EditReach everywhere;
  std::vector<std::unique_ptr<LiveSet>> sets;
};

LivePush::LivePush(const Mesh& mesh, const StorageAtlas& storage, const EditingChart& chart,
                   const EditDirection& direction, SlopeView change, MaskView coverage)
    : state_(std::make_unique<State>(mesh, storage, chart, direction, change, coverage)) {}

LivePush::~LivePush() = default;

const std::vector<MapTile>& LivePush::update(const Rect& changed, StorageAtlas& storage) {
  PixelBlocks blocks(state_->edit.region.width(), state_->edit.region.height());
  blocks.reset(changed);
  blocks.mark_all();
  return update(blocks, storage);
}

const std::vector<MapTile>& LivePush::update(const PixelBlocks& changed, StorageAtlas& storage) {
  tiles_.clear();
  state_->sampler.update(changed);
  if (changed.region().empty()) return tiles_;
  for (std::size_t i = 0; i < state_->sets.size(); ++i) {
    const int columns = NormalMap::tiles_along(storage.sets[i].normals.width());
    for (const int tile : state_->sets[i]->update(changed, storage.sets[i].normals)) {
      tiles_.push_back({static_cast<std::uint32_t>(i), tile % columns, tile / columns});
    }
  }
  return tiles_;
}

PushResult LivePush::result(const StorageAtlas& storage) const {
  PushTally all;
  for (std::size_t i = 0; i < state_->sets.size(); ++i) {
    all.add(state_->sets[i]->tally(storage.sets[i].normals));
  }
  return result_of(all);
}

void LivePush::restore(StorageAtlas& storage) const {
  for (std::size_t i = 0; i < state_->sets.size(); ++i) {
    storage.sets[i].normals = state_->sets[i]->before();
  }
}

std::vector<const NormalMap*> LivePush::before() const {
  std::vector<const NormalMap*> maps;
  for (const auto& set : state_->sets) maps.push_back(&set->before());
  return maps;
}

}  // namespace normalshop
