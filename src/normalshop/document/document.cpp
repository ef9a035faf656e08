#include "normalshop/document/document.h"

#include <cassert>

#include "normalshop/core/error.h"
#include "normalshop/document/apply_edit.h"
#include "normalshop/document/live_edit.h"
#include "normalshop/surface/tangents.h"
#include "normalshop/surface/topology.h"

namespace normalshop {

Document::Document(Mesh mesh, std::vector<Maps> maps, const Progress& progress)
    : mesh_(std::move(mesh)) {
  if (maps.size() != mesh_.texture_set_names.size()) {
    throw InvalidInput("the model has " + std::to_string(mesh_.texture_set_names.size()) +
                       " texture sets but maps were given for " + std::to_string(maps.size()));
  }
  if (mesh_.tangents.empty()) {
    progress.at(0.0, "tangents");
    compute_tangents(mesh_);
  }
  const Topology topology = make_topology(mesh_);
  seams_ = find_seams(topology).edges;
  for (std::size_t i = 0; i < maps.size(); ++i) {
    progress.at(static_cast<double>(i + 1) / static_cast<double>(maps.size() + 1), "texels");
    const int width = maps[i].normals.width();
    const int height = maps[i].normals.height();
    storage_.sets.push_back(
        {std::move(maps[i].normals), std::move(maps[i].albedo),
         TexelMap(mesh_, topology, static_cast<std::uint32_t>(i), width, height)});
  }
}

std::vector<Edit> Document::log() const {
  if (!file_) return log_;
  std::vector<Edit> edits;
  for (const HistoryEntry& entry : file_->history()) {
    if (entry.undone) break;
    const auto assets = assets_of_(file_->files_of(entry.id));
    const std::string name = file_->path().string() + ": edit " + std::to_string(entry.id);
    const Recipe recipe = parse_recipe(to_json(file_->recipe(entry.id)), name, *assets);
    edits.insert(edits.end(), recipe.edits.begin(), recipe.edits.end());
  }
  return edits;
}

void Document::keep_in(std::shared_ptr<DocumentFile> file, AssetsOf assets) {
  assert(!file_ && log_.empty());
  file_ = std::move(file);
  assets_of_ = std::move(assets);
  put(file_->tiles());
}

void Document::put(const std::vector<PackedTile>& tiles) {
  for (const PackedTile& tile : tiles) {
    try {
      put_tile(tile, storage_);
    } catch (const InvalidInput& error) {
      throw DocumentError("'" + file_->path().string() +
                          "' is damaged: " + file_->name_of_tile(tile.place) + " " + error.what());
    }
  }
  end_color_edits();
}

/// Codes of colours are those that came until an edit moves one, so that an edit reads the same
/// whether the document was closed before it or not.
void Document::end_color_edits() {
  for (std::size_t i = 0; i < storage_.sets.size(); ++i) {
    ColorMap& albedo = storage_.sets[i].albedo;
    const bool edited =
        file_ ? file_->has_colors(static_cast<std::uint32_t>(i)) : albedo.has_edits();
    if (!edited && !albedo.empty()) albedo.end_edits();
  }
}

void Document::record(Edit edit, const EditReport& report, const MapsBefore* before) {
  if (!file_) {
    log_.push_back(std::move(edit));
    return;
  }
  try {
    file_->add(edit, report.pushed.changed, changed_tiles(*before, storage_));
    end_color_edits();
  } catch (...) {
    before->restore(storage_);
    throw;
  }
}

EditReport Document::apply(const Edit& edit, const TransferOptions& transfer) {
  assert(!live_);
  if (!file_) {
    const EditReport report = apply_edit(edit, mesh_, seams_, cover_, storage_, transfer);
    record(edit, report, nullptr);
    return report;
  }
  if (!(transfer == TransferOptions{})) {
    throw InvalidInput(edit.path + ": a document on file takes edits by the usual transfer alone");
  }
  const MapsBefore before(storage_, edit.operation->moves_colors());
  const EditReport report = apply_edit(edit, mesh_, seams_, cover_, storage_, transfer);
  record(edit, report, &before);
  return report;
}

bool Document::undo() {
  assert(file_ && !live_);
  const auto tiles = file_->undo([&](const PackedTile& tile) { check_fits(tile, storage_); });
  if (tiles) put(*tiles);
  return tiles.has_value();
}

bool Document::redo() {
  assert(file_ && !live_);
  const auto tiles = file_->redo([&](const PackedTile& tile) { check_fits(tile, storage_); });
  if (tiles) put(*tiles);
  return tiles.has_value();
}

std::unique_ptr<LiveEdit> Document::begin(Edit edit) {
  assert(!live_);
  // Its constructor is the document's alone.
  return std::unique_ptr<LiveEdit>(new LiveEdit(*this, std::move(edit)));
}

}  // namespace normalshop
