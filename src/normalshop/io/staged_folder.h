#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace normalshop {

/// A folder for several files that belong together: they are written into a hidden folder inside
/// it and take their places when all of them are complete. Without commit() nothing is left behind.
class StagedFolder {
 public:
  /// Makes `folder`, where it is missing, and `.normalshop-XXXXXX` inside it. Throws IoError when
  /// that is not possible, so that a job can find out before it begins.
  explicit StagedFolder(std::filesystem::path folder);
  StagedFolder(const StagedFolder&) = delete;
  StagedFolder& operator=(const StagedFolder&) = delete;
  ~StagedFolder();

  /// Where to write.
  const std::filesystem::path& path() const { return staging_; }
  /// Where it will be.
  const std::filesystem::path& folder() const { return folder_; }
  /// Runs `job`; an Error's message names the files where they were to be, not where they are
  /// prepared.
  void write(const std::function<void()>& job) const;
  /// Moves `files`, all below path(), to their places. Returns these. Throws IoError.
  std::vector<std::filesystem::path> commit(const std::vector<std::filesystem::path>& files);

 private:
  std::filesystem::path folder_;
  std::filesystem::path staging_;
  std::vector<std::filesystem::path> made_;  ///< folders that were missing, innermost first
};

}  // namespace normalshop
