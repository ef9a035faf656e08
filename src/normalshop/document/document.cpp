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

void Document::record(Edit edit, const EditReport& report, const MapsBefore* before) {
  if (!file_) {
    log_.push_back(std::move(edit));
    return;
  }
  try {
    const std::int64_t layer = active_layer();
    const StackChange change{StackStep::Edit, layer};
    const std::int64_t id =
        file_->add({change, &edit, report.pushed.changed}, changed_tiles(*before, storage_, layer));
    stack_.take(change, id);
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
  if (!shows_active_layer()) return restack({{StackStep::Edit, active_layer()}, &edit}, {});
  const MapsBefore before(storage_, edit.operation->moves_colors());
  const EditReport report = apply_edit(edit, mesh_, seams_, cover_, storage_, transfer);
  record(edit, report, &before);
  return report;
}

std::unique_ptr<LiveEdit> Document::begin(Edit edit) {
  assert(!live_);
  check_seen(active_layer());
  // Its constructor is the document's alone.
  return std::unique_ptr<LiveEdit>(new LiveEdit(*this, std::move(edit)));
}

}  // namespace normalshop
