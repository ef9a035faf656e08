#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "normalshop/document/document.h"
#include "normalshop/io/conventions.h"
#include "normalshop/io/model.h"

namespace normalshop {

/// How a user opens a model. Everything that is not given is taken from the file or guessed.
struct OpenOptions {
  std::filesystem::path model;
  /// "FILE", or "SET=FILE" where the model has several texture sets.
  std::vector<std::string> normal_maps;
  std::vector<std::string> albedos;
  std::optional<NormalSpace> space;
  std::optional<bool> green_down;
  bool flip_v = false;
  int size = 0;  ///< larger side of the normal maps in texels; 0: as they are
  std::shared_ptr<const FileSource> files = disk_files();  ///< that hold all of these
  /// What the codes of a texture set are known to mean, by its name: then that is not guessed.
  std::map<std::string, NormalConvention> conventions = {};
};

/// Where a texture set's normals came from.
struct OpenedSet {
  std::string normal_map;  ///< file, or how it is embedded; empty: none, the map is flat
  std::filesystem::path normal_map_path;  ///< empty unless it is a file of its own
  std::filesystem::path albedo_path;      ///< likewise
  CodeType type = CodeType::U8;           ///< of the imported codes
  bool tiff = false;
  bool half_float = false;  ///< F32 codes that were 16-bit floats
  int imported_width = 0;
  int imported_height = 0;
  std::optional<ConventionGuess> guess;
};

struct OpenedDocument {
  Model model;  ///< its mesh has moved into the document
  Document document;
  std::vector<OpenedSet> sets;
  std::vector<std::string> notes;  ///< sentences for the user: what was guessed, made or ignored
};

/// Reads the model and its maps. Throws IoError or InvalidInput.
OpenedDocument open_document(const OpenOptions& options, const Progress& progress = {});

}  // namespace normalshop
