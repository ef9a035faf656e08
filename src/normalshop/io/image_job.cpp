#include "normalshop/io/image_job.h"

#include <algorithm>

#include "normalshop/core/error.h"
#include "normalshop/io/atomic_file.h"
#include "normalshop/io/detail/extension.h"
#include "normalshop/io/edit_report.h"
#include "normalshop/io/image_file.h"
#include "normalshop/io/staged_folder.h"

namespace normalshop {

namespace {

ImageJob apply_all(const OpenImageOptions& open, const Recipe& recipe) {
  ImageJob job{open_image(open), {}, {}};
  for (const Edit& edit : recipe.edits) job.edits.push_back(job.opened.document.apply(edit));
  return job;
}

void write_all(ImageJob& job, const ImageExport& target) {
  write_normals(job.opened.document.normals(), job.opened.half_float, target);
  job.files.push_back(target.normals);
  if (target.color.empty()) return;
  write_image(target.color, encode_colors(job.opened));
  job.files.push_back(target.color);
}

/// The input's name, with an extension that can hold the codes without loss.
std::filesystem::path lossless_name(const std::filesystem::path& input, CodeType type) {
  const std::string extension = extension_of(input);
  const bool tiff = extension == ".tif" || extension == ".tiff";
  std::filesystem::path name = input.filename();
  if (tiff || (extension == ".tga" && type == CodeType::U8)) return name;
  return name.replace_extension(type == CodeType::F32 ? ".exr" : ".png");
}

}  // namespace

void check_not_input(const std::filesystem::path& target, const OpenImageOptions& inputs) {
  for (const auto* input : {&inputs.normals, &inputs.color, &inputs.mask}) {
    std::error_code error;
    if (input->empty() || !std::filesystem::equivalent(*input, target, error)) continue;
    throw InvalidInput(target.string() +
                       ": this picture is an input; choose another name for the output");
  }
}

void write_normals(const NormalMap& normals, bool half_float, const ImageExport& target) {
  NormalConvention convention = normals.convention();
  convention.green_down = target.green_down.value_or(convention.green_down);
  const bool half = half_float && !target.type && extension_of(target.normals) == ".exr";
  write_image(target.normals,
              normals.encode(target.type.value_or(normals.codes().type()), convention),
              {.half_float = half});
}

ImageJob run_image_job(const OpenImageOptions& open, const Recipe& recipe,
                       const ImageExport& target) {
  check_not_input(target.normals, open);
  if (!target.color.empty()) check_not_input(target.color, open);
  ImageJob job = apply_all(open, recipe);
  write_all(job, target);
  return job;
}

ImageJob run_image_job(const OpenImageOptions& open, const Recipe& recipe,
                       const std::filesystem::path& folder, const ImageExport& target) {
  StagedFolder staged(folder);
  ImageJob job = apply_all(open, recipe);
  const CodeType imported = job.opened.document.normals().codes().type();
  ImageExport files = target;
  files.normals = lossless_name(open.normals, target.type.value_or(imported));
  if (!open.color.empty()) {
    files.color = lossless_name(open.color, job.opened.color_codes.type());
    if (files.color == files.normals) files.color = "color_" + files.color.string();
  }
  for (auto* name : {&files.normals, &files.color}) {
    if (name->empty()) continue;
    check_not_input(folder / *name, open);
    *name = staged.path() / *name;
  }
  staged.write([&] { write_all(job, files); });
  job.files.push_back(staged.path() / "report.json");
  staged.write([&] { write_file(job.files.back(), to_json(report_value(job))); });
  job.files = staged.commit(job.files);
  return job;
}

Value report_value(const ImageJob& job) {
  const NormalMap& normals = job.opened.document.normals();
  Value::Array files;
  for (const auto& file : job.files) files.emplace_back(file.filename().string());
  Value::Array notes;
  for (const std::string& note : job.opened.notes) notes.emplace_back(note);
  float largest = 0.0F;
  for (const EditReport& e : job.edits) largest = std::max(largest, e.pushed.largest_change);
  return Value::Object{{"size", Value::Array{normals.width(), normals.height()}},
                       {"bits", name_of(normals.codes().type())},
                       {"green", normals.convention().green_down ? "down" : "up"},
                       {"green_confidence", job.opened.guess.green_confidence},
                       {"texels_changed", normals.edited_count()},
                       {"largest_change_degrees", largest},
                       {"edits", edits_value(job.opened.document.log(), job.edits)},
                       {"files", files},
                       {"notes", notes}};
}

}  // namespace normalshop
