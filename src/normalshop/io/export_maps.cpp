#include "normalshop/io/export_maps.h"

#include "normalshop/core/error.h"
#include "normalshop/core/normal_levels.h"
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
    for (const auto& input : {set.normal_map_path, set.albedo_path}) {
      std::error_code error;
      if (input.empty() || !std::filesystem::equivalent(input, target, error)) continue;
      throw InvalidInput(target.string() +
                         ": this map is an input of the edit; choose another output folder");
    }
  }
}

/// Writes what an export needs, map by map.
class MapWriter {
 public:
  MapWriter(const OpenedDocument& opened, const StagedFolder& staged, const ExportOptions& options,
            std::vector<std::string>& notes, const Progress& progress)
      : opened_(opened), staged_(staged), options_(options), notes_(notes), progress_(progress) {}

  void write() {
    for (std::size_t i = 0; i < opened_.sets.size(); ++i) {
      write_normals(i);
      write_colors(i);
    }
  }

  std::vector<std::filesystem::path> files;
  std::map<std::size_t, MapReferences> references;

 private:
  void write_normals(std::size_t i) {
    const OpenedSet& set = opened_.sets[i];
    const NormalMap& map = opened_.document.storage().sets[i].normals;
    // A flat map that was only made to be edited adds nothing.
    if (set.normal_map.empty() && !map.has_edits()) return;
    const CodeType type = options_.type.value_or(set.type);
    const std::string name = map_name(opened_, i, type, options_.preset);
    progress_.at(0.0, "encoding maps");
    check_not_input(opened_, staged_.folder() / name);
    const RawImage codes = export_map(opened_, i, options_);
    const ImageWriteOptions how{.half_float =
                                    set.half_float && !options_.type && name.ends_with(".exr")};
    put(name, codes, how);
    const NormalConvention convention = target_convention(map.convention(), options_.preset);
    if (options_.mip_levels || options_.roughness)
      write_levels(i, NormalMap(codes, convention), how);
    references[i].normal = name;
    references[i].scale_applied = convention.scale != opened_.model.texture_sets[i].normal_scale;
    if (for_viewers()) note_for_viewers(name, type, convention, notes_);
  }

  /// Of the map as it is written.
  void write_levels(std::size_t i, const NormalMap& map, const ImageWriteOptions& how) {
    const CodeType type = map.codes().type();
    const std::filesystem::path name = map_name(opened_, i, type, options_.preset);
    const NormalLevels levels(map, covered_texels(opened_.document.storage().sets[i].texels));
    for (int level = 1; options_.mip_levels && level <= levels.last(); ++level) {
      put(name.stem().string() + "_mip" + std::to_string(level) + name.extension().string(),
          levels.encode(level, type, map.convention()), how);
    }
    if (!options_.roughness) return;
    put(opened_.model.texture_sets[i].name + "_roughness.png",
        roughness_map(levels, options_.roughness_level, *options_.roughness, CodeType::U8), {});
  }

  /// Colours that no edit moved stay where they are.
  void write_colors(std::size_t i) {
    const ColorMap& map = opened_.document.storage().sets[i].albedo;
    if (!map.has_edits()) return;
    const RawImage codes = map.encode();
    const bool floats = codes.type() == CodeType::F32;
    const std::string name =
        opened_.model.texture_sets[i].name + (floats ? "_color.exr" : "_color.png");
    check_not_input(opened_, staged_.folder() / name);
    put(name, codes, {});
    references[i].color = name;
    if (floats && for_viewers()) notes_.push_back(name + ": glTF viewers read only PNG and JPEG");
  }

  void put(const std::string& name, const RawImage& codes, const ImageWriteOptions& how) {
    progress_.at(0.5, "writing maps");
    write_image(staged_.path() / name, codes, how);
    files.push_back(staged_.path() / name);
  }

  bool for_viewers() const { return extension_of(opened_.model.path) != ".obj"; }

  const OpenedDocument& opened_;
  const StagedFolder& staged_;
  const ExportOptions& options_;
  std::vector<std::string>& notes_;
  const Progress& progress_;
};

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
    MapWriter maps(opened, staged, options, notes, progress);
    maps.write();
    files = std::move(maps.files);
    progress.at(0.9, "writing the model");
    const WrittenModel written =
        write_model(opened.model, staged.path() / opened.model.path.filename(), maps.references);
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
