/// Opens a model, draws one pen stroke across its front, and writes maps and model.
///
///     example_edit_mesh MODEL.gltf FOLDER

#include <cstdio>
#include <string>
#include <vector>

#include "normalshop/io/export_maps.h"
#include "normalshop/io/file_assets.h"
#include "normalshop/io/open_document.h"

using namespace normalshop;

namespace {

/// Edits are small values; the easiest way to make one is the text that recipes hold. Lengths are
/// in the model's units, so they depend on its size.
std::string crease(float size) {
  const auto units = [size](double part) { return std::to_string(part * size); };
  return R"({ "version": 1, "edits": [ { "operator": "pen", "view": "front", "mode": "base",
      "options": { "profile": "crease", "width": )" +
         units(0.03) + R"(, "height": )" + units(0.01) + R"( },
      "strokes": [ [ [)" +
         units(-0.1) + "," + units(0.05) + "], [0, 0], [" + units(0.1) + "," + units(0.05) +
         "] ] ] } ] }";
}

void edit(const char* model, const char* folder) {
  OpenOptions options;
  options.model = model;
  OpenedDocument opened = open_document(options);
  FileAssets assets(".");
  const float size = bounds(opened.document.mesh()).diagonal();
  for (const Edit& stroke : parse_recipe(crease(size), "crease", assets).edits) {
    const EditReport report = opened.document.apply(stroke);
    std::printf("%zu texels changed\n", report.pushed.changed);
  }
  for (const auto& file : export_document(opened, folder, {}, opened.notes)) {
    std::printf("wrote %s\n", file.string().c_str());
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: example_edit_mesh MODEL FOLDER\n");
    return 2;
  }
  try {
    edit(argv[1], argv[2]);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
  return 0;
}
