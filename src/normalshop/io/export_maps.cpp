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

const char* normal_extension(const OpenedSet& set, CodeType type,
                             const std::optional<ExportPreset>& preset) {
  const bool png = preset == ExportPreset::Gltf && type != CodeType::F32;
  return set.tiff && !png ? ".tif" : type == CodeType::F32 ? ".exr" : ".png";
}

/// "<set>_<kind>.png", of a tile "<tiled set>_<kind>.1001.png".
std::string map_name(const TextureSet& set, const std::string& kind, const char* extension) {
  if (set.tile == 0) return set.name + "_" + kind + extension;
  return set.tiled_name + "_" + kind + "." + std::to_string(set.tile) + extension;
}

/// How the model refers to it: for all tiles at once.
std::string map_reference(const TextureSet& set, const std::string& kind, const char* extension) {
  if (set.tile == 0) return map_name(set, kind, extension);
  return set.tiled_name + "_" + kind + ".<UDIM>" + extension;
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
    if (set.normal_map.empty() &&
        !any_tile(i, [](const StorageSet& s) { return s.normals.has_edits(); })) {
      return;
    }
    const TextureSet& textures = opened_.model.texture_sets[i];
    const CodeType type = options_.type.value_or(set.type);
    const char* extension = normal_extension(set, type, options_.preset);
    const std::string name = map_name(textures, "normal", extension);
    progress_.at(0.0, "encoding maps");
    const ImageWriteOptions how{.half_float =
                                    set.half_float && !options_.type && name.ends_with(".exr")};
    const NormalConvention convention = target_convention(map.convention(), options_.preset);
    const bool levels = options_.mip_levels || options_.roughness;
    if (map.convention().space == convention.space && !levels) {
      // Row by row: a large map is not in memory twice.
      progress_.at(0.5, "writing maps");
      check_not_input(opened_, staged_.folder() / name);
      write_image(
          staged_.path() / name, map.height(),
          [&](int y, int count) { return map.encode_rows(y, count, type, convention); }, how);
      files.push_back(staged_.path() / name);
    } else {
      const RawImage codes = export_map(opened_, i, options_);
      put(name, codes, how);
      if (levels) write_levels(i, NormalMap(codes, convention), how);
    }
    references[i].normal = map_reference(textures, "normal", extension);
    references[i].scale_applied = convention.scale != textures.normal_scale;
    if (for_viewers()) note_for_viewers(name, type, convention, notes_);
  }

  /// The set, or any tile of the same set: the model refers to all of its tiles at once.
  template <class Holds>
  bool any_tile(std::size_t i, const Holds& holds) const {
    const TextureSet& own = opened_.model.texture_sets[i];
    for (std::size_t k = 0; k < opened_.sets.size(); ++k) {
      const TextureSet& other = opened_.model.texture_sets[k];
      const bool tile_of_same = own.tile != 0 && other.tiled_name == own.tiled_name;
      if ((k == i || tile_of_same) && holds(opened_.document.storage().sets[k])) return true;
    }
    return false;
  }

  /// Of the map as it is written.
  void write_levels(std::size_t i, const NormalMap& map, const ImageWriteOptions& how) {
    const TextureSet& textures = opened_.model.texture_sets[i];
    const CodeType type = map.codes().type();
    const char* extension = normal_extension(opened_.sets[i], type, options_.preset);
    const NormalLevels levels(map, covered_texels(opened_.document.storage().sets[i].texels));
    for (int level = 1; options_.mip_levels && level <= levels.last(); ++level) {
      put(map_name(textures, "normal_mip" + std::to_string(level), extension),
          levels.encode(level, type, map.convention()), how);
    }
    if (!options_.roughness) return;
    put(map_name(textures, "roughness", ".png"),
        roughness_map(levels, options_.roughness_level, *options_.roughness, CodeType::U8), {});
  }

  /// Colours that no edit moved stay where they are.
  void write_colors(std::size_t i) {
    const ColorMap& map = opened_.document.storage().sets[i].albedo;
    if (map.empty() || !any_tile(i, [](const StorageSet& s) { return s.albedo.has_edits(); })) {
      return;
    }
    const TextureSet& textures = opened_.model.texture_sets[i];
    const RawImage codes = map.encode();
    const bool floats = codes.type() == CodeType::F32;
    const char* extension = floats ? ".exr" : ".png";
    const std::string name = map_name(textures, "color", extension);
    put(name, codes, {});
    references[i].color = map_reference(textures, "color", extension);
    if (floats && for_viewers()) notes_.push_back(name + ": glTF viewers read only PNG and JPEG");
  }

  void put(const std::string& name, const RawImage& codes, const ImageWriteOptions& how) {
    progress_.at(0.5, "writing maps");
    check_not_input(opened_, staged_.folder() / name);
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
