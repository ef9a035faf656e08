#pragma once

#include <algorithm>
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

/// Is it a statement with a name, in which "#" starts no comment ("usemtl Material #25")?
bool holds_name(std::string_view statement);

/// visit(number, line, raw) for every statement: its last line's number, its words without comments
/// ("\" at the end of a line joins the next), and its bytes with the ends of their lines.
template <class Visitor>
void for_each_obj_line(std::string_view text, Visitor&& visit) {
  std::string joined;
  std::size_t number = 0;
  std::size_t begin = 0;  // of the statement
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    std::string_view line = text.substr(at, end - at);
    at = std::min(end + 1, text.size());
    ++number;
    if (!holds_name(joined.empty() ? line : std::string_view(joined))) {
      line = line.substr(0, line.find('#'));
    }
    line = trimmed(line);
    const bool goes_on = line.ends_with('\\');
    if (goes_on) line.remove_suffix(1);
    if (goes_on || !joined.empty()) joined += line;
    if (goes_on) joined += ' ';
    if (goes_on && at < text.size()) continue;
    visit(number, joined.empty() ? line : std::string_view(joined), text.substr(begin, at - begin));
    joined.clear();
    begin = at;
  }
}

}  // namespace normalshop
