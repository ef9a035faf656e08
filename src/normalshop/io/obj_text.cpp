#include "normalshop/io/detail/obj_text.h"

#include <system_error>

namespace normalshop {

namespace fs = std::filesystem;

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r\f\v");
  if (first == text.npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r\f\v") - first + 1);
}

std::string_view next_word(std::string_view& line) {
  line = trimmed(line);
  const std::size_t end = line.find_first_of(" \t\r\f\v");
  const std::string_view word = line.substr(0, end);
  line.remove_prefix(word.size());
  return word;
}

bool holds_name(std::string_view statement) {
  const std::string_view key = next_word(statement);
  return key == "usemtl" || key == "mtllib";
}

std::string obj_path(std::string name) {
  for (char& c : name) {
    if (c == '\\') c = '/';
  }
  return name;
}

std::vector<std::string> obj_libraries(const ModelSource& source) {
  std::vector<std::string> names;
  for (const std::string& line : source.libraries) {
    if (source.files->has(source.folder / obj_path(line))) {
      names.push_back(obj_path(line));
      continue;
    }
    std::string_view rest = line;
    for (auto word = next_word(rest); !word.empty(); word = next_word(rest)) {
      const fs::path file = source.folder / obj_path(std::string(word));
      if (word.starts_with('#') && !source.files->has(file)) break;
      names.push_back(obj_path(std::string(word)));
    }
  }
  return names;
}

}  // namespace normalshop
