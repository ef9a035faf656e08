#pragma once

#include <filesystem>
#include <memory>
#include <string>

namespace normalshop {

/// Where the files are that a model consists of: on the disk, or in a document.
class FileSource {
 public:
  FileSource() = default;
  FileSource(const FileSource&) = delete;
  FileSource& operator=(const FileSource&) = delete;
  virtual ~FileSource() = default;

  /// Is there a regular file of that name?
  virtual bool has(const std::filesystem::path& path) const = 0;
  /// All its bytes. Throws IoError, or DocumentError.
  virtual std::string read(const std::filesystem::path& path) const = 0;
};

const std::shared_ptr<const FileSource>& disk_files();

}  // namespace normalshop
