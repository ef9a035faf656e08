#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <string>
#include <type_traits>

#include "model_flags.h"
#include "verbs.h"

#include "normalshop/core/error.h"
#include "normalshop/core/stopwatch.h"
#include "normalshop/document/value.h"
#include "normalshop/io/atomic_file.h"
#include "normalshop/io/gltf_export.h"
#include "normalshop/io/model.h"
#include "normalshop/surface/unwrap.h"

namespace normalshop::cli {

namespace {

namespace fs = std::filesystem;

struct UnwrapFlags {
  fs::path model;
  fs::path output;
  UnwrapOptions options;
  bool json = false;
};

std::string flag_name(std::string_view field) {
  std::string name = "--" + std::string(field);
  std::replace(name.begin(), name.end(), '_', '-');
  return name;
}

std::string range_text(double low, double high) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%g to %g", low, high);
  return text.data();
}

/// The .bin beside the output must not be one that the model reads.
void check_buffer(const UnwrapFlags& flags) {
  fs::path binary = flags.output;
  binary.replace_extension(".bin");
  std::error_code ignored;
  const fs::path own = flags.model.parent_path() / binary.filename();
  if (flags.model.extension() != ".gltf" || !fs::equivalent(own, binary, ignored)) return;
  if (read_file(flags.model).find(binary.filename().string()) == std::string::npos) return;
  throw WrongUse("--output", "would write over '" + binary.string() + "', which the model reads");
}

void check_flags(const UnwrapFlags& flags) {
  for_each_field<UnwrapOptions>([&](const auto& f) {
    const auto value = static_cast<double>(flags.options.*f.member);
    if (f.min == f.max || (value >= f.min && value <= f.max)) return;
    throw WrongUse(flag_name(f.name), "must be from " + range_text(f.min, f.max));
  });
  if (flags.output.extension() != ".gltf") {
    throw WrongUse("--output", "must end in .gltf, not \"" + flags.output.string() + "\"");
  }
  std::error_code ignored;
  if (fs::equivalent(flags.model, flags.output, ignored)) {
    throw WrongUse("--output", "must not be the model itself");
  }
  check_buffer(flags);
}

/// One texture set, called like the file.
void name_atlas(Mesh& mesh, const fs::path& output) {
  const std::string stem = output.stem().string();
  mesh.texture_set_names = {stem.empty() ? std::string("surface") : stem};
}

Value report_value(const UnwrapFlags& flags, const UnwrapReport& report, double seconds) {
  fs::path binary = flags.output;
  binary.replace_extension(".bin");
  return Value::Object{{"triangles", report.triangles},
                       {"degenerate", report.degenerate},
                       {"charts", report.charts},
                       {"coverage", report.coverage},
                       {"mean_stretch", report.mean_stretch},
                       {"largest_stretch", report.largest_stretch},
                       {"overlaps", report.overlaps},
                       {"turned_over", report.turned_over},
                       {"seconds", seconds},
                       {"files", Value::Array{flags.output.string(), binary.string()}}};
}

void print_report(const UnwrapFlags& flags, const UnwrapReport& report, double seconds) {
  std::printf("%zu triangles in %zu charts, which cover %.1f %% of the map, in %.1f s\n",
              report.triangles, report.charts, 100.0 * report.coverage, seconds);
  std::printf("area stretch %.2f in the mean, %.2f at most; %zu overlaps, %zu turned over\n",
              report.mean_stretch, report.largest_stretch, report.overlaps, report.turned_over);
  if (report.degenerate > 0) std::printf("%zu triangles have no area\n", report.degenerate);
  std::printf("wrote %s\n", flags.output.string().c_str());
}

void run_unwrap(const UnwrapFlags& flags) {
  check_flags(flags);
  ModelReadOptions reading;
  reading.keep_without_uvs = true;
  Model model = read_model(flags.model, reading);
  Stopwatch watch;
  const UnwrapReport report = unwrap(model.mesh, flags.options);
  const double seconds = watch.lap();
  name_atlas(model.mesh, flags.output);
  GltfMaterial material;
  material.name = model.mesh.texture_set_names[0];
  export_gltf(flags.output, model.mesh, {material});
  const bool had_maps =
      std::any_of(model.texture_sets.begin(), model.texture_sets.end(),
                  [](const TextureSet& set) { return set.albedo || set.normal_map; });
  if (had_maps) model.notes.emplace_back("the model's maps do not fit the new atlas; left out");
  print_notes(model.notes);
  if (flags.json) {
    std::fputs(to_json(report_value(flags, report, seconds)).c_str(), stdout);
  } else {
    print_report(flags, report, seconds);
  }
}

template <class Value>
void add_option(Verb& verb, const std::string& name, Value& value, const std::string& help) {
  if constexpr (std::is_same_v<Value, bool>) {
    verb.flag(name, value, help);
  } else {
    verb.takes(name, value, help).shows_default();
  }
}

}  // namespace

void add_unwrap_verb(CommandLine& program) {
  Verb verb = program.verb("unwrap", "Gives a model a new texture atlas, with or without one");
  UnwrapFlags& flags = verb.runs(run_unwrap);
  verb.takes("model", flags.model, "glTF, GLB or OBJ file").required();
  verb.takes("-o,--output", flags.output,
             "The model with its atlas: a .gltf, with a .bin beside it")
      .required();
  for_each_field<UnwrapOptions>([&](const auto& f) {
    std::string help(f.help);
    if (f.min != f.max) help += " [" + range_text(f.min, f.max) + "]";
    add_option(verb, flag_name(f.name), flags.options.*f.member, help);
  });
  verb.flag("--json", flags.json, "Print a report as JSON");
}

}  // namespace normalshop::cli
