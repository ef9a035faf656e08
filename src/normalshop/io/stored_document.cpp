#include "normalshop/io/stored_document.h"

#include "normalshop/core/error.h"
#include "normalshop/io/detail/document_import.h"

namespace normalshop {

namespace fs = std::filesystem;

std::vector<std::string> make_document(const OpenOptions& wanted, const fs::path& target,
                                       const Progress& progress) {
  OpenOptions options = wanted;
  // Exports tell the model's own folder by it, wherever they are started.
  options.model = fs::absolute(options.model);
  return import_document(options, target, progress, {});
}

OpenedDocument open_stored_document(const fs::path& path, const Progress& progress) {
  const auto file = std::make_shared<DocumentFile>(path);
  OpenedDocument opened = [&] {
    try {
      return open_document(read_import(file), progress);
    } catch (const InvalidInput& error) {
      throw DocumentError("'" + path.string() + "' cannot be opened: " + error.what());
    }
  }();
  keep_in_file(opened, file);
  opened.notes = file->notes();
  return opened;
}

}  // namespace normalshop
