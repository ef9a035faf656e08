#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace normalshop {

/// A file that is written beside its target and takes its place only when it is complete: readers
/// see the old file or the new one, never half of it.
class PendingFile {
 public:
  /// Makes `.name.tmp-XXXXXX` in the target's folder. Throws IoError when the folder is missing or
  /// not writable, or the target is a folder.
  explicit PendingFile(std::filesystem::path target);
  PendingFile(const PendingFile&) = delete;
  PendingFile& operator=(const PendingFile&) = delete;
  /// Removes the temporary file unless it was committed.
  ~PendingFile();

  /// Where to write. The file exists and is empty.
  const std::filesystem::path& path() const { return temporary_; }
  /// Flushes to the disk and renames. Throws IoError.
  void commit();

 private:
  std::filesystem::path target_;
  std::filesystem::path temporary_;
  bool committed_ = false;
};

/// All bytes of a file. Throws IoError: missing, a folder, a device, unreadable, or larger than
/// `max_bytes`.
std::string read_file(const std::filesystem::path& path,
                      std::size_t max_bytes = std::size_t{1} << 34);

/// Replaces or creates a file with these bytes. Throws IoError and leaves no trace then.
void write_file(const std::filesystem::path& path, std::span<const std::byte> bytes);
void write_file(const std::filesystem::path& path, std::string_view text);

}  // namespace normalshop
