#include "normalshop/io/gltf_export.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <span>
#include <unordered_map>

#include <nlohmann/json.hpp>

#include "normalshop/core/error.h"
#include "normalshop/io/atomic_file.h"
#include "normalshop/io/detail/uri.h"

namespace normalshop {

namespace {

using Json = nlohmann::ordered_json;

constexpr int float_type = 5126;
constexpr int index_type = 5125;
constexpr int vertex_target = 34962;
constexpr int index_target = 34963;

static_assert(std::endian::native == std::endian::little, "glTF buffers are little-endian");

/// Position, normal, UV and tangent: what must be equal for corners to share a vertex.
using Vertex = std::array<float, 12>;

struct VertexHash {
  std::size_t operator()(const Vertex& v) const {
    std::size_t h = 1469598103934665603ULL;
    for (const float f : v) h = (h ^ std::bit_cast<std::uint32_t>(f)) * 1099511628211ULL;
    return h;
  }
};

/// The vertices of one primitive.
struct Primitive {
  std::vector<Vertex> vertices;
  std::vector<std::uint32_t> indices;
};

Vertex vertex_of(const Mesh& mesh, std::size_t corner) {
  const Vec3f& p = mesh.position(corner);
  const Vec3f& n = mesh.normals[corner];
  const Vec2f& t = mesh.uvs[corner];
  Vertex v{p.x(), p.y(), p.z(), n.x(), n.y(), n.z(), t.x(), t.y(), 0.0F, 0.0F, 0.0F, 0.0F};
  if (!mesh.tangents.empty()) std::copy_n(mesh.tangents[corner].data(), 4, v.begin() + 8);
  for (float& f : v) f += 0.0F;  // -0 becomes 0, so that equal numbers have equal bits
  return v;
}

Primitive weld(const Mesh& mesh, std::uint32_t texture_set) {
  Primitive out;
  std::unordered_map<Vertex, std::uint32_t, VertexHash> known;
  for (std::size_t corner = 0; corner < mesh.corner_count(); ++corner) {
    if (mesh.texture_sets[corner / 3] != texture_set) continue;
    const Vertex v = vertex_of(mesh, corner);
    const auto [found, is_new] =
        known.try_emplace(v, static_cast<std::uint32_t>(out.vertices.size()));
    if (is_new) out.vertices.push_back(v);
    out.indices.push_back(found->second);
  }
  return out;
}

class Exporter {
 public:
  Exporter(const Mesh& mesh, const std::string& binary_name) : mesh_(mesh) {
    json_["asset"] = {{"version", "2.0"}, {"generator", "NormalShop"}};
    json_["scene"] = 0;
    json_["scenes"] = Json::array({{{"nodes", {0}}}});
    json_["nodes"] = Json::array({{{"mesh", 0}}});
    json_["meshes"] = Json::array({{{"primitives", Json::array()}}});
    json_["buffers"] = Json::array({{{"uri", percent_encoded(binary_name)}, {"byteLength", 0}}});
  }

  void add(std::uint32_t texture_set, const GltfMaterial& material) {
    const Primitive part = weld(mesh_, texture_set);
    if (part.indices.empty()) return;
    Json attributes = Json::object();
    attributes["POSITION"] = add_attribute(part, 0, 3, "VEC3");
    add_limits(part, json_["accessors"].back());
    attributes["NORMAL"] = add_attribute(part, 3, 3, "VEC3");
    if (!mesh_.tangents.empty()) attributes["TANGENT"] = add_attribute(part, 8, 4, "VEC4");
    attributes["TEXCOORD_0"] = add_attribute(part, 6, 2, "VEC2");
    Json primitive = Json::object();
    primitive["attributes"] = std::move(attributes);
    primitive["indices"] = add_accessor(
        std::as_bytes(std::span(part.indices)), index_target,
        {{"componentType", index_type}, {"count", part.indices.size()}, {"type", "SCALAR"}});
    primitive["material"] = add_material(material);
    json_["meshes"][0]["primitives"].push_back(std::move(primitive));
  }

  void write(const std::filesystem::path& path, const std::filesystem::path& binary_path) {
    json_["buffers"][0]["byteLength"] = binary_.size();
    write_file(binary_path, binary_);
    write_file(path, json_.dump(2) + "\n");
  }

 private:
  std::size_t append(const char* key, Json value) {
    Json& list = json_[key];
    if (!list.is_array()) list = Json::array();
    list.push_back(std::move(value));
    return list.size() - 1;
  }

  std::size_t add_attribute(const Primitive& part, std::size_t first, std::size_t count,
                            const char* type) {
    std::vector<float> values;
    values.reserve(part.vertices.size() * count);
    for (const Vertex& v : part.vertices) {
      values.insert(values.end(), v.data() + first, v.data() + first + count);
    }
    return add_accessor(
        std::as_bytes(std::span(values)), vertex_target,
        {{"componentType", float_type}, {"count", part.vertices.size()}, {"type", type}});
  }

  std::size_t add_accessor(std::span<const std::byte> bytes, int target, Json accessor) {
    const std::size_t offset = binary_.size();
    binary_.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    accessor["bufferView"] = append(
        "bufferViews",
        {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", bytes.size()}, {"target", target}});
    return append("accessors", std::move(accessor));
  }

  static void add_limits(const Primitive& part, Json& accessor) {
    Json low = Json::array();
    Json high = Json::array();
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [a, b] =
          std::minmax_element(part.vertices.begin(), part.vertices.end(),
                              [k](const Vertex& u, const Vertex& v) { return u[k] < v[k]; });
      low.push_back((*a)[k]);
      high.push_back((*b)[k]);
    }
    accessor["min"] = std::move(low);
    accessor["max"] = std::move(high);
  }

  std::size_t add_texture(const std::string& file) {
    const std::size_t image = append("images", {{"uri", percent_encoded(file)}});
    return append("textures", {{"source", image}});
  }

  std::size_t add_material(const GltfMaterial& material) {
    Json pbr = {{"metallicFactor", 0.0}, {"roughnessFactor", material.roughness}};
    if (!material.color_map.empty()) {
      pbr["baseColorTexture"] = {{"index", add_texture(material.color_map)}};
    }
    Json json = {{"name", material.name}, {"pbrMetallicRoughness", std::move(pbr)}};
    if (!material.normal_map.empty()) {
      json["normalTexture"] = {{"index", add_texture(material.normal_map)}};
    }
    return append("materials", std::move(json));
  }

  const Mesh& mesh_;
  Json json_ = Json::object();
  std::string binary_;
};

void check(const std::filesystem::path& path, const Mesh& mesh,
           const std::vector<GltfMaterial>& materials) {
  const std::string name = "'" + path.string() + "'";
  if (path.extension() != ".gltf") throw InvalidInput(name + ": the extension must be .gltf");
  if (mesh.triangles.empty())
    throw InvalidInput(name + ": a mesh without triangles is not written");
  if (mesh.normals.size() != mesh.corner_count() || mesh.uvs.size() != mesh.corner_count()) {
    throw InvalidInput(name + ": the mesh needs normals and UVs at every corner");
  }
  if (materials.size() != mesh.texture_set_names.size()) {
    throw InvalidInput(name + ": " + std::to_string(materials.size()) + " materials for " +
                       std::to_string(mesh.texture_set_names.size()) + " texture sets");
  }
}

}  // namespace

void export_gltf(const std::filesystem::path& path, const Mesh& mesh,
                 const std::vector<GltfMaterial>& materials) {
  check(path, mesh, materials);
  std::filesystem::path binary = path;
  binary.replace_extension(".bin");
  Exporter exporter(mesh, binary.filename().string());
  for (std::uint32_t set = 0; set < materials.size(); ++set) exporter.add(set, materials[set]);
  exporter.write(path, binary);
}

}  // namespace normalshop
