#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "normalshop/io/detail/model_source.h"

/// Inside the io floor: the lines and words of OBJ and MTL files.
namespace normalshop {

std::string_view trimmed(std::string_view text);
/// Takes the first word off the line.
std::string_view next_word(std::string_view& line);
/// With "/" between folders.
std::string obj_path(std::string name);
/// Files that "mtllib" lines name: a line is one name with spaces, or several names.
std::vector<std::string> obj_libraries(const ModelSource& source);

/// visit(number, line) for every logical line: without comments, "\" at the end joins the next.
template <class Visitor>
void for_each_obj_line(std::string_view text, Visitor&& visit) {
  std::string joined;
  std::size_t number = 0;
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    std::string_view line = text.substr(0, end);
    text.remove_prefix(end == text.npos ? text.size() : end + 1);
    ++number;
    line = trimmed(line.substr(0, line.find('#')));
    if (line.ends_with('\\')) {
      joined += line.substr(0, line.size() - 1);
      joined += ' ';
      continue;
    }
    if (joined.empty()) {
      visit(number, line);
      continue;
    }
    joined += line;
    visit(number, std::string_view(joined));
    joined.clear();
  }
  if (!joined.empty()) visit(number, std::string_view(joined));
}

}  // namespace normalshop
