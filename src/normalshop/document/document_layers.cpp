#include <algorithm>
#include <cassert>
#include <utility>

#include "normalshop/core/error.h"
#include "normalshop/document/apply_edit.h"
#include "normalshop/document/document.h"
#include "normalshop/document/layer_rebuild.h"

/// Documents on file: their layers and history.
namespace normalshop {

namespace {

DocumentFile::TileCheck fits(const StorageAtlas& storage) {
  return [&storage](const PackedTile& tile) { check_fits(tile, storage); };
}

}  // namespace

Edit Document::load_edit(std::int64_t step) const {
  const auto assets = assets_of_(file_->files_of(step));
  const std::string name = file_->path().string() + ": step " + std::to_string(step);
  return read_edit(file_->edit(step), name, *assets);
}

std::vector<Edit> Document::log() const {
  if (!file_) return log_;
  std::vector<Edit> edits;
  for (const Layer& layer : stack_.layers) {
    if (layer.hidden) continue;
    for (const std::int64_t step : layer.recipes()) edits.push_back(load_edit(step));
  }
  return edits;
}

void Document::keep_in(std::shared_ptr<DocumentFile> file, AssetsOf assets) {
  assert(!file_ && log_.empty());
  file_ = std::move(file);
  assets_of_ = std::move(assets);
  stack_ = file_->stack();
  show_all();
}

void Document::show(const TilePlace& place, const std::vector<PackedTile>& tiles) {
  try {
    show_tile(place, tiles, {stack_.layers}, storage_);
  } catch (const InvalidInput& error) {
    file_->fail_at(place, error.what());
  }
}

void Document::end_color_edits() {
  for (std::size_t i = 0; i < storage_.sets.size(); ++i) {
    const std::vector<std::int64_t> colored = file_->color_layers(static_cast<std::uint32_t>(i));
    if (!any_shown(colored, {stack_.layers})) storage_.sets[i].albedo.end_edits();
  }
}

void Document::show_all() {
  const std::vector<PackedTile> all = file_->tiles();
  std::vector<PackedTile> there;
  for (std::size_t i = 0; i < all.size(); ++i) {
    there.push_back(all[i]);
    if (i + 1 < all.size() && all[i + 1].place == all[i].place) continue;
    show(all[i].place, there);
    there.clear();
  }
  end_color_edits();
}

void Document::take_stack(EditStack stack) {
  stack_ = std::move(stack);
  const auto chosen = [&](const Layer& layer) { return layer.id == active_layer_; };
  if (std::none_of(stack_.layers.begin(), stack_.layers.end(), chosen)) active_layer_.reset();
}

void Document::follow(const HistoryMove& move) {
  if (move.restacked) {
    take_stack(file_->stack());
    show_all();
  } else {
    for (const HistoryEntry& step : move.back) stack_.take_back_edit(step.change, step.id);
    for (const HistoryEntry& step : move.on) stack_.take(step.change, step.id);
  }
  for (const TilePlace& place : move.places) show(place, file_->tiles_at(place));
  end_color_edits();
}

bool Document::undo() {
  assert(file_ && !live_);
  const auto move = file_->undo(fits(storage_));
  if (move) follow(*move);
  return move.has_value();
}

bool Document::redo() {
  assert(file_ && !live_);
  const auto move = file_->redo(fits(storage_));
  if (move) follow(*move);
  return move.has_value();
}

void Document::jump(std::optional<std::int64_t> step) {
  assert(file_ && !live_);
  follow(file_->jump(step, fits(storage_)));
}

std::int64_t Document::active_layer() const {
  return active_layer_ ? *active_layer_ : stack_.default_layer();
}

void Document::choose_layer(std::int64_t layer) {
  stack_.find(layer);
  active_layer_ = layer;
}

void Document::check_seen(std::int64_t layer) const {
  if (!stack_.layers[stack_.find(layer)].hidden) return;
  throw InvalidInput("layer " + std::to_string(layer) +
                     " is hidden; show it, or choose another one, to edit it");
}

bool Document::shows_active_layer() const { return stack_.on_top(stack_.find(active_layer())); }

void Document::change(const StackChange& change, const Progress& progress) {
  restack({change}, progress);
}

void Document::change_edit(std::int64_t edit, const Edit& recipe, const Progress& progress) {
  restack({{StackStep::Change, edit}, &recipe}, progress);
}

EditReport Document::restack(const NewStep& step, const Progress& progress) {
  assert(file_ && !live_);
  if (file_->read_only())
    throw DocumentError("'" + file_->path().string() + "' is write-protected");
  const StackChange& change = step.change;
  if (change.step == StackStep::Edit) check_seen(change.target);
  const std::int64_t id = file_->next_step();
  EditStack after = stack_;
  after.take(change, id);
  NewStep added = step;
  EditReport report;
  bool first = true;
  const MapsBefore before(storage_, true);
  try {
    LayerRebuild rebuild(
        *file_, storage_,
        [&](std::int64_t recipe) {
          return step.edit != nullptr && recipe == id ? *step.edit : load_edit(recipe);
        },
        [&](const Edit& edit) {
          const EditReport made = apply_edit(edit, mesh_, seams_, cover_, storage_, {});
          added.texels_changed += made.pushed.changed;
          // An edit that is added comes before those that stand on it.
          if (std::exchange(first, false)) report = made;
        });
    const std::vector<TileChange> changes = rebuild.rebuild(stack_, after, progress);
    file_->add(added, changes);
  } catch (...) {
    before.restore(storage_);
    throw;
  }
  take_stack(std::move(after));
  show_all();
  return report;
}

}  // namespace normalshop
