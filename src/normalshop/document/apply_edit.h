#pragma once

#include <span>

#include "normalshop/document/document.h"
#include "normalshop/surface/seam_mismatch.h"

namespace normalshop {

/// The one way of an edit: view -> editing chart -> operator -> edited chart -> storage atlas.
/// `seams` are those of the whole mesh, `cover` is of no other mesh. Throws before anything
/// changes.
EditReport apply_edit(const Edit& edit, const Mesh& mesh, std::span<const SeamEdge> seams,
                      SurfaceCover& cover, StorageAtlas& storage, const TransferOptions& transfer);

/// The maps as they are, for little: they share what nobody edits.
std::vector<NormalMap> copies_of(const StorageAtlas& storage);
std::vector<const NormalMap*> pointers_to(const std::vector<NormalMap>& maps);

/// After the push of an edit in one view: keeps both sides of the seams together (SeamFit) that may
/// lie among the texels which the edit in that region of the chart has changed.
void fit_seams(const Mesh& mesh, std::span<const SeamEdge> seams, const ChartGrid& grid,
               const Rect& region, NormalMaps before, StorageAtlas& storage);

}  // namespace normalshop
