#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>

#include "model_flags.h"
#include "verbs.h"

#include "normalshop/core/options.h"
#include "normalshop/io/atomic_file.h"
#include "normalshop/io/file_assets.h"
#include "normalshop/io/stored_document.h"

namespace normalshop::cli {

namespace {

namespace fs = std::filesystem;

struct LayerFlags {
  fs::path document;
  std::string action;
  std::string layer;
  std::string name;
  std::string opacity;
  std::string blend;
  bool hide = false;
  bool show = false;
  std::string place;
  bool json = false;
};

const std::vector<std::pair<std::string, StackStep>>& actions() {
  static const std::vector<std::pair<std::string, StackStep>> all{
      {"add", StackStep::AddLayer},   {"set", StackStep::SetLayer},
      {"move", StackStep::MoveLayer}, {"duplicate", StackStep::Duplicate},
      {"merge", StackStep::Merge},    {"remove", StackStep::Remove}};
  return all;
}

std::int64_t whole_number(const std::string& text, const char* flag) {
  const auto number = read_number(text);
  constexpr double most = 1e9;
  if (!number || !(*number >= 0.0 && *number <= most) || *number != std::floor(*number)) {
    throw WrongUse(flag, "must be a whole number, not '" + text + "'");
  }
  return static_cast<std::int64_t>(*number);
}

StackChange change_of(const LayerFlags& flags, StackStep step) {
  StackChange change;
  change.step = step;
  if (step == StackStep::AddLayer) {
    if (!flags.layer.empty()) throw WrongUse("layer", "is not taken by \"add\"");
  } else if (flags.layer.empty()) {
    throw WrongUse("layer", "must be given: \"normalshop layers DOCUMENT\" lists them");
  } else {
    change.target = whole_number(flags.layer, "layer");
  }
  if (!flags.name.empty()) change.name = flags.name;
  if (!flags.opacity.empty()) {
    const auto number = read_number(flags.opacity);
    if (!number || !(*number >= 0.0 && *number <= 1.0)) {
      throw WrongUse("--opacity", "must be from 0 to 1, not '" + flags.opacity + "'");
    }
    change.opacity = static_cast<float>(*number);
  }
  LayerBlend blend = LayerBlend::Linear;
  if (!flags.blend.empty() && from_name(flags.blend, blend)) change.blend = blend;
  if (flags.hide && flags.show) throw WrongUse("--hide", "cannot go with --show");
  if (flags.hide || flags.show) change.hidden = flags.hide;
  if (!flags.place.empty()) change.place = static_cast<int>(whole_number(flags.place, "--place"));
  const bool looks = change.name || change.opacity || change.blend || change.hidden;
  if (looks && step != StackStep::AddLayer && step != StackStep::SetLayer) {
    throw WrongUse("--name, --opacity, --blend, --hide and --show",
                   "go with \"add\" and \"set\" alone");
  }
  if (step == StackStep::SetLayer && !looks) throw WrongUse("set", "needs a flag that says what");
  if (step == StackStep::MoveLayer && !change.place) throw WrongUse("move", "needs --place");
  if (change.place && step != StackStep::AddLayer && step != StackStep::MoveLayer) {
    throw WrongUse("--place", "goes with \"add\" and \"move\" alone");
  }
  return change;
}

void print_layer(const Layer& layer) {
  const std::size_t enabled = layer.recipes().size();
  std::printf("%lld '%s': %zu %s", static_cast<long long>(layer.id), layer.name.c_str(),
              layer.edits.size(), layer.edits.size() == 1 ? "edit" : "edits");
  if (enabled < layer.edits.size()) std::printf(" (%zu enabled)", enabled);
  if (layer.opacity < 1.0F) {
    std::printf(", opacity %g, %s", static_cast<double>(layer.opacity),
                std::string(name_of(layer.blend)).c_str());
  }
  std::printf("%s\n", layer.hidden ? ", hidden" : "");
}

/// The topmost first, as they lie.
void print_layers(const EditStack& stack) {
  for (std::size_t i = stack.layers.size(); i-- > 0;) print_layer(stack.layers[i]);
}

void list_layers(const LayerFlags& flags) {
  const DocumentFile file(flags.document);
  print_notes(file.notes());
  if (flags.json) {
    std::fputs(to_json(layers_value(file.stack())).c_str(), stdout);
  } else {
    print_layers(file.stack());
  }
}

void run_layers(const LayerFlags& flags) {
  if (flags.action.empty()) return list_layers(flags);
  const auto action = std::find_if(actions().begin(), actions().end(),
                                   [&](const auto& a) { return a.first == flags.action; });
  const StackChange change = change_of(flags, action->second);
  OpenedDocument opened = open_stored_document(flags.document);
  print_notes(opened.notes);
  opened.document.change(change);
  if (flags.json) {
    std::fputs(to_json(layers_value(opened.document.stack())).c_str(), stdout);
  } else {
    print_layers(opened.document.stack());
  }
}

void add_layers_verb(CommandLine& program) {
  Verb verb = program.verb("layers", "Lists the layers of a document, or changes one of them");
  LayerFlags& flags = verb.runs(run_layers);
  std::vector<std::string> names;
  for (const auto& action : actions()) names.push_back(action.first);
  verb.takes("document", flags.document, "Document (.nshop)").required();
  verb.takes("action", flags.action, "What to do; none: list them").one_of(names);
  verb.takes("layer", flags.layer, "Number of the layer, for all but \"add\"");
  verb.takes("--name", flags.name, "What it is called");
  verb.takes("--opacity", flags.opacity, "From 0 to 1: how much of it shows");
  verb.takes("--blend", flags.blend,
             "What an opacity below 1 does to normals: mixes slopes or turns")
      .one_of({"linear", "rotation"});
  verb.flag("--hide", flags.hide, "Leave it out");
  verb.flag("--show", flags.show, "Take it in again");
  verb.takes("--place", flags.place, "Among the layers, 0 is the lowest");
  verb.flag("--json", flags.json, "Print the layers as JSON, the lowest first");
}

struct EditFlags {
  fs::path document;
  std::string edit;
  fs::path recipe;
  std::vector<std::string> fields;
};

std::int64_t edit_number(const EditFlags& flags) {
  const auto number = edit_from_text(flags.edit);
  if (!number)
    throw WrongUse("edit",
                   "must be a number as \"normalshop log\" tells, not '" + flags.edit + "'");
  return *number;
}

void run_switch(const EditFlags& flags, StackStep step) {
  StackChange change;
  change.step = step;
  change.target = edit_number(flags);
  OpenedDocument opened = open_stored_document(flags.document);
  print_notes(opened.notes);
  opened.document.change(change);
  std::printf("%sd edit %s\n", std::string(name_of(step)).c_str(), flags.edit.c_str());
}
void run_enable(const EditFlags& flags) { run_switch(flags, StackStep::Enable); }
void run_disable(const EditFlags& flags) { run_switch(flags, StackStep::Disable); }

/// "options.width=0.02": JSON behind the sign, or else a text.
Value with_assignment(const Value& edit, const std::string& assignment) {
  const std::size_t equals = assignment.find('=');
  if (equals == 0 || equals == std::string::npos) {
    throw WrongUse("--set", "must be FIELD=VALUE, not '" + assignment + "'");
  }
  const std::string text = assignment.substr(equals + 1);
  Value value;
  try {
    value = parse_json(text, "--set");
  } catch (const InvalidInput&) {
    value = text;
  }
  return with_field(edit, assignment.substr(0, equals), value);
}

/// What the edit is to become.
Edit changed_edit(const EditFlags& flags, const Document& document, std::int64_t number) {
  if (!flags.recipe.empty()) {
    FileAssets assets(flags.recipe.parent_path());
    const Recipe recipe = parse_recipe(read_file(flags.recipe), flags.recipe.string(), assets);
    if (recipe.edits.size() == 1) return recipe.edits.front();
    throw WrongUse("recipe", "must hold one edit, not " + std::to_string(recipe.edits.size()));
  }
  const Layer& layer = document.stack().layers[document.stack().layer_of(number)];
  const auto edit = std::find_if(layer.edits.begin(), layer.edits.end(),
                                 [&](const StackEdit& e) { return e.id == number; });
  const DocumentFile& file = *document.file();
  Value value = file.edit(edit->recipe);
  for (const std::string& field : flags.fields) value = with_assignment(value, field);
  FileAssets assets(file.files_of(edit->recipe));
  return read_edit(value, "edit " + flags.edit, assets);
}

void run_change(const EditFlags& flags) {
  const std::int64_t number = edit_number(flags);
  if (flags.recipe.empty() == flags.fields.empty()) {
    throw WrongUse("recipe", "or --set must be given, and not both");
  }
  OpenedDocument opened = open_stored_document(flags.document);
  print_notes(opened.notes);
  opened.document.change_edit(number, changed_edit(flags, opened.document, number));
  std::printf("changed edit %s\n", flags.edit.c_str());
}

Verb add_edit_number_verb(CommandLine& program, const char* name, const char* summary,
                          void (*run)(const EditFlags&), EditFlags*& flags) {
  Verb verb = program.verb(name, summary);
  flags = &verb.runs(run);
  verb.takes("document", flags->document, "Document (.nshop)").required();
  verb.takes("edit", flags->edit, "Number of the edit, from the log").required();
  return verb;
}

}  // namespace

void add_layer_verbs(CommandLine& program) {
  add_layers_verb(program);
  EditFlags* flags = nullptr;
  add_edit_number_verb(program, "disable", "Leaves an edit of a document out", run_disable, flags);
  add_edit_number_verb(program, "enable", "Takes an edit in that was left out", run_enable, flags);
  Verb verb = add_edit_number_verb(program, "change", "Gives an edit of a document other options",
                                   run_change, flags);
  verb.takes("recipe", flags->recipe, "JSON file with the edit that it becomes");
  verb.takes("--set", flags->fields, "A field, as options.width=0.02; may be repeated");
}

}  // namespace normalshop::cli
