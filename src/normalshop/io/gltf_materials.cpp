#include "normalshop/io/detail/gltf_materials.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "normalshop/io/detail/extension.h"
#include "normalshop/io/detail/model_source.h"
#include "normalshop/io/detail/uri.h"

namespace normalshop::gltf {

namespace {

std::string indexed(const char* list, std::size_t index) {
  return std::string(list) + "[" + std::to_string(index) + "]";
}

std::string name_of_material(int material) {
  return material < 0 ? "no material" : indexed("materials", static_cast<std::size_t>(material));
}

/// Name of a format that glTF extensions bring and that is not read here, or nullptr.
const char* unread_format(const Json& image) {
  struct Format {
    const char* name;
    const char* mime;
    const char* extension;
  };
  static constexpr std::array<Format, 3> formats{{{"KTX2", "image/ktx2", ".ktx2"},
                                                  {"WebP", "image/webp", ".webp"},
                                                  {"DDS", "image/vnd-ms.dds", ".dds"}}};
  const std::string uri = string_at(image, "uri");
  for (const Format& format : formats) {
    const bool embedded = uri.starts_with(std::string("data:") + format.mime);
    const bool named = !is_data_uri(uri) && extension_of(percent_decoded(uri)) == format.extension;
    if (embedded || named || string_at(image, "mimeType") == format.mime) return format.name;
  }
  return nullptr;
}

UvTransform transform_at(const File& file, const Json& json, const std::string& where) {
  UvTransform t;
  const auto offset = numbers_at(file, json, "offset", where, {0.0, 0.0});
  const auto scale = numbers_at(file, json, "scale", where, {1.0, 1.0});
  t.offset = {offset[0], offset[1]};
  t.scale = {scale[0], scale[1]};
  t.rotation = static_cast<double>(number_at(file, json, "rotation", where, 0.0F));
  return t;
}

std::string key_of(const UvChoice& uv) {
  const UvTransform& t = uv.transform;
  std::string key = "|" + std::to_string(uv.set);
  for (const double value : {t.offset[0], t.offset[1], t.rotation, t.scale[0], t.scale[1]}) {
    key += "|" + std::to_string(value);
  }
  return key;
}

}  // namespace

Vec2f UvTransform::apply(const Vec2f& uv) const {
  const double c = std::cos(rotation);
  const double s = std::sin(rotation);
  const double u = scale[0] * static_cast<double>(uv.x());
  const double v = scale[1] * static_cast<double>(uv.y());
  // V runs down: counter-clockwise on the screen is clockwise in (u, v).
  return {static_cast<float>(offset[0] + c * u + s * v),
          static_cast<float>(offset[1] - s * u + c * v)};
}

void MaterialTable::note(const std::string& sentence) {
  auto& notes = model_.notes;
  if (std::find(notes.begin(), notes.end(), sentence) == notes.end()) notes.push_back(sentence);
}

std::optional<MaterialTable::Texture> MaterialTable::texture_at(const Json& owner, const char* key,
                                                                const std::string& where) const {
  const Json& info = object_at(file_, owner, key);
  if (info.empty()) return std::nullopt;
  const std::string here = where + "." + key;
  const Json& textures = array_at(file_, file_.json, "textures");
  const std::size_t index = reference_at(file_, info, "index", here, textures.size());
  Texture result{};
  result.scale = number_at(file_, info, "scale", here, 1.0F);
  auto set = index_at(file_, info, "texCoord", here, 0);
  const Json& extensions = object_at(file_, info, "extensions");
  const Json& transform = object_at(file_, extensions, "KHR_texture_transform");
  result.uv.transform = transform_at(file_, transform, here + ".KHR_texture_transform");
  set = index_at(file_, transform, "texCoord", here + ".KHR_texture_transform", set);
  if (set > 1000) fail(file_, here + ".texCoord is " + std::to_string(set));
  result.uv.set = static_cast<int>(set);
  const Json& texture = textures[index];
  const std::string texture_where = indexed("textures", index);
  const std::size_t images = array_at(file_, file_.json, "images").size();
  if (texture.contains("source")) {
    result.image = reference_at(file_, texture, "source", texture_where, images);
    return result;
  }
  const Json& others = object_at(file_, texture, "extensions");
  for (const char* name : {"KHR_texture_basisu", "EXT_texture_webp", "MSFT_texture_dds"}) {
    const Json& other = object_at(file_, others, name);
    if (!other.contains("source")) continue;
    result.image = reference_at(file_, other, "source", texture_where + "." + name, images);
    return result;
  }
  return std::nullopt;
}

/// The same file under two image entries is one image.
std::string MaterialTable::identity(std::size_t image) const {
  const Json& json = array_at(file_, file_.json, "images")[image];
  const std::string uri = string_at(json, "uri");
  if (!uri.empty() && !is_data_uri(uri)) return "file:" + percent_decoded(uri);
  return "image:" + std::to_string(image);
}

std::optional<MapSource> MaterialTable::source_of(const Texture& texture) {
  const Json& image = array_at(file_, file_.json, "images")[texture.image];
  const std::string where = indexed("images", texture.image);
  const std::string uri = string_at(image, "uri");
  MapSource source;
  source.name = !uri.empty() && !is_data_uri(uri)   ? percent_decoded(uri)
                : !string_at(image, "name").empty() ? string_at(image, "name")
                                                    : where;
  if (const char* format = unread_format(image)) {
    note("'" + source.name + "' is a " + format +
         " image without a PNG or JPEG beside it, so it is left " +
         "out; give the map as PNG, JPEG, TIFF, OpenEXR or TGA");
    return std::nullopt;
  }
  if (is_data_uri(uri)) {
    const auto data = decode_data_uri(uri);
    if (!data) fail(file_, where + ".uri is a damaged data URI");
    const auto bytes = std::as_bytes(std::span(data->bytes));
    source.bytes.assign(bytes.begin(), bytes.end());
    return source;
  }
  if (!uri.empty()) {
    if (has_scheme(uri)) {
      note("the image '" + uri.substr(0, 200) +
           "' is not a file beside the model, so it is left out");
      return std::nullopt;
    }
    source.path = file_.folder / percent_decoded(uri);
    return source;
  }
  const std::size_t views = array_at(file_, file_.json, "bufferViews").size();
  const auto bytes = buffer_view(file_, reference_at(file_, image, "bufferView", where, views));
  source.bytes.assign(bytes.begin(), bytes.end());
  return source;
}

void MaterialTable::read_factor(const Json& material, const std::string& where,
                                Vec3f& factor) const {
  const Json& pbr = object_at(file_, material, "pbrMetallicRoughness");
  const auto values = numbers_at(file_, pbr, "baseColorFactor", where + ".pbrMetallicRoughness",
                                 {1.0, 1.0, 1.0, 1.0});
  for (int i = 0; i < 3; ++i) factor[i] = static_cast<float>(values[static_cast<std::size_t>(i)]);
}

const Json& MaterialTable::material_json(int material) const {
  static const Json no_material = Json::object();
  if (material < 0) return no_material;
  return array_at(file_, file_.json, "materials")[static_cast<std::size_t>(material)];
}

MaterialTable::Textures MaterialTable::textures_of(int material) const {
  const Json& json = material_json(material);
  const std::string where = name_of_material(material);
  Textures textures;
  textures.normal = texture_at(json, "normalTexture", where);
  textures.albedo =
      texture_at(object_at(file_, json, "pbrMetallicRoughness"), "baseColorTexture", where);
  if (!textures.albedo) {
    const Json& older = object_at(file_, object_at(file_, json, "extensions"),
                                  "KHR_materials_pbrSpecularGlossiness");
    textures.albedo = texture_at(older, "diffuseTexture", where);
  }
  return textures;
}

std::size_t MaterialTable::make(int material) {
  const Json& json = material_json(material);
  const Textures textures = textures_of(material);
  const auto& [normal, albedo] = textures;
  const UvChoice uv = textures.uv();
  const std::string key =
      (normal   ? "n:" + identity(normal->image) + "|" + std::to_string(normal->scale)
       : albedo ? "a:" + identity(albedo->image)
                : "material:" + std::to_string(material)) +
      key_of(uv);
  const std::string albedo_key = albedo ? identity(albedo->image) + key_of(albedo->uv) : "";
  const auto known = std::find(keys_.begin(), keys_.end(), key);
  if (known != keys_.end()) {
    const auto index = static_cast<std::size_t>(known - keys_.begin());
    TextureSet& set = model_.texture_sets[index];
    set.materials.push_back(material);
    const bool same = albedo_keys_[index] == albedo_key;
    if (set.albedo && same) set.albedo_materials.push_back(material);
    if (!same) note_other_colors(set.name, model_.notes);
    return index;
  }
  TextureSet set;
  set.materials = {material};
  const std::string stem = model_.path.stem().string();
  const std::string name = string_at(json, "name");
  set.name = file_safe_name(name.empty() ? stem : name, model_.texture_sets);
  read_factor(json, name_of_material(material), set.albedo_factor);
  if (normal) set.normal_scale = normal->scale;
  if (normal) set.normal_map = source_of(*normal);
  const bool same_uv = albedo && key_of(albedo->uv) == key_of(uv);
  if (albedo && same_uv) set.albedo = source_of(*albedo);
  if (set.albedo) set.albedo_materials = {material};
  if (albedo && !same_uv) {
    note("the colour of the texture set '" + set.name + "' has other UVs than its normal map, so " +
         "it is not shown");
  }
  model_.texture_sets.push_back(std::move(set));
  keys_.push_back(key);
  albedo_keys_.push_back(albedo_key);
  return keys_.size() - 1;
}

std::size_t MaterialTable::texture_set(int material) {
  for (std::size_t i = 0; i < materials_.size(); ++i) {
    if (materials_[i] == material) return sets_[i];
  }
  const std::size_t set = make(material);
  materials_.push_back(material);
  sets_.push_back(set);
  return set;
}

}  // namespace normalshop::gltf
