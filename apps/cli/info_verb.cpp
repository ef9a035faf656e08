#include <cstdio>
#include <filesystem>

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

/// "name: value" lines, nested objects indented.
void print_value(const Value& value, int depth) {
  const int indent = 2 * depth;
  for (const auto& [name, field] : *value.object()) {
    if (field.object() != nullptr) {
      std::printf("%*s%s:\n", indent, "", name.c_str());
      print_value(field, depth + 1);
    } else if (field.array() != nullptr && !field.array()->empty() &&
               field.array()->front().object() != nullptr) {
      for (const Value& item : *field.array()) {
        std::printf("%*s%s:\n", indent, "", name.c_str());
        print_value(item, depth + 1);
      }
    } else if (field.text() != nullptr) {
      std::printf("%*s%s: %s\n", indent, "", name.c_str(), field.text()->c_str());
    } else {
      std::printf("%*s%s: %s", indent, "", name.c_str(), to_json(field).c_str());
    }
  }
}

void run_info(const InfoFlags& flags) {
  const Value info = file_info(flags.file, {.flip_v = flags.flip_v});
  if (flags.json) {
    std::fputs(to_json(info).c_str(), stdout);
  } else {
    print_value(info, 0);
  }
}

}  // namespace

void add_info_verb(CommandLine& program) {
  Verb verb = program.verb("info", "Says what a model or a map is");
  InfoFlags& flags = verb.runs(run_info);
  verb.takes("file", flags.file, "Model (glTF, GLB, OBJ) or image").required();
  verb.flag("--flip-v", flags.flip_v, "The model's V runs the other way than its format says");
  verb.flag("--json", flags.json, "Print as JSON");
}

}  // namespace normalshop::cli
