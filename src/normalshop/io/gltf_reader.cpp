#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include <Eigen/Dense>
#include <Eigen/Geometry>

#include "normalshop/core/error.h"
#include "normalshop/io/detail/gltf_file.h"
#include "normalshop/io/detail/gltf_materials.h"
#include "normalshop/io/detail/model_source.h"
#include "normalshop/surface/tangents.h"

namespace normalshop {

namespace {

using namespace gltf;
using Matrix = Eigen::Matrix4d;

/// Extensions that a file may require: they change nothing that is edited here, or are read.
bool can_do(const std::string& extension) {
  static constexpr std::array<std::string_view, 12> known = {
      "KHR_texture_transform",
      "KHR_mesh_quantization",
      "KHR_texture_basisu",
      "EXT_texture_webp",
      "KHR_lights_punctual",
      "KHR_xmp_json_ld",
      "KHR_xmp",
      "KHR_materials_unlit",
      "MSFT_texture_dds",
      "KHR_node_visibility",
      "KHR_animation_pointer",
      "MSFT_packing_occlusionRoughnessMetallic"};
  return extension.starts_with("KHR_materials_") ||
         std::find(known.begin(), known.end(), extension) != known.end();
}

void check_extensions(const File& file) {
  for (const Json& value : array_at(file, file.json, "extensionsRequired")) {
    const std::string name = value.is_string() ? value.get<std::string>() : "?";
    if (can_do(name)) continue;
    fail(file, "it requires the glTF extension '" + name +
                   "', which is not supported; export it without (for geometry: uncompressed)");
  }
}

class Reader {
 public:
  Reader(const File& file, const ModelReadOptions& options, Model& model)
      : file_(file),
        options_(options),
        model_(model),
        materials_(file, model),
        nodes_(array_at(file, file.json, "nodes")),
        meshes_(array_at(file, file.json, "meshes")) {}

  /// Primitives whose TANGENT is replaced by computed tangents, once read() is done.
  const std::set<PrimitiveIndex>& replaced_tangents() const { return replaced_tangents_; }

  void read() {
    check_extensions(file_);
    for (const auto& [node, transform] : placed_nodes()) read_node(node, transform);
    if (skipped_no_uv_ > 0 && model_.mesh.triangles.empty()) {
      fail(file_,
           "the model has no texture coordinates; \"normalshop unwrap\" writes it with some");
    }
    if (model_.mesh.triangles.empty()) fail(file_, "the model has no triangles");
    if (skipped_no_uv_ > 0) {
      note(std::to_string(skipped_no_uv_) + " parts without texture coordinates are left out");
    }
    finish_normals();
    finish_tangents();
    for (const auto& set : model_.texture_sets) {
      model_.mesh.texture_set_names.push_back(set.name);
    }
  }

 private:
  struct Placed {
    std::size_t node;
    Matrix transform;
  };

  void note(const std::string& sentence) {
    auto& notes = model_.notes;
    if (std::find(notes.begin(), notes.end(), sentence) == notes.end()) notes.push_back(sentence);
  }

  Matrix local_transform(std::size_t index) const {
    const Json& node = nodes_[index];
    const std::string where = "nodes[" + std::to_string(index) + "]";
    const auto m =
        numbers_at(file_, node, "matrix", where, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1});
    const auto t = numbers_at(file_, node, "translation", where, {0, 0, 0});
    const auto r = numbers_at(file_, node, "rotation", where, {0, 0, 0, 1});
    const auto s = numbers_at(file_, node, "scale", where, {1, 1, 1});
    if (node.contains("matrix")) return Eigen::Map<const Matrix>(m.data());
    Eigen::Quaterniond rotation(r[3], r[0], r[1], r[2]);
    if (!(rotation.norm() > 1e-12)) fail(file_, where + ".rotation must not be zero");
    rotation.normalize();
    Matrix result = Matrix::Identity();
    result.topLeftCorner<3, 3>() =
        rotation.toRotationMatrix() * Eigen::Vector3d(s[0], s[1], s[2]).asDiagonal();
    result.topRightCorner<3, 1>() = Eigen::Vector3d(t[0], t[1], t[2]);
    return result;
  }

  std::vector<std::size_t> roots() const {
    const Json& scenes = array_at(file_, file_.json, "scenes");
    std::vector<std::size_t> result;
    if (scenes.empty()) {
      std::vector<bool> is_child(nodes_.size(), false);
      for (std::size_t i = 0; i < nodes_.size(); ++i) {
        for (const std::size_t child : children(i)) is_child[child] = true;
      }
      for (std::size_t i = 0; i < nodes_.size(); ++i) {
        if (!is_child[i]) result.push_back(i);
      }
      return result;
    }
    const Json& root = file_.json;
    const std::size_t scene =
        root.contains("scene") ? reference_at(file_, root, "scene", "the file", scenes.size()) : 0;
    return references(scenes[scene], "nodes", "scenes[" + std::to_string(scene) + "]");
  }

  std::vector<std::size_t> children(std::size_t node) const {
    return references(nodes_[node], "children", "nodes[" + std::to_string(node) + "]");
  }

  std::vector<std::size_t> references(const Json& owner, const char* key,
                                      const std::string& where) const {
    std::vector<std::size_t> result;
    for (const Json& value : array_at(file_, owner, key)) {
      const bool whole = value.is_number_unsigned();
      if (!whole || value.get<std::uint64_t>() >= nodes_.size()) {
        fail(file_, where + "." + key + " names a node that does not exist");
      }
      result.push_back(value.get<std::size_t>());
    }
    return result;
  }

  /// Nodes of the scene, parents before children, in the file's order.
  std::vector<Placed> placed_nodes() const {
    std::vector<Placed> order;
    std::vector<bool> seen(nodes_.size(), false);
    std::vector<Placed> stack;
    const auto push = [&](const std::vector<std::size_t>& list, const Matrix& parent) {
      for (std::size_t i = list.size(); i > 0; --i) stack.push_back({list[i - 1], parent});
    };
    push(roots(), Matrix::Identity());
    while (!stack.empty()) {
      Placed next = stack.back();
      stack.pop_back();
      if (seen[next.node]) {
        fail(file_, "nodes[" + std::to_string(next.node) + "] has more than one parent");
      }
      seen[next.node] = true;
      next.transform = next.transform * local_transform(next.node);
      order.push_back(next);
      push(children(next.node), next.transform);
    }
    return order;
  }

  void read_node(std::size_t index, const Matrix& transform) {
    const Json& node = nodes_[index];
    if (!node.contains("mesh")) return;
    const std::string where = "nodes[" + std::to_string(index) + "]";
    const std::size_t mesh = reference_at(file_, node, "mesh", where, meshes_.size());
    Matrix placed = transform;
    if (node.contains("skin")) {
      note("skins are ignored: the mesh is shown in its bind pose");
      placed = Matrix::Identity();
    }
    if (object_at(file_, node, "extensions").contains("EXT_mesh_gpu_instancing")) {
      note("instances (EXT_mesh_gpu_instancing) are shown once");
    }
    const double volume = placed.topLeftCorner<3, 3>().determinant();
    if (!(std::abs(volume) > 1e-30) || !std::isfinite(volume)) {
      note("the node '" + string_at(node, "name") + "' has no volume (scale 0) and is left out");
      return;
    }
    const Json& primitives = array_at(file_, meshes_[mesh], "primitives");
    for (std::size_t i = 0; i < primitives.size(); ++i) {
      primitive_ = {mesh, i};
      read_primitive(primitives[i],
                     "meshes[" + std::to_string(mesh) + "].primitives[" + std::to_string(i) + "]",
                     placed);
    }
  }

  std::optional<std::size_t> attribute(const Json& primitive, const std::string& name,
                                       const std::string& where) const {
    const Json& attributes = object_at(file_, primitive, "attributes");
    if (!attributes.contains(name)) return std::nullopt;
    const std::size_t size = array_at(file_, file_.json, "accessors").size();
    return reference_at(file_, attributes, name.c_str(), where + ".attributes", size);
  }

  std::vector<float> values(const Json& primitive, const std::string& name,
                            const std::string& where, int components, std::size_t count) const {
    const auto index = attribute(primitive, name, where);
    if (!index) return {};
    auto result = read_floats(file_, *index, max_vertices(), components);
    if (result.size() != count * static_cast<std::size_t>(components)) {
      fail(file_, where + ".attributes." + name + " has another count than POSITION");
    }
    return result;
  }

  std::size_t max_vertices() const { return 3 * options_.max_triangles; }

  int material_of(const Json& primitive, const std::string& where) const {
    if (!primitive.contains("material")) return -1;
    const std::size_t size = array_at(file_, file_.json, "materials").size();
    return static_cast<int>(reference_at(file_, primitive, "material", where, size));
  }

  /// Vertex numbers of the triangles, three a piece.
  std::vector<std::uint32_t> corners_of(const Json& primitive, const std::string& where,
                                        std::size_t vertices, std::int64_t mode) const {
    std::vector<std::uint32_t> list;
    if (primitive.contains("indices")) {
      const std::size_t size = array_at(file_, file_.json, "accessors").size();
      list = read_indices(file_, reference_at(file_, primitive, "indices", where, size),
                          max_vertices());
      for (const std::uint32_t index : list) {
        if (index >= vertices) {
          fail(file_, where + ".indices holds " + std::to_string(index) + ", but there are only " +
                          std::to_string(vertices) + " vertices");
        }
      }
    } else {
      list.resize(vertices);
      for (std::size_t i = 0; i < vertices; ++i) list[i] = static_cast<std::uint32_t>(i);
    }
    if (mode == 4) {
      if (list.size() % 3 != 0) fail(file_, where + ": its indices are no multiple of 3");
      return list;
    }
    std::vector<std::uint32_t> corners;
    for (std::size_t i = 0; i + 2 < list.size(); ++i) {
      const std::size_t odd = i % 2;
      const std::array<std::size_t, 3> strip = {i, i + 1 + odd, i + 2 - odd};
      const std::array<std::size_t, 3> fan = {i + 1, i + 2, 0};
      for (const std::size_t k : mode == 5 ? strip : fan) corners.push_back(list[k]);
    }
    return corners;
  }

  void read_primitive(const Json& primitive, const std::string& where, const Matrix& transform) {
    const std::int64_t mode = index_at(file_, primitive, "mode", where, 4);
    if (mode > 6) fail(file_, where + ".mode must be 0 to 6");
    if (mode < 4) {
      note("points and lines are left out");
      return;
    }
    if (object_at(file_, primitive, "extensions").contains("KHR_draco_mesh_compression") &&
        !has_plain_positions(primitive, where)) {
      fail(file_, where + " is compressed (KHR_draco_mesh_compression); export it uncompressed");
    }
    const auto position_index = attribute(primitive, "POSITION", where);
    if (!position_index) fail(file_, where + " has no POSITION");
    const int material = material_of(primitive, where);
    const UvChoice uv = materials_.uv_choice(material);
    const std::string uv_name = "TEXCOORD_" + std::to_string(uv.set);
    if (!options_.keep_without_uvs && !attribute(primitive, uv_name, where)) {
      ++skipped_no_uv_;
      return;
    }
    if (primitive.contains("targets")) note("morph targets are ignored: the base shape is edited");
    const auto positions = read_floats(file_, *position_index, max_vertices(), 3);
    const std::size_t vertices = positions.size() / 3;
    if (vertices + model_.mesh.positions.size() > max_vertices()) {
      fail(file_, "it has more than " + std::to_string(max_vertices()) + " vertices");
    }
    append(corners_of(primitive, where, vertices, mode), positions,
           values(primitive, "NORMAL", where, 3, vertices),
           values(primitive, "TANGENT", where, 4, vertices),
           values(primitive, uv_name, where, 2, vertices), uv.transform,
           materials_.texture_set(material), transform);
  }

  bool has_plain_positions(const Json& primitive, const std::string& where) const {
    const auto index = attribute(primitive, "POSITION", where);
    return index && array_at(file_, file_.json, "accessors")[*index].contains("bufferView");
  }

  void append(const std::vector<std::uint32_t>& corners, const std::vector<float>& positions,
              const std::vector<float>& normals, const std::vector<float>& tangents,
              const std::vector<float>& uvs, const UvTransform& uv_transform, std::size_t set,
              const Matrix& transform) {
    Mesh& mesh = model_.mesh;
    if (mesh.triangles.size() + corners.size() / 3 > options_.max_triangles) {
      fail(file_, "it has more than " + std::to_string(options_.max_triangles) + " triangles");
    }
    const auto base = static_cast<std::uint32_t>(mesh.positions.size());
    const Eigen::Matrix3d linear = transform.topLeftCorner<3, 3>();
    const bool mirrored = linear.determinant() < 0.0;
    const Eigen::Matrix3d for_normals = linear.inverse().transpose();
    for (std::size_t i = 0; i < positions.size(); i += 3) {
      const Eigen::Vector3d p = linear * vec3(positions, i) + transform.topRightCorner<3, 1>();
      if (!(p.cwiseAbs().maxCoeff() < 1e18)) fail(file_, "a position lies beyond 1e18");
      mesh.positions.push_back(p.cast<float>());
    }
    if (normals.empty()) model_.has_normals = false;
    const bool own_tangents = keeps_tangents(corners, normals, tangents, linear);
    (own_tangents ? some_tangents_ : some_without_tangents_) = true;
    add_node(for_normals, corners.size() / 3);
    for (std::size_t t = 0; t + 2 < corners.size(); t += 3) {
      const std::array<std::uint32_t, 3> order = {corners[t], corners[t + (mirrored ? 2 : 1)],
                                                  corners[t + (mirrored ? 1 : 2)]};
      mesh.triangles.emplace_back(base + order[0], base + order[1], base + order[2]);
      mesh.texture_sets.push_back(static_cast<std::uint32_t>(set));
      for (const std::uint32_t v : order) {
        Vec2f uv = uvs.empty() ? Vec2f(0.0F, 0.0F) : Vec2f(uvs[2 * v], uvs[2 * v + 1]);
        if (options_.flip_v) uv.y() = 1.0F - uv.y();
        mesh.uvs.push_back(uv_transform.apply(uv));
        mesh.normals.push_back(normals.empty() ? Vec3f(Vec3f::Zero())
                                               : unit(for_normals * vec3(normals, 3 * v)));
        mesh.tangents.push_back(own_tangents ? tangent(tangents, v, linear, mirrored)
                                             : Vec4f(Vec4f::Zero()));
      }
    }
  }

  /// glTF: without normals in the file its tangents do not count. Zeros would show differently in
  /// every program, so one of them makes the part's tangents computed ones.
  bool keeps_tangents(const std::vector<std::uint32_t>& corners, const std::vector<float>& normals,
                      const std::vector<float>& tangents, const Eigen::Matrix3d& linear) {
    if (tangents.empty()) return false;
    const bool usable = !options_.flip_v && !normals.empty() &&
                        std::none_of(corners.begin(), corners.end(), [&](std::uint32_t v) {
                          return unit(linear * vec3(tangents, 4 * v)).isZero();
                        });
    if (!usable) replaced_tangents_.insert(primitive_);
    return usable;
  }

  /// The frame of these triangles' object-space normals; its size does not matter.
  void add_node(const Eigen::Matrix3d& for_normals, std::size_t triangles) {
    Mesh& mesh = model_.mesh;
    const double size = for_normals.cwiseAbs().maxCoeff();
    const bool usable = size > 0.0 && std::isfinite(size);
    mesh.nodes.insert(mesh.nodes.end(), triangles,
                      static_cast<std::uint32_t>(mesh.node_normals.size()));
    mesh.node_normals.push_back(usable ? Mat3f((for_normals / size).cast<float>())
                                       : Mat3f(Mat3f::Identity()));
  }

  static Eigen::Vector3d vec3(const std::vector<float>& values, std::size_t at) {
    return {static_cast<double>(values[at]), static_cast<double>(values[at + 1]),
            static_cast<double>(values[at + 2])};
  }
  static Vec3f unit(const Eigen::Vector3d& v) {
    const double length = v.norm();
    if (!(length > 1e-30) || !std::isfinite(length)) return Vec3f::Zero();
    return (v / length).cast<float>();
  }
  static Vec4f tangent(const std::vector<float>& values, std::uint32_t v,
                       const Eigen::Matrix3d& linear, bool mirrored) {
    const Vec3f t = unit(linear * vec3(values, 4 * v));
    const float w = values[4 * v + 3] < 0.0F ? -1.0F : 1.0F;
    return {t.x(), t.y(), t.z(), mirrored ? -w : w};
  }

  void finish_normals() {
    if (!model_.has_normals) note("vertex normals are computed where the file has none");
    fill_normals(model_.mesh);
  }

  void finish_tangents() {
    if (!replaced_tangents_.empty()) {
      note(options_.flip_v ? "the file's tangents are replaced, as V is flipped"
                           : "the file's tangents are replaced where some are zero or its normals "
                             "are missing");
    }
    Mesh& mesh = model_.mesh;
    model_.some_tangents = some_tangents_;
    model_.has_tangents = some_tangents_ && !some_without_tangents_;
    if (model_.has_tangents) return;
    std::vector<Vec4f> own = std::move(mesh.tangents);
    mesh.tangents.clear();
    if (!some_tangents_) return;
    note("tangents are computed (MikkTSpace) for the parts without");
    compute_tangents(mesh);
    for (std::size_t i = 0; i < own.size(); ++i) {
      if (!own[i].isZero()) mesh.tangents[i] = own[i];
    }
  }

  const File& file_;
  const ModelReadOptions& options_;
  Model& model_;
  MaterialTable materials_;
  const Json& nodes_;
  const Json& meshes_;
  std::size_t skipped_no_uv_ = 0;
  PrimitiveIndex primitive_;  ///< that is being read
  std::set<PrimitiveIndex> replaced_tangents_;
  bool some_tangents_ = false;
  bool some_without_tangents_ = false;
};

}  // namespace

Model parse_gltf(std::span<const std::byte> bytes, const std::filesystem::path& path,
                 const ModelReadOptions& options) {
  File file = gltf::parse(bytes, path, *options.files);
  Model model;
  model.path = path;
  Reader reader(file, options, model);
  reader.read();
  auto source = std::make_shared<ModelSource>();
  source->format = file.binary ? ModelFormat::Glb : ModelFormat::Gltf;
  source->folder = file.folder;
  source->files = options.files;
  source->text = std::move(file.text);
  source->buffers = std::move(file.buffers);
  source->flip_v = options.flip_v;
  source->replaced_tangents = reader.replaced_tangents();
  model.source = std::move(source);
  return model;
}

}  // namespace normalshop
