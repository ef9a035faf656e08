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

EditReport Document::apply(const Edit& edit, const TransferOptions& transfer) {
  assert(!live_);
  const EditReport report = apply_edit(edit, mesh_, seams_, cover_, storage_, transfer);
  log_.push_back(edit);
  return report;
}

std::unique_ptr<LiveEdit> Document::begin(Edit edit) {
  assert(!live_);
  // Its constructor is the document's alone.
  return std::unique_ptr<LiveEdit>(new LiveEdit(*this, std::move(edit)));
}

}  // namespace normalshop
