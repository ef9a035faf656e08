#include <cstdio>
#include <string>

#include "verbs.h"

#include "normalshop/document/edit_operator.h"

namespace normalshop::cli {

namespace {

struct DescribeFlags {
  bool json = false;
};

void print_text() {
  const Value described = describe_operators();
  for (const Value& type : *described.array()) {
    std::printf("%s: %s.\n  strokes: %s\n", type.find("operator")->text()->c_str(),
                type.find("summary")->text()->c_str(), type.find("strokes")->text()->c_str());
    for (const Value& field : *type.find("options")->array()) {
      const Value* unit = field.find("unit");
      const Value* standard = field.find("default");
      std::string fallback = standard == nullptr ? "required" : to_json(*standard);
      if (standard != nullptr) fallback = "default " + fallback.substr(0, fallback.size() - 1);
      std::printf("  %-12s %s%s%s (%s)\n", field.find("name")->text()->c_str(),
                  field.find("help")->text()->c_str(), unit != nullptr ? "; unit: " : "",
                  unit != nullptr ? unit->text()->c_str() : "", fallback.c_str());
    }
    std::printf("\n");
  }
}

void run_describe(const DescribeFlags& flags) {
  if (flags.json) {
    std::fputs(to_json(describe_operators()).c_str(), stdout);
  } else {
    print_text();
  }
}

}  // namespace

void add_describe_verb(CommandLine& program) {
  Verb verb = program.verb("describe", "Lists the operators and their options");
  DescribeFlags& flags = verb.runs(run_describe);
  verb.flag("--json", flags.json, "As JSON");
}

}  // namespace normalshop::cli
