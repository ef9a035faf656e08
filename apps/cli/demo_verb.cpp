#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "demo_model.h"
#include "demo_recipe.h"
#include "verbs.h"

#include "normalshop/chart/render.h"
#include "normalshop/core/error.h"
#include "normalshop/core/stopwatch.h"
#include "normalshop/io/atomic_file.h"
#include "normalshop/io/edit_report.h"
#include "normalshop/io/file_assets.h"
#include "normalshop/io/image_file.h"

namespace normalshop::cli {

namespace {

namespace fs = std::filesystem;

constexpr int picture_side = 800;

struct DemoFlags {
  fs::path folder = "demo";
  int size = 2048;
  bool json = false;
};

void create_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw IoError("cannot make the folder '" + folder.string() + "': " + error.message());
}

OpenOptions opening(const fs::path& model) {
  OpenOptions options;
  options.model = model;
  return options;
}

ColorImage picture_of(const fs::path& model) {
  const OpenedDocument opened = open_document(opening(model));
  View view = framing_view(opened.document.mesh(), {0.16F, 0.10F, 1.0F});
  RenderOptions options;
  options.width = options.height = picture_side;
  options.light = {-0.62F, 0.58F, 0.65F};
  return render(opened.document.mesh(), opened.document.storage(), view, options);
}

ColorImage side_by_side(const ColorImage& left, const ColorImage& right) {
  ColorImage both(left.width() + right.width(), left.height());
  for (int y = 0; y < both.height(); ++y) {
    std::copy_n(left.row(y), left.width(), both.row(y));
    std::copy_n(right.row(y), right.width(), both.row(y) + left.width());
  }
  return both;
}

/// What is done, as it is done; nothing where JSON follows.
void tell(const DemoFlags& flags, const std::string& what, double seconds) {
  if (!flags.json) std::printf("%s in %.1f s\n", what.c_str(), seconds);
}

/// Draws the model before and after; returns the pictures.
std::vector<fs::path> draw(const fs::path& folder, const fs::path& model) {
  const ColorImage before = picture_of(model);
  const ColorImage after = picture_of(folder / "edited" / model.filename());
  std::vector<fs::path> pictures{folder / "before.png", folder / "after.png",
                                 folder / "before_after.png"};
  write_png_srgb(pictures[0], before);
  write_png_srgb(pictures[1], after);
  write_png_srgb(pictures[2], side_by_side(before, after));
  return pictures;
}

void print_json(const fs::path& model, const fs::path& recipe, const EditJob& job,
                const std::vector<fs::path>& pictures) {
  Value::Array names;
  for (const fs::path& picture : pictures) names.emplace_back(picture.string());
  const Value report = Value::Object{{"model", model.string()},
                                     {"recipe", recipe.string()},
                                     {"edited", report_value(job)},
                                     {"pictures", names}};
  std::fputs(to_json(report).c_str(), stdout);
}

/// The ordinary road from here on: what is opened and edited is a user's file like any other.
void run_demo(const DemoFlags& flags) {
  const fs::path& folder = flags.folder;
  Stopwatch watch;
  create_folder(folder);
  demo::DemoModelOptions options;
  options.map_size = flags.size;
  const fs::path model = demo::write_demo_model(demo::make_demo_model(options), folder);
  tell(flags, "made the model " + model.string(), watch.lap());

  const fs::path recipe_path = folder / "recipe.json";
  write_file(recipe_path, demo::recipe_text());
  FileAssets assets(folder);
  const Recipe recipe = parse_recipe(demo::recipe_text(), recipe_path.string(), assets);
  const EditJob job = run_edit_job(opening(model), recipe, folder / "edited", {});
  tell(flags,
       "applied the " + std::to_string(job.edits.size()) + " edits of " + recipe_path.string(),
       watch.lap());

  const std::vector<fs::path> pictures = draw(folder, model);
  tell(flags, "drew " + pictures.back().string(), watch.lap());
  if (flags.json) return print_json(model, recipe_path, job, pictures);
  std::printf("change the recipe and run: normalshop edit %s --recipe %s -o %s\n",
              model.string().c_str(), recipe_path.string().c_str(),
              (folder / "edited").string().c_str());
}

}  // namespace

void add_demo_verb(CommandLine& program) {
  Verb verb =
      program.verb("demo", "Makes a detailed model, edits it, and draws it before and after");
  DemoFlags& flags = verb.runs(run_demo);
  verb.takes("-o,--output", flags.folder, "Folder for everything").required();
  verb.takes("--size", flags.size, "Texels along a side of the model's maps")
      .between(256, 8192)
      .shows_default();
  verb.flag("--json", flags.json, "Print what was made as JSON");
}

}  // namespace normalshop::cli
