#include <cstdio>
#include <filesystem>
#include <string>

#include "export_flags.h"
#include "image_flags.h"
#include "model_flags.h"
#include "verbs.h"

#include "normalshop/core/options.h"
#include "normalshop/io/atomic_file.h"
#include "normalshop/io/edit_report.h"
#include "normalshop/io/file_assets.h"
#include "normalshop/io/model.h"

namespace normalshop::cli {

namespace {

struct EditFlags {
  ModelFlags model;
  ImageFlags image;
  std::filesystem::path recipe;
  std::filesystem::path output;
  ExportFlags target;
  std::string transfer;
  std::string update;
  bool json = false;

  TransferOptions transfer_options() const {
    TransferOptions out;
    if (!transfer.empty()) from_name(transfer, out.transfer);
    if (!update.empty()) from_name(update, out.update);
    return out;
  }
};

template <class Job>
void print_job(const Job& job, const std::vector<std::string>& notes, bool json) {
  print_notes(notes);
  if (json) {
    std::fputs(to_json(report_value(job)).c_str(), stdout);
  } else {
    print_edits(job.opened.document.log(), job.edits);
    print_files(job.files);
  }
}

void check_no_model_flags(const OpenOptions& options, const ExportOptions& levels) {
  const auto refuse = [](bool given, const char* flag) {
    if (given) throw WrongUse(flag, "is for models; --normals edits a picture");
  };
  refuse(!options.normal_maps.empty(), "--normal-map");
  refuse(!options.albedos.empty(), "--albedo");
  refuse(options.space.has_value(), "--space");
  refuse(options.flip_v, "--flip-v");
  refuse(options.size != 0, "--size");
  refuse(levels.mip_levels, "--mips");
  refuse(levels.roughness.has_value(), "--roughness");
}

ImageJob edit_image(const EditFlags& flags, const Recipe& recipe) {
  if (!flags.transfer.empty() || !flags.update.empty()) {
    throw WrongUse(flags.transfer.empty() ? "--update" : "--transfer",
                   "is for models; a picture is its own chart");
  }
  const OpenOptions options = flags.model.options();
  check_no_model_flags(options, flags.target.options());
  OpenImageOptions open = flags.image.open();
  open.color = options.model;
  open.green_down = options.green_down;
  ImageExport target;
  const ExportOptions chosen = flags.target.options();
  if (chosen.preset == ExportPreset::Object) {
    throw WrongUse("--preset", "a picture's normals are in tangent space: gltf, opengl or directx");
  }
  if (chosen.preset) target.green_down = chosen.preset == ExportPreset::DirectX;
  target.type = chosen.type;
  return run_image_job(open, recipe, flags.output, target);
}

void run_edit(const EditFlags& flags) {
  const bool picture = !flags.image.files.normals.empty();
  const std::filesystem::path model = flags.model.options().model;
  if (!picture && model.empty()) {
    throw WrongUse("a model is missing, or --normals for a picture");
  }
  if (!picture && !is_model_file(model)) {
    throw InvalidInput("'" + model.string() +
                       "' is no model (.gltf, .glb or .obj), and a picture needs its --normals");
  }
  // The recipe first: a mistake in it should not cost the time of reading large maps.
  FileAssets assets(flags.recipe.parent_path());
  const Recipe recipe = parse_recipe(read_file(flags.recipe), flags.recipe.string(), assets);
  if (picture) {
    const ImageJob job = edit_image(flags, recipe);
    print_job(job, job.opened.notes, flags.json);
  } else {
    const EditJob job = run_edit_job(flags.model.options(), recipe, flags.output,
                                     flags.target.options(), flags.transfer_options());
    print_job(job, job.notes, flags.json);
  }
}

}  // namespace

void add_edit_verb(CommandLine& program) {
  Verb verb =
      program.verb("edit", "Applies a recipe of edits to the normals of a model or a picture");
  EditFlags& flags = verb.runs(run_edit);
  flags.model.add(verb, "glTF, GLB or OBJ file; with --normals, the colours of a picture");
  verb.takes("--normals", flags.image.files.normals,
             "Edits a picture: the normal map that belongs to the colours");
  flags.image.add(verb);
  verb.takes("--recipe", flags.recipe, "JSON file of edits (docs/recipes.md)").required();
  verb.takes("-o,--output", flags.output, "Folder for maps, model and report.json").required();
  flags.target.add(verb);
  verb.takes(
          "--transfer", flags.transfer,
          "How charts are made of a model's map: triangle (the default) or point, for comparison "
          "(docs/transfers.md)")
      .one_of({"triangle", "point"});
  verb.takes("--update", flags.update,
             "How edited charts get back: gather (the default), or for comparison point or area")
      .one_of({"gather", "point", "area"});
  verb.flag("--json", flags.json, "Print the report as JSON");
}

}  // namespace normalshop::cli
