#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "normalshop/io/open_document.h"

/// How a model gets into a document's file and out again.
namespace normalshop {

/// Remembers what is read from other files.
class RecordedFiles : public FileSource {
 public:
  explicit RecordedFiles(std::shared_ptr<const FileSource> source) : source_(std::move(source)) {}
  bool has(const std::filesystem::path& path) const override { return source_->has(path); }
  std::string read(const std::filesystem::path& path) const override;
  std::vector<NamedFile> files() const;

 private:
  std::shared_ptr<const FileSource> source_;
  mutable std::map<std::string, std::shared_ptr<const std::string>> files_;
};

/// Files inside a document, by the names that they had.
class HeldFiles : public FileSource {
 public:
  explicit HeldFiles(std::shared_ptr<const DocumentFile> file) : file_(std::move(file)) {}
  bool has(const std::filesystem::path& path) const override;
  std::string read(const std::filesystem::path& path) const override;

 private:
  std::shared_ptr<const DocumentFile> file_;
};

/// How a document was imported, with its own files as the source. Throws DocumentError.
OpenOptions read_import(const std::shared_ptr<DocumentFile>& file);

/// Opens a model and puts all that an export of it will need into a new document. `source` has the
/// files; the document appears at `target` once `edit`, which gets what was opened kept in it, is
/// done. Returns the notes for the user. Throws IoError, InvalidInput or DocumentError.
std::vector<std::string> import_document(OpenOptions options, const std::filesystem::path& target,
                                         const Progress& progress,
                                         const std::function<void(OpenedDocument&)>& edit);

/// Keeps what was opened in the file that it was imported to. Throws DocumentError when the file
/// was made from something else.
void keep_in_file(OpenedDocument& opened, const std::shared_ptr<DocumentFile>& file);

}  // namespace normalshop
