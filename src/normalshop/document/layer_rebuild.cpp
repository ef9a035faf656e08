#include "normalshop/document/layer_rebuild.h"

#include <algorithm>

#include "normalshop/core/error.h"

namespace normalshop {

namespace {

const Layer* layer_with(const EditStack& stack, std::int64_t id) {
  for (const Layer& layer : stack.layers) {
    if (layer.id == id) return &layer;
  }
  return nullptr;
}

/// A layer as it was, where what lies below it has not changed; else null.
const Layer* standing(const EditStack& before, const EditStack& after, std::size_t layer) {
  const bool same = layer < before.layers.size() &&
                    before.layers[layer].id == after.layers[layer].id &&
                    same_below(before, after, layer);
  return same ? &before.layers[layer] : nullptr;
}

bool begins_with(const std::vector<std::int64_t>& all, const std::vector<std::int64_t>& first) {
  return first.size() <= all.size() && std::equal(first.begin(), first.end(), all.begin());
}

}  // namespace

LayerRebuild::LayerRebuild(const DocumentFile& file, StorageAtlas& storage, Load load, Run run)
    : file_(file), storage_(storage), load_(std::move(load)), run_(std::move(run)) {
  for (PackedTile& tile : file.tiles()) tiles_[tile.place].push_back(std::move(tile));
}

std::vector<TileChange> LayerRebuild::rebuild(const EditStack& before, const EditStack& after,
                                              const Progress& progress) {
  for (std::size_t i = 0; i < after.layers.size(); ++i) {
    const Layer* old = standing(before, after, i);
    const bool stands = old != nullptr && old->recipes() == after.layers[i].recipes();
    if (!stands) rebuild_layer(after, i, plan_for(before, after, i), progress);
  }
  for (const Layer& layer : before.layers) {
    if (layer_with(after, layer.id) == nullptr) drop(layer.id);
  }
  return changes();
}

LayerRebuild::Plan LayerRebuild::plan_for(const EditStack& before, const EditStack& after,
                                          std::size_t layer) const {
  const Layer& wanted = after.layers[layer];
  const std::vector<std::int64_t> recipes = wanted.recipes();
  const Layer* old = standing(before, after, layer);
  Plan plan;
  if (old != nullptr && begins_with(recipes, old->recipes())) {
    plan.kept = old->recipes().size();
  }
  const auto snapshot = file_.find_snapshot(after, layer, plan.kept);
  if (!snapshot) return plan;
  return {snapshot->recipes, file_.tiles_after(snapshot->step, wanted.id)};
}

void LayerRebuild::rebuild_layer(const EditStack& after, std::size_t layer, const Plan& plan,
                                 const Progress& progress) {
  const Layer& wanted = after.layers[layer];
  const std::vector<std::int64_t> recipes = wanted.recipes();
  std::vector<Edit> edits;
  for (std::size_t i = plan.kept; i < recipes.size(); ++i) edits.push_back(load_(recipes[i]));
  if (plan.kept == 0) {
    drop(wanted.id);
  } else {
    for (const PackedTile& tile : plan.changed_since) put(tile.place, tile.layer, tile.bytes, {});
  }
  if (edits.empty()) return;
  show({std::span(after.layers).first(layer + 1), true});
  const bool colors = std::any_of(edits.begin(), edits.end(),
                                  [](const Edit& e) { return e.operation->moves_colors(); });
  const MapsBefore before(storage_, colors);
  for (std::size_t i = 0; i < edits.size(); ++i) {
    progress.at(static_cast<double>(i) / static_cast<double>(edits.size()),
                "edits of layer '" + wanted.name + "'");
    run_(edits[i]);
  }
  for (TileChange& change : changed_tiles(before, storage_, wanted.id)) {
    put(change.place, wanted.id, change.after, change.before);
  }
}

void LayerRebuild::drop(std::int64_t layer) {
  std::vector<TilePlace> places;
  for (const auto& [place, tiles] : tiles_) {
    for (const PackedTile& tile : tiles) {
      if (tile.layer == layer && !tile.bytes.empty()) places.push_back(place);
    }
  }
  for (const TilePlace& place : places) put(place, layer, {}, {});
}

void LayerRebuild::show(const LayersShown& shown) {
  for (const auto& [place, tiles] : tiles_) {
    try {
      show_tile(place, tiles, shown, storage_);
    } catch (const InvalidInput& error) {
      file_.fail_at(place, error.what());
    }
  }
  for (std::size_t i = 0; i < storage_.sets.size(); ++i) {
    if (!any_shown(color_layers(i), shown)) storage_.sets[i].albedo.end_edits();
  }
}

std::vector<std::int64_t> LayerRebuild::color_layers(std::size_t set) const {
  std::vector<std::int64_t> layers;
  for (const auto& [place, tiles] : tiles_) {
    if (place.set != set || place.attribute != Attribute::Colors) continue;
    for (const PackedTile& tile : tiles) {
      if (tile.layer != imported_layer && !tile.bytes.empty()) layers.push_back(tile.layer);
    }
  }
  return layers;
}

PackedTile* LayerRebuild::find(const TilePlace& place, std::int64_t layer) {
  for (PackedTile& tile : tiles_[place]) {
    if (tile.layer == layer) return &tile;
  }
  return nullptr;
}

void LayerRebuild::put(const TilePlace& place, std::int64_t layer, const std::string& bytes,
                       const std::string& imported) {
  std::vector<PackedTile>& there = tiles_[place];
  if (!imported.empty() && find(place, imported_layer) == nullptr) {
    there.push_back({place, imported_layer, imported});
  }
  if (find(place, layer) == nullptr) there.push_back({place, layer, {}});
  std::string& present = find(place, layer)->bytes;
  earlier_.try_emplace({layer, place}, present);
  present = bytes;
}

std::vector<TileChange> LayerRebuild::changes() {
  std::vector<TileChange> out;
  for (const auto& [key, bytes] : earlier_) {
    const auto& [layer, place] = key;
    const std::string& now = find(place, layer)->bytes;
    if (now == bytes) continue;
    const PackedTile* imported = find(place, imported_layer);
    out.push_back({place, layer, imported != nullptr ? imported->bytes : std::string(), now});
  }
  return out;
}

}  // namespace normalshop
