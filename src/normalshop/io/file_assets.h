#pragma once

#include <filesystem>

#include "normalshop/document/assets.h"

namespace normalshop {

/// Patches, kernels and fonts from files; relative names start in `folder`.
class FileAssets : public Assets {
 public:
  explicit FileAssets(std::filesystem::path folder) : folder_(std::move(folder)) {}

  Patch patch(const std::string& file) override;
  Image<float> kernel(const std::string& file) override;
  Outline text(const std::string& text, const std::string& font) override;

 private:
  std::filesystem::path folder_;
};

}  // namespace normalshop
