#include <algorithm>
#include <cstdio>
#include <filesystem>

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

/// The ordinary road from here on: what is opened and edited is a user's file like any other.
void run_demo(const DemoFlags& flags) {
  const fs::path& folder = flags.folder;
  Stopwatch watch;
  create_folder(folder);
  demo::DemoModelOptions options;
  options.map_size = flags.size;
  const fs::path model = demo::write_demo_model(demo::make_demo_model(options), folder);
  std::printf("made the model %s in %.1f s\n", model.string().c_str(), watch.lap());

  const fs::path recipe_path = folder / "recipe.json";
  write_file(recipe_path, demo::recipe_text());
  FileAssets assets(folder);
  const Recipe recipe = parse_recipe(demo::recipe_text(), recipe_path.string(), assets);
  const EditJob job = run_edit_job(opening(model), recipe, folder / "edited", {});
  std::printf("applied the %zu edits of %s in %.1f s\n", job.edits.size(),
              recipe_path.string().c_str(), watch.lap());

  const ColorImage before = picture_of(model);
  const ColorImage after = picture_of(folder / "edited" / model.filename());
  write_png_srgb(folder / "before.png", before);
  write_png_srgb(folder / "after.png", after);
  write_png_srgb(folder / "before_after.png", side_by_side(before, after));
  std::printf("drew %s in %.1f s\n", (folder / "before_after.png").string().c_str(), watch.lap());
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
}

}  // namespace normalshop::cli
