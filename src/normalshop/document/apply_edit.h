#pragma once

#include <span>

#include "normalshop/document/document.h"

namespace normalshop {

/// The one way of an edit: view -> editing chart -> operator -> edited chart -> storage atlas.
/// `seams` are those of the whole mesh, `cover` is of no other mesh. Throws before anything
/// changes.
EditReport apply_edit(const Edit& edit, const Mesh& mesh, std::span<const SeamEdge> seams,
                      SurfaceCover& cover, StorageAtlas& storage, const TransferOptions& transfer);

}  // namespace normalshop
