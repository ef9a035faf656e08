#include "normalshop/io/open_document.h"

#include <algorithm>
#include <cmath>

#include "normalshop/core/error.h"
#include "normalshop/core/options.h"
#include "normalshop/core/slope.h"
#include "normalshop/io/detail/naming.h"
#include "normalshop/io/image_file.h"
#include "normalshop/io/udim.h"
#include "normalshop/surface/texel_density.h"

namespace normalshop {

namespace {

constexpr int default_size = 2048;
constexpr int largest_size = 16384;

[[noreturn]] void fail_without_set(const std::string& flag, const std::string& argument,
                                   const std::vector<TextureSet>& sets) {
  std::string names;
  for (const TextureSet& set : sets) {
    if (!names.empty()) names += ", ";
    names += set.name;
  }
  throw InvalidInput(flag + " " + argument + ": the model has " + std::to_string(sets.size()) +
                     " texture sets; write SET=FILE with one of: " + names);
}

/// Splits "SET=FILE" and finds the set; a plain FILE needs a model with one set.
std::vector<std::optional<MapSource>> given_maps(const std::vector<std::string>& arguments,
                                                 const Model& model, const char* flag) {
  std::vector<std::optional<MapSource>> out(model.texture_sets.size());
  for (const std::string& argument : arguments) {
    std::size_t index = 0;
    std::string file = argument;
    const std::size_t equals = argument.find('=');
    const auto named = [&](const TextureSet& s) { return s.name == argument.substr(0, equals); };
    const auto found = equals == std::string::npos ? model.texture_sets.end()
                                                   : std::find_if(model.texture_sets.begin(),
                                                                  model.texture_sets.end(), named);
    if (found != model.texture_sets.end()) {
      index = static_cast<std::size_t>(found - model.texture_sets.begin());
      file = argument.substr(equals + 1);
    } else if (model.texture_sets.size() != 1) {
      fail_without_set(flag, argument, model.texture_sets);
    }
    if (out[index]) {
      throw InvalidInput(std::string(flag) + ": given twice for the texture set " +
                         model.texture_sets[index].name);
    }
    out[index] = MapSource{};
    out[index]->name = file;
    out[index]->path = file;
  }
  return out;
}

RawImage read_source(const MapSource& source, const FileSource& files,
                     ImageTraits* traits = nullptr) {
  if (!source.bytes.empty()) return read_image(source.bytes, source.name, traits);
  const std::string bytes = files.read(source.path);
  return read_image(std::as_bytes(std::span(bytes)), source.path.string(), traits);
}

/// A scale that codes can be read with; maps of others are multiplied by it.
bool codes_bear(float scale) { return std::abs(scale) >= 0.25F && std::abs(scale) <= 4.0F; }

/// x and y of every normal times the model's scale (glTF normalTexture.scale).
NormalMap apply_scale(const NormalMap& map, float scale) {
  NormalMap scaled = map;
  for (int y = 0; y < map.height(); ++y) {
    for (int x = 0; x < map.width(); ++x) {
      Vec3f n = map.normal(x, y);
      n.head<2>() *= scale;
      if (!n.isZero()) scaled.set_normal(x, y, n.normalized());
    }
  }
  return {scaled.encode(), map.convention()};
}

NormalConvention choose_convention(const ConventionGuess& guess, const OpenOptions& options,
                                   float scale) {
  NormalConvention convention = guess.convention;
  if (options.green_down) convention.green_down = *options.green_down;
  if (convention.space != NormalSpace::Tangent) convention.two_channel = false;
  if (convention.space == NormalSpace::Tangent && codes_bear(scale)) convention.scale = scale;
  return convention;
}

/// What the guess says, and what the user's flags make of it.
std::string said(const ConventionGuess& guess, const NormalConvention& convention) {
  if (convention.space == guess.convention.space &&
      convention.green_down == guess.convention.green_down) {
    return guess.sentence;
  }
  return "read as " + std::string(name_of(convention.space)) + " space, green " +
         (convention.green_down ? "down" : "up") + ", as the flags say; it looks like " +
         guess.sentence;
}

/// Known, or guessed.
NormalConvention find_convention(const RawImage& codes, const TextureSet& set,
                                 const OpenOptions& options, OpenedDocument& opened,
                                 OpenedSet& info) {
  const auto known = options.conventions.find(set.name);
  if (known != options.conventions.end()) return known->second;
  info.guess = naming(info.normal_map, [&] { return guess_convention(codes, options.space); });
  const NormalConvention convention = choose_convention(*info.guess, options, set.normal_scale);
  opened.notes.push_back(set.name + ": " + said(*info.guess, convention));
  return convention;
}

NormalMap fit_size(NormalMap map, int size) {
  const int largest = std::max(map.width(), map.height());
  if (size == 0 || size == largest) return map;
  const auto scaled = [&](int side) {
    return std::max(1, static_cast<int>(std::lround(double(side) * size / largest)));
  };
  // Resampled slopes need more steps than 8 bits have.
  const CodeType type = map.codes().type() == CodeType::F32 ? CodeType::F32 : CodeType::U16;
  return resize(map, scaled(map.width()), scaled(map.height()), type);
}

/// The map as it shows with the model's scale.
NormalMap scaled_normals(NormalMap map, const TextureSet& set, OpenedDocument& opened) {
  const float scale = set.normal_scale;
  if (scale == 1.0F || map.convention().space != NormalSpace::Tangent) return map;
  const std::string sentence =
      set.name + ": the model scales its normals by " + std::to_string(scale);
  if (map.convention().scale == scale) {
    opened.notes.push_back(sentence + "; the map is edited as it then shows");
    return map;
  }
  opened.notes.push_back(sentence + "; this was multiplied into the map");
  return apply_scale(map, scale);
}

NormalMap open_normals(const MapSource& source, const TextureSet& set, const OpenOptions& options,
                       OpenedDocument& opened, OpenedSet& info, const Progress& progress) {
  ImageTraits traits;
  RawImage codes = read_source(source, *options.files, &traits);
  progress.at(0.3, "guessing conventions");
  info.normal_map = source.name.empty() ? source.path.string() : source.name;
  info.normal_map_path = source.path;
  info.type = codes.type();
  info.tiff = traits.tiff;
  info.half_float = traits.half_float;
  info.imported_width = codes.width();
  info.imported_height = codes.height();
  const NormalConvention convention = find_convention(codes, set, options, opened, info);
  NormalMap map = naming(info.normal_map, [&] { return NormalMap(std::move(codes), convention); });
  map = scaled_normals(std::move(map), set, opened);
  progress.at(0.4, "resizing maps");
  return fit_size(std::move(map), options.size);
}

Document::Maps open_maps(const TextureSet& set, const std::optional<MapSource>& normals,
                         const std::optional<MapSource>& albedo, const OpenOptions& options,
                         OpenedDocument& opened, OpenedSet& info, const Progress& progress) {
  Document::Maps maps;
  if (albedo) {
    RawImage codes = read_source(*albedo, *options.files);
    maps.albedo = ColorMap(std::move(codes), set.albedo_factor);
  } else {
    maps.albedo = ColorMap(set.albedo_factor);
  }
  if (normals) {
    maps.normals = open_normals(*normals, set, options, opened, info, progress);
    return maps;
  }
  const RawImage& color = maps.albedo.codes();
  int width = color.empty() ? default_size : color.width();
  int height = color.empty() ? default_size : color.height();
  if (options.size > 0) {
    const double factor = double(options.size) / std::max(width, height);
    width = std::max(1, static_cast<int>(std::lround(width * factor)));
    height = std::max(1, static_cast<int>(std::lround(height * factor)));
  }
  info.type = CodeType::U16;
  info.imported_width = width;
  info.imported_height = height;
  NormalMap flat = flat_normal_map(width, height, CodeType::U16);
  NormalConvention convention = flat.convention();
  if (codes_bear(set.normal_scale)) convention.scale = set.normal_scale;
  maps.normals = NormalMap(flat.codes(), convention);
  opened.notes.push_back(set.name + ": no normal map; starting from a flat one of " +
                         std::to_string(width) + " x " + std::to_string(height) + ", 16 bit");
  return maps;
}

/// The user's choice, else the model's.
std::optional<MapSource> choose(const std::optional<MapSource>& given,
                                const std::optional<MapSource>& own) {
  return given ? given : own;
}

bool is_missing(const MapSource& source, const FileSource& files) {
  return source.bytes.empty() && !files.has(source.path);
}

/// One edit there shows in several places of the model.
void note_shared_texels(OpenedDocument& opened) {
  for (std::size_t i = 0; i < opened.sets.size(); ++i) {
    const TexelUse use = texel_use(opened.document.storage().sets[i].texels);
    if (use.shared == 0) continue;
    opened.notes.push_back(opened.model.texture_sets[i].name + ": " + std::to_string(use.shared) +
                           " texels are used by several triangles (overlapping or mirrored "
                           "charts); editing one of these places edits them all");
  }
}

/// The maps that a model is opened with, one of each kind a texture set.
struct ChosenMaps {
  std::vector<std::optional<MapSource>> normals;
  std::vector<std::optional<MapSource>> albedos;
};

/// Texture sets whose maps name UDIM tiles become one a tile.
void split_into_tiles(Model& model, ChosenMaps& given) {
  std::vector<bool> tiled;
  const auto in_tiles = [](const std::optional<MapSource>& source) {
    return source && names_tiles(source->path);
  };
  for (std::size_t i = 0; i < model.texture_sets.size(); ++i) {
    const TextureSet& set = model.texture_sets[i];
    tiled.push_back(in_tiles(choose(given.normals[i], set.normal_map)) ||
                    in_tiles(choose(given.albedos[i], set.albedo)));
  }
  if (std::find(tiled.begin(), tiled.end(), true) == tiled.end()) return;
  const std::vector<std::size_t> old = split_tiles(model, tiled);
  for (auto* maps : {&given.normals, &given.albedos}) {
    std::vector<std::optional<MapSource>> all;
    for (std::size_t i = 0; i < old.size(); ++i) {
      std::optional<MapSource> source = (*maps)[old[i]];
      if (in_tiles(source)) {
        source->path = tile_path(source->path, model.texture_sets[i].tile);
        source->name = source->path.string();
      }
      all.push_back(std::move(source));
    }
    *maps = std::move(all);
  }
}

}  // namespace

OpenedDocument open_document(const OpenOptions& options, const Progress& progress) {
  if (options.size < 0 || options.size > largest_size) {
    throw InvalidInput("--size must be from 1 to 16384 texels");
  }
  progress.at(0.0, "reading the model");
  ModelReadOptions reading;
  reading.flip_v = options.flip_v;
  reading.files = options.files;
  Model model = read_model(options.model, reading);
  ChosenMaps given{given_maps(options.normal_maps, model, "--normal-map"),
                   given_maps(options.albedos, model, "--albedo")};
  split_into_tiles(model, given);
  const auto& [normals, albedos] = given;
  Mesh mesh = std::move(model.mesh);
  model.mesh = {};

  OpenedDocument opened{std::move(model), Document({}, {}), {}, {}};
  opened.notes = opened.model.notes;
  std::vector<Document::Maps> maps;
  for (std::size_t i = 0; i < opened.model.texture_sets.size(); ++i) {
    const TextureSet& set = opened.model.texture_sets[i];
    progress.at(0.1, "reading maps");
    std::optional<MapSource> albedo = choose(albedos[i], set.albedo);
    if (albedo && !albedos[i] && is_missing(*albedo, *options.files)) {
      opened.notes.push_back(set.name + ": the colour map " + albedo->path.string() +
                             " is missing; shown without colour");
      albedo.reset();
    }
    // What the user gives is for all.
    if (albedos[i]) opened.model.texture_sets[i].albedo_materials = set.materials;
    OpenedSet info;
    if (albedo) info.albedo_path = albedo->path;
    maps.push_back(open_maps(set, choose(normals[i], set.normal_map), albedo, options, opened, info,
                             progress));
    opened.sets.push_back(std::move(info));
  }
  opened.document = Document(std::move(mesh), std::move(maps), progress);
  note_shared_texels(opened);
  return opened;
}

}  // namespace normalshop
