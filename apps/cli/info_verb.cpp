#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>

#include "verbs.h"

#include "normalshop/core/options.h"
#include "normalshop/io/model_info.h"

namespace normalshop::cli {

namespace {

struct InfoFlags {
  std::filesystem::path file;
  bool flip_v = false;
  bool json = false;
};

/// On one line.
std::string text_of(const Value& value) {
  if (value.text() != nullptr) return *value.text();
  if (value.number() != nullptr) {
    std::array<char, 32> text{};
    const double number = *value.number();
    const bool whole = std::abs(number) < 1e15 && number == std::round(number);
    std::snprintf(text.data(), text.size(), whole ? "%.0f" : "%.4g", number);
    return text.data();
  }
  if (value.boolean() != nullptr) return *value.boolean() ? "yes" : "no";
  std::string all;
  if (value.array() == nullptr || value.array()->empty()) return "none";
  for (const Value& item : *value.array()) all += (all.empty() ? "" : ", ") + text_of(item);
  return all;
}

/// "name: value"; what has several lines, indented below its name.
void print_field(const std::string& name, const Value& field, int depth) {
  const int indent = 2 * depth;
  const Value::Array* list = field.array();
  const bool lines = list != nullptr && !list->empty() && list->front().number() == nullptr;
  if (lines && list->front().object() != nullptr) {
    for (const Value& item : *list) print_field(name, item, depth);
    return;
  }
  const bool nested = lines || field.object() != nullptr;
  std::printf("%*s%s:%s\n", indent, "", name.c_str(), nested ? "" : (" " + text_of(field)).c_str());
  if (lines) {
    for (const Value& line : *list) std::printf("%*s%s\n", indent + 2, "", text_of(line).c_str());
  } else if (nested) {
    for (const auto& [inner, value] : *field.object()) print_field(inner, value, depth + 1);
  }
}

void run_info(const InfoFlags& flags) {
  const Value info = file_info(flags.file, {.flip_v = flags.flip_v});
  if (flags.json) {
    std::fputs(to_json(info).c_str(), stdout);
  } else {
    for (const auto& [name, field] : *info.object()) print_field(name, field, 0);
  }
}

}  // namespace

void add_info_verb(CommandLine& program) {
  Verb verb = program.verb("info", "Says what a model, a map or a document is");
  InfoFlags& flags = verb.runs(run_info);
  verb.takes("file", flags.file, "Model (glTF, GLB, OBJ), image or document").required();
  verb.flag("--flip-v", flags.flip_v, "The model's V runs the other way than its format says");
  verb.flag("--json", flags.json, "Print as JSON");
}

}  // namespace normalshop::cli
