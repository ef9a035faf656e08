#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>

#include "export_flags.h"
#include "model_flags.h"
#include "verbs.h"

#include "normalshop/io/atomic_file.h"
#include "normalshop/io/edit_report.h"
#include "normalshop/io/file_assets.h"
#include "normalshop/io/stored_document.h"

namespace normalshop::cli {

namespace {

namespace fs = std::filesystem;

constexpr const char* document_help = "Document (.nshop)";

struct NewFlags {
  ModelFlags model;
  fs::path output;
};

void run_new(const NewFlags& flags) {
  print_notes(make_document(flags.model.options(), flags.output));
  std::printf("made %s\n", flags.output.string().c_str());
}

void add_new_verb(CommandLine& program) {
  Verb verb =
      program.verb("new", "Makes a document of a model and its maps: one file for all edits");
  NewFlags& flags = verb.runs(run_new);
  flags.model.add(verb).required();
  verb.takes("-o,--output", flags.output, "Document to be made, usually .nshop").required();
}

struct ApplyFlags {
  fs::path document;
  fs::path recipe;
  int layer = -1;
  bool json = false;
};

/// What edits before a failing one did is not lost, which the message tells.
EditReport apply_next(Document& document, const Edit& edit, std::size_t done) {
  try {
    return document.apply(edit);
  } catch (const Error& error) {
    if (done == 0) throw;
    throw Error(std::string(error.what()) +
                "; the document holds what came before it in the recipe");
  }
}

/// Each edit is safe in the file as soon as it is done.
void run_apply(const ApplyFlags& flags) {
  FileAssets assets(flags.recipe.parent_path());
  const Recipe recipe = parse_recipe(read_file(flags.recipe), flags.recipe.string(), assets);
  OpenedDocument opened = open_stored_document(flags.document);
  if (flags.layer >= 0) opened.document.choose_layer(flags.layer);
  std::vector<EditReport> reports;
  std::vector<std::string> notes = opened.notes;
  for (const Edit& edit : recipe.edits) {
    reports.push_back(apply_next(opened.document, edit, reports.size()));
    note_edit(edit, reports.back(), notes);
  }
  print_notes(notes);
  if (flags.json) {
    std::fputs(to_json(edits_value(recipe.edits, reports)).c_str(), stdout);
  } else {
    print_edits(recipe.edits, reports);
  }
}

void add_apply_verb(CommandLine& program) {
  Verb verb = program.verb("apply", "Applies the edits of a recipe to a document, one by one");
  ApplyFlags& flags = verb.runs(run_apply);
  verb.takes("document", flags.document, document_help).required();
  verb.takes("recipe", flags.recipe, "JSON file of edits (docs/recipes.md)").required();
  verb.takes("--layer", flags.layer, "Layer that the edits go to; else the topmost that shows")
      .between(0, 1000000000);
  verb.flag("--json", flags.json, "Print the reports as JSON");
}

struct LogFlags {
  fs::path document;
  bool all = false;
  bool json = false;
};

/// "7 pen: 120 texels changed (undone)"; with every branch also what it was made on.
void print_step(const HistoryEntry& entry, bool all) {
  std::printf("%lld ", static_cast<long long>(entry.id));
  if (all && entry.parent) std::printf("(on %lld) ", static_cast<long long>(*entry.parent));
  std::printf("%s", sentence(entry).c_str());
  const bool edits = entry.change.step == StackStep::Edit;
  if (edits || entry.texels_changed > 0) std::printf(": %zu texels changed", entry.texels_changed);
  const char* undone = all ? " (not on the present branch)" : " (undone)";
  std::printf("%s\n", entry.undone ? undone : "");
}

void run_log(const LogFlags& flags) {
  const DocumentFile file(flags.document);
  print_notes(file.notes());
  if (flags.json) {
    std::fputs(to_json(file.recipe()).c_str(), stdout);
    return;
  }
  for (const HistoryEntry& entry : flags.all ? file.all_steps() : file.history()) {
    print_step(entry, flags.all);
  }
}

void add_log_verb(CommandLine& program) {
  Verb verb =
      program.verb("log", "Lists the edits of a document and the other steps of its history");
  LogFlags& flags = verb.runs(run_log);
  verb.takes("document", flags.document, document_help).required();
  verb.flag("--all", flags.all,
            "Every branch: what was undone before something else was made, too");
  verb.flag("--json", flags.json, "Print the edits that show as a recipe");
}

struct JumpFlags {
  fs::path document;
  int step = 0;
};

void run_jump(const JumpFlags& flags) {
  DocumentFile file(flags.document);
  print_notes(file.notes());
  const std::optional<std::int64_t> step =
      flags.step > 0 ? std::optional<std::int64_t>(flags.step) : std::nullopt;
  const HistoryMove move = file.jump(step);
  std::printf("%zu steps back, %zu on\n", move.back.size(), move.on.size());
}

void add_jump_verb(CommandLine& program) {
  Verb verb = program.verb("jump", "Takes a document to any step of its history, on any branch");
  JumpFlags& flags = verb.runs(run_jump);
  verb.takes("document", flags.document, document_help).required();
  verb.takes("step", flags.step, "Its number, from the log; 0: the imported maps")
      .required()
      .between(0, 1000000000);
}

struct StepFlags {
  fs::path document;
  int steps = 1;
};

/// As many as there are; says how many that were.
template <class Step>
void run_steps(const StepFlags& flags, const char* done, const Step& step) {
  DocumentFile file(flags.document);
  print_notes(file.notes());
  int taken = 0;
  while (taken < flags.steps && step(file)) ++taken;
  std::printf("%s %d of %d\n", done, taken, flags.steps);
}

void run_undo(const StepFlags& flags) {
  run_steps(flags, "undone:", [](DocumentFile& file) { return file.undo().has_value(); });
}

void run_redo(const StepFlags& flags) {
  run_steps(flags, "redone:", [](DocumentFile& file) { return file.redo().has_value(); });
}

void add_step_verb(CommandLine& program, const char* name, const char* summary,
                   void (*run)(const StepFlags&)) {
  Verb verb = program.verb(name, summary);
  StepFlags& flags = verb.runs(run);
  verb.takes("document", flags.document, document_help).required();
  verb.takes("steps", flags.steps, "How many (1 unless given)").between(1, 1000000000);
}

struct VerifyFlags {
  fs::path document;
  bool json = false;
};

void run_verify(const VerifyFlags& flags) {
  const DocumentFile file(flags.document);
  print_notes(file.notes());
  const std::vector<std::string> faults = file.check();
  if (flags.json) {
    const Value::Array list(faults.begin(), faults.end());
    std::fputs(to_json(Value::Object{{"faults", list}}).c_str(), stdout);
  } else {
    for (const std::string& fault : faults) std::printf("%s\n", fault.c_str());
  }
  if (!faults.empty()) {
    throw DocumentError("'" + flags.document.string() + "' is damaged in " +
                        std::to_string(faults.size()) +
                        (faults.size() == 1 ? " place" : " places"));
  }
  if (!flags.json) std::printf("%s is whole\n", flags.document.string().c_str());
}

void add_verify_verb(CommandLine& program) {
  Verb verb = program.verb("verify", "Reads all of a document and names what is damaged");
  VerifyFlags& flags = verb.runs(run_verify);
  verb.takes("document", flags.document, document_help).required();
  verb.flag("--json", flags.json, "Print what is damaged as JSON");
}

struct ExportVerbFlags {
  fs::path document;
  fs::path output;
  ExportFlags target;
};

void run_export(const ExportVerbFlags& flags) {
  const OpenedDocument opened = open_stored_document(flags.document);
  std::vector<std::string> notes = opened.notes;
  const std::vector<fs::path> files =
      export_document(opened, flags.output, flags.target.options(), notes);
  print_notes(notes);
  print_files(files);
}

void add_export_verb(CommandLine& program) {
  Verb verb = program.verb("export", "Writes the maps of a document, and the model that uses them");
  ExportVerbFlags& flags = verb.runs(run_export);
  verb.takes("document", flags.document, document_help).required();
  verb.takes("-o,--output", flags.output, "Folder for maps and model").required();
  flags.target.add(verb);
}

}  // namespace

void add_document_verbs(CommandLine& program) {
  add_new_verb(program);
  add_apply_verb(program);
  add_log_verb(program);
  add_step_verb(program, "undo", "Takes the last steps of a document back", run_undo);
  add_step_verb(program, "redo", "Brings steps that were undone back", run_redo);
  add_jump_verb(program);
  add_verify_verb(program);
  add_export_verb(program);
}

}  // namespace normalshop::cli
