#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "normalshop/core/progress.h"

namespace normalshop {

/// What becomes different when a document's edits are made again. What is left empty stays.
struct ReplayOptions {
  int size = 0;                          ///< larger side of the normal maps in texels
  std::filesystem::path model;           ///< with the same UVs, or of the same shape
  std::vector<std::string> normal_maps;  ///< as in OpenOptions
  bool flip_v = false;                   ///< of `model`
  /// Leaves edits out that cannot be made there, with a note for each.
  bool skip_failing = false;
};

/// Makes a new document with the layers of another one and makes all their enabled edits again: on
/// maps of another size, on other maps, or on another model. Nothing is there before all is done.
/// Returns sentences for the user. Throws IoError, InvalidInput, DocumentError or Cancelled.
std::vector<std::string> replay_document(const std::filesystem::path& source,
                                         const ReplayOptions& options,
                                         const std::filesystem::path& target,
                                         const Progress& progress = {});

}  // namespace normalshop
