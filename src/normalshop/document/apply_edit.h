#pragma once

#include "normalshop/document/document.h"

namespace normalshop {

/// The one way of an edit: view -> editing chart -> operator -> edited chart -> storage atlas.
/// Throws before anything changes.
EditReport apply_edit(const Edit& edit, const Mesh& mesh, StorageAtlas& storage);

}  // namespace normalshop
