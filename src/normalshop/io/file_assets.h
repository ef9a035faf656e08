#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "normalshop/document/assets.h"

namespace normalshop {

/// Patches, masks, kernels and fonts from files: those of a folder, where relative names start, or
/// some that are given.
class FileAssets : public Assets {
 public:
  explicit FileAssets(std::filesystem::path folder) : folder_(std::move(folder)) {}
  explicit FileAssets(std::vector<NamedFile> files) : given_(std::move(files)) {}

  Patch patch(const std::string& file) override;
  MaskImage mask(const std::string& file) override;
  Image<float> kernel(const std::string& file) override;
  Outline text(const std::string& text, const std::string& font) override;
  std::vector<NamedFile> take_files() override { return std::exchange(read_, {}); }

 private:
  /// The bytes behind a name, which stands for `path` in the folder.
  const std::string& read(const std::string& name, const std::filesystem::path& path,
                          std::size_t largest);

  std::filesystem::path folder_;
  std::optional<std::vector<NamedFile>> given_;
  std::vector<NamedFile> read_;
};

}  // namespace normalshop
