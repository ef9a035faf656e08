#pragma once

#include <cstring>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "normalshop/io/detail/uri.h"
#include "normalshop/io/model.h"

namespace normalshop::test {

/// A small glTF file made in memory: a list of buffer views in one data URI, and free JSON.
struct GltfBuilder {
  using Json = nlohmann::ordered_json;

  Json json = {{"asset", {{"version", "2.0"}}}, {"scenes", {{{"nodes", {0}}}}},
               {"nodes", {{{"mesh", 0}}}},      {"meshes", {{{"primitives", Json::array()}}}},
               {"accessors", Json::array()},    {"bufferViews", Json::array()}};
  std::string bytes;

  template <class T>
  int view(const std::vector<T>& values, int stride = 0) {
    bytes.resize((bytes.size() + 3) / 4 * 4, '\0');
    Json v = {
        {"buffer", 0}, {"byteOffset", bytes.size()}, {"byteLength", values.size() * sizeof(T)}};
    if (stride != 0) v["byteStride"] = stride;
    json["bufferViews"].push_back(v);
    bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
    return static_cast<int>(json["bufferViews"].size()) - 1;
  }
  /// Accessor over a new view.
  template <class T>
  int accessor(const std::vector<T>& values, int component_type, const char* type, int components) {
    const int v = view(values);
    json["accessors"].push_back({{"bufferView", v},
                                 {"componentType", component_type},
                                 {"count", values.size() / static_cast<std::size_t>(components)},
                                 {"type", type}});
    return static_cast<int>(json["accessors"].size()) - 1;
  }
  int floats(const std::vector<float>& values, int components) {
    const char* types[] = {"", "SCALAR", "VEC2", "VEC3", "VEC4"};
    return accessor(values, 5126, types[components], components);
  }

  /// A unit square in the plane z = 0, u right, v down; vertices counter-clockwise from the lower
  /// left.
  Json& square() {
    Json attributes = {{"POSITION", floats({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, 3)},
                       {"NORMAL", floats({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, 3)},
                       {"TEXCOORD_0", floats({0, 1, 1, 1, 1, 0, 0, 0}, 2)}};
    const int indices = accessor(std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3}, 5123, "SCALAR", 1);
    Json& list = json["meshes"][0]["primitives"];
    list.push_back({{"attributes", attributes}, {"indices", indices}});
    return list.back();
  }

  std::string text() const {
    Json copy = json;
    copy["buffers"] = {{{"byteLength", bytes.size()},
                        {"uri", "data:application/octet-stream;base64," + base64(bytes)}}};
    return copy.dump();
  }
  Model read(const ModelReadOptions& options = {}) const {
    const std::string whole = text();
    return parse_gltf(std::as_bytes(std::span(whole)), "/none/test.gltf", options);
  }
};

/// A material with that texture as "normalTexture", or as its colour.
inline GltfBuilder::Json textured(const char* key, int index) {
  if (std::string(key) == "normalTexture") return {{key, {{"index", index}}}};
  return {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", index}}}}}};
}

inline bool mentions(const std::vector<std::string>& notes, const std::string& words) {
  for (const auto& note : notes) {
    if (note.find(words) != std::string::npos) return true;
  }
  return false;
}

}  // namespace normalshop::test
