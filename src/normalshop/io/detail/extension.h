#pragma once

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <string>

/// Inside the io floor: names of files by their ends, in any case.
namespace normalshop {

inline std::string lower_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

/// ".png" of "A.PNG"; empty without one.
inline std::string extension_of(const std::filesystem::path& path) {
  return lower_case(path.extension().string());
}

}  // namespace normalshop
