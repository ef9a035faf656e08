#pragma once

#include <filesystem>

#include "normalshop/document/value.h"
#include "normalshop/io/model.h"

namespace normalshop {

/// What a model (meshes, texture sets, charts, seams, overlaps, texel density, guessed conventions)
/// an image or a document is, for people and programs. Throws IoError or InvalidInput.
Value file_info(const std::filesystem::path& file, const ModelReadOptions& reading = {});

}  // namespace normalshop
