#include <cstdio>
#include <filesystem>
#include <span>
#include <string>

#include "image_flags.h"
#include "model_flags.h"
#include "verbs.h"

#include "normalshop/core/options.h"
#include "normalshop/io/atomic_file.h"
#include "normalshop/io/edit_report.h"
#include "normalshop/io/export_maps.h"
#include "normalshop/io/file_assets.h"
#include "normalshop/io/model.h"

namespace normalshop::cli {

namespace {

struct EditFlags {
  ModelFlags model;
  ImageFlags image;
  std::filesystem::path recipe;
  std::filesystem::path output;
  std::string preset;
  std::string bits;
  std::string transfer;
  std::string update;
  bool mips = false;
  std::string roughness;
  int roughness_level = 1;
  bool json = false;

  ExportOptions export_options() const {
    ExportOptions out;
    ExportPreset chosen{};
    if (!preset.empty() && from_name(preset, chosen)) out.preset = chosen;
    out.type = code_type(bits);
    out.mip_levels = mips;
    out.roughness = read_roughness(roughness);
    out.roughness_level = roughness_level;
    return out;
  }
  TransferOptions transfer_options() const {
    TransferOptions out;
    if (!transfer.empty()) from_name(transfer, out.transfer);
    if (!update.empty()) from_name(update, out.update);
    return out;
  }
};

void print_summary(std::span<const Edit> log, std::span<const EditReport> reports,
                   std::span<const std::filesystem::path> files) {
  for (std::size_t i = 0; i < reports.size(); ++i) {
    const EditReport& e = reports[i];
    std::printf("edit %zu (%s): %zu texels changed, largest change %.1f degrees, ", i,
                std::string(log[i].operation->name()).c_str(), e.pushed.changed,
                static_cast<double>(e.pushed.largest_change));
    if (e.colors_changed > 0) std::printf("%zu colours, ", e.colors_changed);
    if (e.relief.largest >= 0.001F) {
      std::printf("height up to %.1f %% of the radius of curvature, ",
                  100.0 * static_cast<double>(e.relief.largest));
    }
    std::printf("chart %d x %d, %.0f ms\n", e.chart_width, e.chart_height,
                1e3 * (e.times.pull + e.times.operate + e.times.push));
  }
  for (const auto& file : files) std::printf("wrote %s\n", file.string().c_str());
}

template <class Job>
void print_job(const Job& job, const std::vector<std::string>& notes, bool json) {
  print_notes(notes);
  if (json) {
    std::fputs(to_json(report_value(job)).c_str(), stdout);
  } else {
    print_summary(job.opened.document.log(), job.edits, job.files);
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
  check_no_model_flags(options, flags.export_options());
  OpenImageOptions open = flags.image.open();
  open.color = options.model;
  open.green_down = options.green_down;
  ImageExport target;
  const ExportOptions chosen = flags.export_options();
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
                                     flags.export_options(), flags.transfer_options());
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
  verb.takes("--preset", flags.preset, "Conventions of the written maps (the input's unless given)")
      .one_of({"gltf", "opengl", "directx", "object"});
  verb.takes("--bits", flags.bits, "Bits a channel of the written maps (the input's unless given)")
      .one_of({"8", "16", "32"});
  verb.flag("--mips", flags.mips,
            "Writes the mip levels of the maps too, free of what lies between charts");
  verb.takes("--roughness", flags.roughness,
             "The material's roughness, 0 to 1: writes it as a map too, with what the normals of "
             "a mip level lose added");
  verb.takes("--roughness-level", flags.roughness_level, "That mip level (1 unless given)")
      .between(1, 16);
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
