#include <cstdio>
#include <string>

#include "shade_styles.h"
#include "verbs.h"

#include "normalshop/document/edit_operator.h"

namespace normalshop::cli {

namespace {

struct DescribeFlags {
  std::string operation;  ///< empty: all
  bool styles = false;
  bool json = false;
};

std::string joined(const Value& names) {
  std::string text;
  for (const Value& name : *names.array()) text += (text.empty() ? "" : ", ") + *name.text();
  return text;
}

/// "unit; what is accepted; default", as far as there is one.
std::string remarks_of(const Value& field) {
  std::string text;
  const auto add = [&](const std::string& remark) { text += (text.empty() ? "" : "; ") + remark; };
  if (const Value* unit = field.find("unit")) add("unit: " + *unit->text());
  if (const Value* range = field.find("range")) {
    add(to_line(range->array()->front()) + " to " + to_line(range->array()->back()));
  }
  if (const Value* names = field.find("names")) add("one of " + joined(*names));
  const Value* standard = field.find("default");
  add(standard == nullptr ? "required" : "default " + to_line(*standard));
  return text;
}

Value described(const std::string& operation) {
  Value all = describe_operators();
  if (operation.empty()) return all;
  Value::Array one;
  for (const Value& type : *all.array()) {
    if (*type.find("operator")->text() == operation) one.push_back(type);
  }
  return one;
}

void print_text(const Value& described) {
  for (const Value& type : *described.array()) {
    const Value* name = type.find("operator");
    if (name == nullptr) name = type.find("style");
    std::printf("%s: %s.\n", name->text()->c_str(), type.find("summary")->text()->c_str());
    if (const Value* strokes = type.find("strokes")) {
      std::printf("  strokes: %s\n", strokes->text()->c_str());
    }
    for (const Value& field : *type.find("options")->array()) {
      std::printf("  %-12s %s (%s)\n", field.find("name")->text()->c_str(),
                  field.find("help")->text()->c_str(), remarks_of(field).c_str());
    }
    std::printf("\n");
  }
}

void run_describe(const DescribeFlags& flags) {
  const Value description = flags.styles ? describe_styles() : described(flags.operation);
  if (flags.json) {
    std::fputs(to_json(description).c_str(), stdout);
  } else {
    print_text(description);
  }
}

}  // namespace

void add_describe_verb(CommandLine& program) {
  Verb verb = program.verb("describe", "Lists the operators and their options");
  DescribeFlags& flags = verb.runs(run_describe);
  std::vector<std::string> names;
  for (const OperatorType& type : operator_types()) names.emplace_back(type.name);
  verb.takes("operator", flags.operation, "One of them (all unless given)").one_of(names);
  verb.flag("--styles", flags.styles, "The styles of shade and what --set sets, instead");
  verb.flag("--json", flags.json, "As JSON");
}

}  // namespace normalshop::cli
