#pragma once

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string_view>

namespace normalshop::test {

/// A file of the real data (models and maps that the project does not hold itself), or nothing when
/// it is not on this machine: the test then skips itself. The folder is $NORMALSHOP_DATA, else
/// ../shared/data beside the source folder.
inline std::optional<std::filesystem::path> data_file(std::string_view name) {
  const char* folder = std::getenv("NORMALSHOP_DATA");
  const std::filesystem::path root =
      folder != nullptr ? std::filesystem::path(folder)
                        : std::filesystem::path(NORMALSHOP_SOURCE_DIR) / ".." / "shared" / "data";
  const std::filesystem::path path = root / name;
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) return std::nullopt;
  return path;
}

}  // namespace normalshop::test
