#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

#include "normalshop/io/open_document.h"
#include "normalshop/io/staged_folder.h"

namespace normalshop {

/// Conventions of what reads the maps. Gltf and OpenGl: tangent space, green up. DirectX: tangent
/// space, green down. Object: object space.
enum class ExportPreset { Gltf, OpenGl, DirectX, Object };
constexpr auto names_of(ExportPreset) {
  return std::array<std::string_view, 4>{"gltf", "opengl", "directx", "object"};
}

struct ExportOptions {
  /// None: the conventions that the map came with.
  std::optional<ExportPreset> preset;
  std::optional<CodeType> type;  ///< none: that of the imported map
  /// Every mip level too, as `<texture set>_normal_mip<level>`, without what lies between charts.
  bool mip_levels = false;
  /// The roughness, 0 to 1, of the material: what the normals of a mip level lose is added to it
  /// (widened_roughness) and written as `<texture set>_roughness.png`.
  std::optional<float> roughness = {};
  int roughness_level = 1;  ///< from 1 on
};

/// The texture set's map as it would be written. With the imported conventions, type and size every
/// unedited texel keeps its imported code.
RawImage export_map(const OpenedDocument& opened, std::size_t set, const ExportOptions& options);

/// Throws InvalidInput when `folder` is the one that the model came from: nothing of the user's may
/// be overwritten.
void check_output_folder(const std::filesystem::path& model, const std::filesystem::path& folder);

/// Writes `<texture set>_normal.png` (.exr for 32 bits, .tif where the input was TIFF and the
/// preset is not glTF's) for every texture set that had a map or was edited,
/// `<texture set>_color.png` (.exr for 32 bits) where colours moved, and the model that uses them,
/// into `staged`, whose commit() is the caller's. Returns the files, maps first, then the model's.
/// Throws IoError or InvalidInput.
std::vector<std::filesystem::path> export_document(const OpenedDocument& opened,
                                                   const StagedFolder& staged,
                                                   const ExportOptions& options,
                                                   std::vector<std::string>& notes,
                                                   const Progress& progress = {});
/// The same into a folder, which is created: all files are complete before they take their names,
/// and when one cannot be written there is none.
std::vector<std::filesystem::path> export_document(const OpenedDocument& opened,
                                                   const std::filesystem::path& folder,
                                                   const ExportOptions& options,
                                                   std::vector<std::string>& notes,
                                                   const Progress& progress = {});

}  // namespace normalshop
