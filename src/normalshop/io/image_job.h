#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "normalshop/document/value.h"
#include "normalshop/io/open_image.h"

namespace normalshop {

/// How an edited picture is written. What is not given stays as it was imported.
struct ImageExport {
  std::filesystem::path normals;
  std::filesystem::path color = {};  ///< empty: colours are not written
  std::optional<CodeType> type = std::nullopt;
  std::optional<bool> green_down = std::nullopt;
};

/// Throws InvalidInput where `target` is one of the inputs: nothing of the user's is overwritten.
void check_not_input(const std::filesystem::path& target, const OpenImageOptions& inputs);
/// Writes target.normals. `half_float`: the codes came as 16-bit floats and go on as such, where
/// the format has them and no type is asked for. Throws IoError or InvalidInput.
void write_normals(const NormalMap& normals, bool half_float, const ImageExport& target);

/// Everything that one run on a picture did.
struct ImageJob {
  OpenedImage opened;
  std::vector<EditReport> edits;
  std::vector<std::filesystem::path> files;
};

/// Opens, applies the recipe and writes the files that `target` names, of which none may be an
/// input. Nothing is written unless every edit succeeds. Throws IoError or InvalidInput.
ImageJob run_image_job(const OpenImageOptions& open, const Recipe& recipe,
                       const ImageExport& target);
/// The same into a folder, created where it is missing: the normals and colours under their own
/// names (.png where the format can't hold the codes), and report.json.
ImageJob run_image_job(const OpenImageOptions& open, const Recipe& recipe,
                       const std::filesystem::path& folder, const ImageExport& target);

/// The content of report.json.
Value report_value(const ImageJob& job);

}  // namespace normalshop
