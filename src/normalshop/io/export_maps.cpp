#include "normalshop/io/export_maps.h"

#include "normalshop/core/error.h"
#include "normalshop/io/detail/extension.h"
#include "normalshop/io/image_file.h"
#include "normalshop/surface/convert_space.h"

namespace normalshop {

namespace {

NormalConvention target_convention(const NormalConvention& own,
                                   const std::optional<ExportPreset>& preset) {
  NormalConvention to = own;
  if (!preset) return to;
  to.space = *preset == ExportPreset::Object ? NormalSpace::Object : NormalSpace::Tangent;
  to.green_down = *preset == ExportPreset::DirectX;
  const bool renders_two = *preset != ExportPreset::Gltf && to.space == NormalSpace::Tangent;
  if (!renders_two) to.two_channel = false;  // glTF and object space need all three
  if (to.space != NormalSpace::Tangent) to.scale = 1.0F;
  return to;
}

std::string map_name(const OpenedDocument& opened, std::size_t set, CodeType type,
                     const std::optional<ExportPreset>& preset) {
  const bool png = preset == ExportPreset::Gltf && type != CodeType::F32;
  const char* extension = opened.sets[set].tiff && !png ? "_normal.tif"
                          : type == CodeType::F32       ? "_normal.exr"
                                                        : "_normal.png";
  return opened.model.texture_sets[set].name + extension;
}

/// What glTF viewers will make nothing, or something else, of.
void note_for_viewers(const std::string& name, CodeType type, const NormalConvention& convention,
                      std::vector<std::string>& notes) {
  if (!name.ends_with(".png")) {
    notes.push_back(name + ": glTF viewers read only PNG and JPEG; use " +
                    (type == CodeType::F32 ? "--bits 8 or 16" : "--preset gltf") + " for them");
  }
  if (convention.space == NormalSpace::Tangent && !convention.green_down &&
      !convention.two_channel) {
    return;
  }
  notes.push_back(name +
                  ": glTF viewers take maps as tangent space, green up, in three channels; " +
                  "use --preset gltf for them");
}

/// The map that an edit starts from stays as it is.
void check_not_input(const OpenedDocument& opened, const std::filesystem::path& target) {
  for (const OpenedSet& set : opened.sets) {
    std::error_code error;
    if (set.normal_map_path.empty()) continue;
    if (!std::filesystem::equivalent(set.normal_map_path, target, error)) continue;
    throw InvalidInput(target.string() +
                       ": this normal map is an input of the edit; choose another output folder");
  }
}

std::vector<std::filesystem::path> write_maps(const OpenedDocument& opened,
                                              const StagedFolder& staged,
                                              const ExportOptions& options,
                                              std::map<std::size_t, NormalMapReference>& references,
                                              std::vector<std::string>& notes,
                                              const Progress& progress) {
  std::vector<std::filesystem::path> files;
  for (std::size_t i = 0; i < opened.sets.size(); ++i) {
    const OpenedSet& set = opened.sets[i];
    const NormalMap& map = opened.document.storage().sets[i].normals;
    // A flat map that was only made to be edited adds nothing.
    if (set.normal_map.empty() && !map.has_edits()) continue;
    const CodeType type = options.type.value_or(set.type);
    const std::string name = map_name(opened, i, type, options.preset);
    check_not_input(opened, staged.folder() / name);
    progress.at(0.0, "encoding maps");
    const RawImage codes = export_map(opened, i, options);
    progress.at(0.5, "writing maps");
    write_image(staged.path() / name, codes,
                {.half_float = set.half_float && !options.type && name.ends_with(".exr")});
    files.push_back(staged.path() / name);
    const NormalConvention convention = target_convention(map.convention(), options.preset);
    references[i] = {name, convention.scale != opened.model.texture_sets[i].normal_scale};
    if (extension_of(opened.model.path) != ".obj") note_for_viewers(name, type, convention, notes);
  }
  return files;
}

}  // namespace

RawImage export_map(const OpenedDocument& opened, std::size_t set, const ExportOptions& options) {
  const StorageSet& stored = opened.document.storage().sets[set];
  const NormalConvention& own = stored.normals.convention();
  const NormalConvention to = target_convention(own, options.preset);
  const CodeType type = options.type.value_or(opened.sets[set].type);
  if (own.space == to.space) return stored.normals.encode(type, to);
  return convert_space(opened.document.mesh(), stored.texels, stored.normals, to, type);
}

void check_output_folder(const std::filesystem::path& model, const std::filesystem::path& folder) {
  std::error_code error;
  const std::filesystem::path own = model.parent_path();
  if (!std::filesystem::equivalent(folder, own.empty() ? "." : own, error)) return;
  throw InvalidInput(folder.string() +
                     ": this is the model's own folder; choose another one, so that nothing of "
                     "yours is overwritten");
}

std::vector<std::filesystem::path> export_document(const OpenedDocument& opened,
                                                   const StagedFolder& staged,
                                                   const ExportOptions& options,
                                                   std::vector<std::string>& notes,
                                                   const Progress& progress) {
  std::vector<std::filesystem::path> files;
  staged.write([&] {
    std::map<std::size_t, NormalMapReference> references;
    files = write_maps(opened, staged, options, references, notes, progress);
    progress.at(0.9, "writing the model");
    const WrittenModel written =
        write_model(opened.model, staged.path() / opened.model.path.filename(), references);
    files.insert(files.end(), written.files.begin(), written.files.end());
    notes.insert(notes.end(), written.notes.begin(), written.notes.end());
  });
  return files;
}

std::vector<std::filesystem::path> export_document(const OpenedDocument& opened,
                                                   const std::filesystem::path& folder,
                                                   const ExportOptions& options,
                                                   std::vector<std::string>& notes,
                                                   const Progress& progress) {
  check_output_folder(opened.model.path, folder);
  StagedFolder staged(folder);
  return staged.commit(export_document(opened, staged, options, notes, progress));
}

}  // namespace normalshop
