#include <algorithm>
#include <cstring>
#include <optional>
#include <set>

#include "normalshop/core/error.h"
#include "normalshop/io/atomic_file.h"
#include "normalshop/io/detail/gltf_file.h"
#include "normalshop/io/detail/model_source.h"
#include "normalshop/io/detail/uri.h"

namespace normalshop {

namespace {

using namespace gltf;

constexpr const char* older_material = "KHR_materials_pbrSpecularGlossiness";

/// Appends to the list `key` of `json`, which may be absent.
std::size_t append(Json& json, const char* key, Json value) {
  Json& list = json[key];
  if (!list.is_array()) list = Json::array();
  list.push_back(std::move(value));
  return list.size() - 1;
}

template <class T>
void flip_component(char* at, T top) {
  T value;
  std::memcpy(&value, at, sizeof(T));
  value = static_cast<T>(top - value);
  std::memcpy(at, &value, sizeof(T));
}

/// Writes the file that was read, with its JSON edited.
class Writer {
 public:
  Writer(const Model& model, const std::filesystem::path& path,
         const std::map<std::size_t, MapReferences>& maps)
      : model_(model), path_(path), maps_(maps), companions_(*model.source, path, maps) {
    file_.name = model.path.string();
    file_.folder = model.source->folder;
    file_.binary = model.source->format == ModelFormat::Glb;
    file_.json = parse_json(model.source->text, file_.name);
    file_.buffers = model.source->buffers;
    modified_.resize(file_.buffers.size(), false);
  }

  WrittenModel write() {
    if (model_.source->flip_v) flip_uvs();
    erase_tangents();
    for (const auto& [set, references] : maps_) set_maps(set, references);
    place_buffers();
    place_images();
    write_file(path_, file_.binary ? binary() : text());
    companions_.result.files.insert(companions_.result.files.begin(), path_);
    return std::move(companions_.result);
  }

 private:
  void note(const std::string& sentence) { companions_.result.notes.push_back(sentence); }

  void set_maps(std::size_t set, const MapReferences& references) {
    const TextureSet& textures = model_.texture_sets[set];
    const std::vector<int>& colored = textures.albedo_materials;
    const auto normal = add_image(references.normal);
    const auto color = add_image(references.color);
    for (const int material : textures.materials) {
      const std::size_t index =
          material >= 0 ? static_cast<std::size_t>(material) : add_material(set);
      Json& json = file_.json["materials"][index];
      if (normal) set_normal_map(json, *normal, references.scale_applied);
      const bool shows = std::find(colored.begin(), colored.end(), material) != colored.end();
      if (color && shows) set_color_map(json, *color);
    }
  }

  std::optional<std::size_t> add_image(const std::string& name) {
    if (name.empty()) return std::nullopt;
    Json image = Json::object();
    image["uri"] = percent_encoded(name);
    return append(file_.json, "images", std::move(image));
  }

  /// A texture of that image, otherwise as the one that `info` names.
  void set_texture(Json& info, std::size_t image) {
    Json texture = Json::object();
    const Json* sampler = sampler_of(info);
    if (sampler != nullptr) texture["sampler"] = *sampler;
    texture["source"] = image;
    info["index"] = append(file_.json, "textures", std::move(texture));
  }

  void set_normal_map(Json& material, std::size_t image, bool scale_applied) {
    Json info =
        material.contains("normalTexture") ? material["normalTexture"] : like_albedo(material);
    set_texture(info, image);
    if (scale_applied) info.erase("scale");
    material["normalTexture"] = std::move(info);
  }

  /// The colours were edited in the UVs of the normal texture, where there is one.
  void set_color_map(Json& material, std::size_t image) {
    const bool older = older_color(material);
    Json& owner = older ? material["extensions"][older_material] : material["pbrMetallicRoughness"];
    if (!owner.is_object()) owner = Json::object();
    Json& info = owner[older ? "diffuseTexture" : "baseColorTexture"];
    const Json* sampler = sampler_of(info);
    const Json kept = sampler == nullptr ? Json() : *sampler;
    if (material.contains("normalTexture")) {
      Json like = material["normalTexture"];
      like.erase("scale");
      info = std::move(like);
    }
    if (!info.is_object()) info = Json::object();
    set_texture(info, image);
    if (!kept.is_null()) file_.json["textures"].back()["sampler"] = kept;
  }

  /// Does the material have its colours in the extension that came before glTF's own?
  bool older_color(const Json& material) const {
    const Json& pbr = object_at(file_, material, "pbrMetallicRoughness");
    const Json& extensions = object_at(file_, material, "extensions");
    return !pbr.contains("baseColorTexture") &&
           object_at(file_, extensions, older_material).contains("diffuseTexture");
  }

  const Json* sampler_of(const Json& info) const {
    const Json& textures = array_at(file_, file_.json, "textures");
    if (!info.contains("index")) return nullptr;
    const auto index = info["index"].get<std::size_t>();
    if (index >= textures.size() || !textures[index].contains("sampler")) return nullptr;
    return &textures[index]["sampler"];
  }

  /// A new normal texture has the UVs that the colour texture has.
  Json like_albedo(const Json& material) const {
    const Json& pbr = object_at(file_, material, "pbrMetallicRoughness");
    const Json& extensions = object_at(file_, material, "extensions");
    if (older_color(material)) return extensions[older_material]["diffuseTexture"];
    return pbr.contains("baseColorTexture") ? pbr["baseColorTexture"] : Json::object();
  }

  /// For triangles without a material.
  std::size_t add_material(std::size_t set) {
    Json material = Json::object();
    material["name"] = model_.texture_sets[set].name;
    const std::size_t index = append(file_.json, "materials", std::move(material));
    for_each_primitive([&](Json& primitive) {
      if (!primitive.contains("material")) primitive["material"] = index;
    });
    return index;
  }

  template <class Action>
  void for_each_primitive(Action action) {
    for (Json& mesh : file_.json["meshes"]) {
      if (!mesh.contains("primitives")) continue;
      for (Json& primitive : mesh["primitives"]) action(primitive);
    }
  }

  /// The maps were edited in the frames that take their place.
  void erase_tangents() {
    bool erased = false;
    for (const auto& [mesh, primitive] : model_.source->replaced_tangents) {
      Json& attributes = file_.json["meshes"][mesh]["primitives"][primitive]["attributes"];
      erased = attributes.erase("TANGENT") > 0 || erased;
    }
    if (erased) {
      note("tangents that were replaced are left out of '" + path_.filename().string() +
           "', so that every program computes the same");
    }
  }

  void flip_uvs() {
    std::set<std::size_t> accessors;
    bool tangents = false;
    for_each_primitive([&](Json& primitive) {
      if (!primitive.contains("attributes")) return;
      Json& attributes = primitive["attributes"];
      for (const auto& [key, value] : attributes.items()) {
        if (key.starts_with("TEXCOORD_")) accessors.insert(value.template get<std::size_t>());
      }
      tangents = attributes.erase("TANGENT") > 0 || tangents;
    });
    std::set<std::pair<std::size_t, std::size_t>> done;
    for (const std::size_t index : accessors) flip_accessor(index, done);
    note("V of all texture coordinates is flipped in '" + path_.filename().string() +
         "', as it was on reading; the maps are not flipped");
    if (tangents) note("the file's tangents are left out, as they belong to the unflipped V");
  }

  void flip_accessor(std::size_t index, std::set<std::pair<std::size_t, std::size_t>>& done) {
    const std::size_t size = array_at(file_, file_.json, "accessors").size();
    if (index >= size) fail(file_, "a TEXCOORD names an accessor that does not exist");
    const Accessor a = accessor(file_, index, std::size_t{1} << 32);
    const bool is_float = a.component_type == 5126;
    if (a.components != 2 || (!is_float && !a.normalized)) {
      fail(file_, "accessors[" + std::to_string(index) + "] holds texture coordinates whose V " +
                      "cannot be flipped; accepted are floats and normalised integers");
    }
    if (!a.has_data) fail(file_, "texture coordinates without data cannot be flipped");
    const auto flip = [&](const Layout& layout, std::size_t count) {
      modified_[layout.buffer] = true;
      for (std::size_t i = 0; i < count; ++i) {
        const std::size_t at = layout.offset + i * layout.stride + component_size(a.component_type);
        if (!done.emplace(layout.buffer, at).second) continue;
        flip_at(file_.buffers[layout.buffer].data() + at, a.component_type);
      }
    };
    flip(a.data, a.count);
    if (a.sparse_count > 0) flip(a.sparse_values, a.sparse_count);
    flip_limits(file_.json["accessors"][index], a.component_type);
  }

  static double top_of(int type) {
    switch (type) {
      case 5120:
        return 127.0;
      case 5121:
        return 255.0;
      case 5122:
        return 32767.0;
      case 5123:
        return 65535.0;
      default:
        return 1.0;
    }
  }

  static void flip_at(char* at, int type) {
    switch (type) {
      case 5120:
        return flip_component<std::int8_t>(at, 127);
      case 5121:
        return flip_component<std::uint8_t>(at, 255);
      case 5122:
        return flip_component<std::int16_t>(at, 32767);
      case 5123:
        return flip_component<std::uint16_t>(at, 65535);
      case 5125:
        return flip_component<std::uint32_t>(at, 4294967295U);
      default:
        return flip_component<float>(at, 1.0F);
    }
  }

  static void flip_limits(Json& json, int type) {
    const auto fits = [&](const char* key) {
      return json.contains(key) && json[key].is_array() && json[key].size() == 2 &&
             json[key][1].is_number();
    };
    if (!fits("min") || !fits("max")) return;
    const Json low = json["min"][1];
    const Json high = json["max"][1];
    if (type == 5126) {
      // In float, as the data: the limits must be exact.
      json["min"][1] = static_cast<double>(1.0F - high.get<float>());
      json["max"][1] = static_cast<double>(1.0F - low.get<float>());
    } else {
      json["min"][1] = static_cast<std::int64_t>(top_of(type) - high.get<double>());
      json["max"][1] = static_cast<std::int64_t>(top_of(type) - low.get<double>());
    }
  }

  /// A changed buffer gets a new name, so that the original model beside it keeps its own.
  void place_buffers() {
    if (!file_.json.contains("buffers")) return;
    Json& buffers = file_.json["buffers"];
    for (std::size_t i = 0; i < buffers.size(); ++i) {
      const std::string uri = string_at(buffers[i], "uri");
      if (uri.empty()) continue;
      if (is_data_uri(uri)) {
        if (modified_[i]) {
          buffers[i]["uri"] = "data:application/octet-stream;base64," + base64(file_.buffers[i]);
        }
        continue;
      }
      const std::string reference = percent_decoded(uri);
      std::string placed;
      if (modified_[i]) {
        const std::filesystem::path old(reference);
        const std::string name = path_.stem().string() + "_" + old.filename().string();
        placed = companions_.write((old.parent_path() / name).string(), file_.buffers[i]);
      } else {
        placed = companions_.copy(reference);
      }
      if (placed != reference) buffers[i]["uri"] = percent_encoded(placed);
    }
  }

  void place_images() {
    if (!file_.json.contains("images")) return;
    for (Json& image : file_.json["images"]) {
      const std::string uri = string_at(image, "uri");
      if (uri.empty() || is_data_uri(uri) || has_scheme(uri)) continue;
      const std::string reference = percent_decoded(uri);
      const bool is_new = std::any_of(maps_.begin(), maps_.end(), [&](const auto& m) {
        return m.second.normal == reference || m.second.color == reference;
      });
      if (is_new) continue;
      const std::string placed = companions_.copy(reference);
      if (placed != reference) image["uri"] = percent_encoded(placed);
    }
  }

  /// Indented as the source is.
  std::string text() const {
    const std::string& source = model_.source->text;
    const std::size_t line = source.find('\n');
    if (line == std::string::npos) return file_.json.dump();
    const std::size_t first = source.find_first_not_of("\r\n", line);
    if (first != std::string::npos && source[first] == '\t') return file_.json.dump(1, '\t') + "\n";
    const std::size_t word = source.find_first_not_of(' ', first);
    const std::size_t spaces = word == std::string::npos ? 2 : word - first;
    return file_.json.dump(static_cast<int>(std::clamp<std::size_t>(spaces, 0, 8))) + "\n";
  }

  std::string binary() const {
    std::string json = file_.json.dump();
    json.resize((json.size() + 3) / 4 * 4, ' ');
    const Json& buffers = array_at(file_, file_.json, "buffers");
    const bool has_chunk = !buffers.empty() && string_at(buffers[0], "uri").empty();
    std::string chunk = has_chunk ? file_.buffers[0] : std::string();
    chunk.resize((chunk.size() + 3) / 4 * 4, '\0');
    const std::size_t total = 20 + json.size() + (has_chunk ? 8 + chunk.size() : 0);
    if (total > 0xFFFFFFFFU) fail(file_, "it is too large for a .glb");
    std::string bytes;
    put(bytes, 0x46546C67U);
    put(bytes, 2);
    put(bytes, total);
    put(bytes, json.size());
    put(bytes, 0x4E4F534AU);
    bytes += json;
    if (has_chunk) {
      put(bytes, chunk.size());
      put(bytes, 0x004E4942U);
      bytes += chunk;
    }
    return bytes;
  }

  static void put(std::string& bytes, std::size_t word) {
    for (int i = 0; i < 4; ++i) bytes += static_cast<char>(word >> (8 * i) & 0xFFU);
  }

  const Model& model_;
  const std::filesystem::path& path_;
  const std::map<std::size_t, MapReferences>& maps_;
  Companions companions_;
  File file_;
  std::vector<bool> modified_;
};

}  // namespace

WrittenModel write_gltf(const Model& model, const std::filesystem::path& path,
                        const std::map<std::size_t, MapReferences>& maps) {
  return Writer(model, path, maps).write();
}

}  // namespace normalshop
