#include "support/gltf_corners.h"

#include <array>
#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace normalshop::test {
namespace {

using nlohmann::json;
using Bytes = std::vector<char>;

Bytes read_bytes(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw std::runtime_error("cannot read " + file.string());
  return Bytes(std::istreambuf_iterator<char>(stream), {});
}

std::uint32_t word_at(const Bytes& bytes, std::size_t offset) {
  std::uint32_t word = 0;
  if (offset + sizeof word > bytes.size()) throw std::runtime_error("file too short");
  std::memcpy(&word, bytes.data() + offset, sizeof word);
  return word;
}

struct Gltf {
  json document;
  Bytes buffer;
};

Gltf read_gltf(const std::filesystem::path& file) {
  Gltf gltf;
  const Bytes bytes = read_bytes(file);
  if (word_at(bytes, 0) != 0x46546C67) {
    gltf.document = json::parse(bytes);
    const std::string uri = gltf.document["buffers"][0]["uri"];
    gltf.buffer = read_bytes(file.parent_path() / uri);
    return gltf;
  }
  const std::size_t length = word_at(bytes, 12);
  const auto json_begin = bytes.begin() + 20;
  const auto json_end = json_begin + static_cast<std::ptrdiff_t>(length);
  gltf.document = json::parse(json_begin, json_end);
  gltf.buffer.assign(json_end + 8, bytes.end());
  return gltf;
}

/// `count` values of an accessor's element `index`, as they lie in the buffer.
template <class T, std::size_t count>
std::array<T, count> element(const Gltf& gltf, std::size_t accessor_index, std::size_t index) {
  const json& accessor = gltf.document["accessors"][accessor_index];
  const json& view = gltf.document["bufferViews"][accessor["bufferView"].get<std::size_t>()];
  const std::size_t offset =
      view.value("byteOffset", std::size_t{0}) + accessor.value("byteOffset", std::size_t{0});
  const std::size_t stride = view.value("byteStride", sizeof(T) * count);
  std::array<T, count> values;
  const std::size_t begin = offset + index * stride;
  if (begin + sizeof values > gltf.buffer.size()) throw std::runtime_error("buffer too short");
  std::memcpy(values.data(), gltf.buffer.data() + begin, sizeof values);
  return values;
}

std::uint32_t index_at(const Gltf& gltf, std::size_t accessor, std::size_t i) {
  switch (gltf.document["accessors"][accessor]["componentType"].get<int>()) {
    case 5121:
      return element<std::uint8_t, 1>(gltf, accessor, i)[0];
    case 5123:
      return element<std::uint16_t, 1>(gltf, accessor, i)[0];
    default:
      return element<std::uint32_t, 1>(gltf, accessor, i)[0];
  }
}

void add_primitive(const Gltf& gltf, const json& primitive, Mesh& mesh) {
  const auto indices = primitive["indices"].get<std::size_t>();
  const json& attributes = primitive["attributes"];
  const auto positions = attributes["POSITION"].get<std::size_t>();
  const auto normals = attributes["NORMAL"].get<std::size_t>();
  const auto uvs = attributes["TEXCOORD_0"].get<std::size_t>();
  const auto count = gltf.document["accessors"][indices]["count"].get<std::size_t>();
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t vertex = index_at(gltf, indices, i);
    const auto p = element<float, 3>(gltf, positions, vertex);
    const auto n = element<float, 3>(gltf, normals, vertex);
    const auto uv = element<float, 2>(gltf, uvs, vertex);
    mesh.positions.emplace_back(p[0], p[1], p[2]);
    mesh.normals.emplace_back(n[0], n[1], n[2]);
    mesh.uvs.emplace_back(uv[0], uv[1]);
  }
}

}  // namespace

Mesh load_gltf_corners(const std::filesystem::path& file) {
  const Gltf gltf = read_gltf(file);
  Mesh mesh;
  mesh.texture_set_names = {"map"};
  for (const json& part : gltf.document["meshes"]) {
    for (const json& primitive : part["primitives"]) add_primitive(gltf, primitive, mesh);
  }
  for (std::uint32_t c = 0; c + 2 < mesh.positions.size(); c += 3) {
    mesh.triangles.emplace_back(c, c + 1, c + 2);
    mesh.texture_sets.push_back(0);
  }
  return mesh;
}

}  // namespace normalshop::test
