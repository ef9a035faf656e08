#include <cstdio>
#include <filesystem>
#include <string>

#include "model_flags.h"
#include "verbs.h"

#include "normalshop/io/atomic_file.h"
#include "normalshop/io/edit_report.h"
#include "normalshop/io/export_maps.h"
#include "normalshop/io/file_assets.h"

namespace normalshop::cli {

namespace {

struct EditFlags {
  ModelFlags model;
  std::filesystem::path recipe;
  std::filesystem::path output;
  std::string preset;
  std::string bits;
  bool json = false;

  ExportOptions export_options() const {
    ExportOptions out;
    ExportPreset chosen{};
    if (!preset.empty() && from_name(preset, chosen)) out.preset = chosen;
    CodeType type{};
    if (!bits.empty() && from_name(bits, type)) out.type = type;
    return out;
  }
};

void print_summary(const EditJob& job) {
  for (std::size_t i = 0; i < job.edits.size(); ++i) {
    const EditReport& e = job.edits[i];
    std::printf(
        "edit %zu (%s): %zu texels changed, largest change %.1f degrees, chart %d x %d, %.0f ms\n",
        i, std::string(job.operators[i]).c_str(), e.pushed.changed,
        static_cast<double>(e.pushed.largest_change), e.chart_width, e.chart_height,
        1e3 * (e.times.pull + e.times.operate + e.times.push));
  }
  for (const auto& file : job.files) std::printf("wrote %s\n", file.string().c_str());
}

void run_edit(const EditFlags& flags) {
  // The recipe first: a mistake in it should not cost the time of reading large maps.
  FileAssets assets(flags.recipe.parent_path());
  const Recipe recipe = parse_recipe(read_file(flags.recipe), flags.recipe.string(), assets);
  const EditJob job =
      run_edit_job(flags.model.options(), recipe, flags.output, flags.export_options());
  print_notes(job.notes);
  if (flags.json) {
    std::fputs(to_json(report_value(job)).c_str(), stdout);
  } else {
    print_summary(job);
  }
}

}  // namespace

void add_edit_verb(CommandLine& program) {
  Verb verb = program.verb("edit", "Applies a recipe of edits to a model's normal maps");
  EditFlags& flags = verb.runs(run_edit);
  flags.model.add(verb);
  verb.takes("--recipe", flags.recipe, "JSON file of edits (docs/recipes.md)").required();
  verb.takes("-o,--output", flags.output, "Folder for maps, model and report.json").required();
  verb.takes("--preset", flags.preset, "Conventions of the written maps (the input's unless given)")
      .one_of({"gltf", "opengl", "directx", "object"});
  verb.takes("--bits", flags.bits, "Bits a channel of the written maps (the input's unless given)")
      .one_of({"8", "16", "32"});
  verb.flag("--json", flags.json, "Print the report as JSON");
}

}  // namespace normalshop::cli
