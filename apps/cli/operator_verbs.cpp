#include <algorithm>
#include <cstdio>
#include <optional>

#include "image_flags.h"
#include "model_flags.h"
#include "verbs.h"

#include "normalshop/core/error.h"
#include "normalshop/document/edit_operator.h"
#include "normalshop/io/edit_report.h"
#include "normalshop/io/file_assets.h"

/// A verb for every operator: one edit of a picture with normals, without a recipe. Its flags are
/// the operator's own options.
namespace normalshop::cli {

namespace {

struct OperatorFlags {
  const OperatorType* type = nullptr;
  ImageFlags image;
  std::vector<std::string> options;  ///< in the order of the operator's fields; empty: not given
  std::vector<std::string> strokes;
  std::string details;
  float strength = 1.0F;
  ImageExport output;
  bool json = false;
};

std::string flag_of(const Value& field) { return "--" + *field.find("name")->text(); }

/// "1,2,3"; none when it is something else.
std::optional<Value::Array> read_numbers(std::string_view text) {
  Value::Array numbers;
  std::size_t from = 0;
  while (from <= text.size()) {
    const std::size_t comma = std::min(text.find(',', from), text.size());
    const auto number = read_number(text.substr(from, comma - from));
    if (!number) return std::nullopt;
    numbers.emplace_back(*number);
    from = comma + 1;
  }
  return numbers;
}

/// As recipes have it. What does not look like its type stays a text, which the operator refuses in
/// its own words.
Value option_value(const Value& field, const std::string& text) {
  const std::string& type = *field.find("type")->text();
  if (type == "number" || type == "integer") {
    if (const auto number = read_number(text)) return *number;
  }
  if (type == "switch" && (text == "true" || text == "false")) return text == "true";
  if (type == "curve") return parse_json(text, flag_of(field));
  if (type == "numbers") {
    if (const auto numbers = read_numbers(text)) return *numbers;
  }
  return text;
}

/// "x,y" or "x,y,pressure".
Value read_point(std::string_view text) {
  const auto point = read_numbers(text);
  if (point && (point->size() == 2 || point->size() == 3)) return *point;
  throw WrongUse("--stroke", "must be points x,y or x,y,pressure with spaces between them, not \"" +
                                 std::string(text) + "\"");
}

Value read_stroke(std::string_view text) {
  Value::Array points;
  while (true) {
    const std::size_t begin = text.find_first_not_of(' ');
    if (begin == std::string_view::npos) return points;
    const std::size_t end = std::min(text.find(' ', begin), text.size());
    points.push_back(read_point(text.substr(begin, end - begin)));
    text.remove_prefix(end);
  }
}

Value edit_value(const OperatorFlags& flags) {
  Value::Object options;
  const Value::Array fields = flags.type->fields();
  for (std::size_t i = 0; i < fields.size(); ++i) {
    if (flags.options[i].empty()) continue;
    options.emplace_back(*fields[i].find("name")->text(),
                         option_value(fields[i], flags.options[i]));
  }
  Value::Object edit{{"operator", flags.type->name},
                     {"view", "front"},
                     {"strength", flags.strength},
                     {"options", options}};
  if (!flags.details.empty()) edit.emplace_back("details", flags.details);
  Value::Array strokes;
  for (const std::string& stroke : flags.strokes) strokes.push_back(read_stroke(stroke));
  if (!strokes.empty()) edit.emplace_back("strokes", strokes);
  return edit;
}

/// The fields of the edit by the names of their flags: "edit.options.sigma" is "--sigma".
std::string with_flags(std::string message) {
  const auto replace = [&](const std::string& field, const std::string& flag) {
    if (message.starts_with(field)) message.replace(0, field.size(), flag);
  };
  replace("edit.options.", "--");
  replace("edit.options: ", "");
  replace("edit.strokes", "--stroke");
  replace("edit.strength", "--strength");
  return message;
}

Recipe read_recipe(const OperatorFlags& flags) {
  FileAssets assets{std::filesystem::path()};
  try {
    return {{read_edit(edit_value(flags), "edit", assets)}};
  } catch (const InvalidInput& error) {
    throw WrongUse(with_flags(error.what()));
  }
}

ImageJob run(const OperatorFlags& flags, const Recipe& recipe, const ImageExport& output) {
  try {
    return run_image_job(flags.image.open(), recipe, output);
  } catch (const InvalidInput& error) {
    throw InvalidInput(with_flags(error.what()));
  }
}

void run_operator_verb(const OperatorFlags& flags) {
  const Recipe recipe = read_recipe(flags);
  ImageExport output = flags.output;
  output.type = code_type(flags.image.bits);
  const ImageJob job = run(flags, recipe, output);
  print_notes(job.opened.notes);
  if (flags.json) {
    std::fputs(to_json(report_value(job)).c_str(), stdout);
    return;
  }
  const EditReport& edit = job.edits.front();
  std::printf("%zu pixels changed, largest change %.1f degrees, %.0f ms\n", edit.pushed.changed,
              static_cast<double>(edit.pushed.largest_change),
              1e3 * (edit.times.pull + edit.times.operate + edit.times.push));
  for (const auto& file : job.files) std::printf("wrote %s\n", file.string().c_str());
}

/// The field's help with its unit, range and default.
std::string help_of(const Value& field) {
  std::string help = *field.find("help")->text();
  std::string facts;
  const auto add = [&](const std::string& fact) { facts += (facts.empty() ? "" : ", ") + fact; };
  if (const Value* unit = field.find("unit")) {
    const std::string& name = *unit->text();
    if (name != "1") add(name == "length" ? "pixels" : name);
  }
  if (*field.find("type")->text() == "numbers") add("numbers with commas between them");
  if (const Value* range = field.find("range")) {
    add(to_line((*range->array())[0]) + " to " + to_line((*range->array())[1]));
  }
  if (const Value* standard = field.find("default")) {
    if (standard->array() == nullptr) add("default " + to_line(*standard));
  } else {
    add("required");
  }
  return facts.empty() ? help : help + " [" + facts + "]";
}

std::vector<std::string> names_of_field(const Value& field) {
  std::vector<std::string> names;
  if (const Value* list = field.find("names")) {
    for (const Value& name : *list->array()) names.push_back(*name.text());
  }
  return names;
}

void add_operator_verb(CommandLine& program, const OperatorType& type) {
  Verb verb = program.verb(std::string(type.name), std::string(type.summary) + " (on a picture)");
  OperatorFlags& flags = verb.runs(run_operator_verb);
  flags.type = &type;
  verb.takes("normals", flags.image.files.normals, "Normal map of the picture").required();
  verb.takes("--color", flags.image.files.color, "Its colours");
  verb.takes("-o,--output", flags.output.normals, "File for the edited normals").required();
  verb.takes("--color-output", flags.output.color, "File for the colours, where they move too");
  const Value::Array fields = type.fields();
  flags.options.resize(fields.size());
  for (std::size_t i = 0; i < fields.size(); ++i) {
    Argument argument = verb.takes(flag_of(fields[i]), flags.options[i], help_of(fields[i]));
    const std::vector<std::string> names = names_of_field(fields[i]);
    if (!names.empty()) argument.one_of(names);
    if (fields[i].find("required") != nullptr) argument.required();
  }
  verb.takes("--stroke", flags.strokes,
             std::string(type.strokes) +
                 ": \"x,y x,y,pressure ...\" in pixels from the picture's middle, y up; may be "
                 "repeated");
  verb.takes("--strength", flags.strength, "How much of the edit arrives [0 to 1, default 1]");
  verb.takes("--details", flags.details, "What happens to the details under the edit")
      .one_of({"keep", "ignore"});
  flags.image.add(verb);
  flags.image.add_green(verb);
  flags.image.add_bits(verb);
  verb.flag("--json", flags.json, "Print a report as JSON");
}

}  // namespace

void add_operator_verbs(CommandLine& program) {
  for (const OperatorType& type : operator_types()) add_operator_verb(program, type);
}

}  // namespace normalshop::cli
