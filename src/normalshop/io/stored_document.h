#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "normalshop/io/open_document.h"

/// Documents on file, which hold the model and all that it needs.
namespace normalshop {

/// Makes a document of a model and its maps: reads all that an export will need and puts it into
/// the file, byte for byte. `target` must not exist; it is there only once it is whole. Returns
/// sentences for the user. Throws IoError, InvalidInput or DocumentError.
std::vector<std::string> make_document(const OpenOptions& options,
                                       const std::filesystem::path& target,
                                       const Progress& progress = {});

/// Opens a document: nothing but its file is read. Its notes are those for the user of a document.
/// Throws DocumentError, also where the file does not hold what an import by this program needs.
OpenedDocument open_stored_document(const std::filesystem::path& path,
                                    const Progress& progress = {});

}  // namespace normalshop
