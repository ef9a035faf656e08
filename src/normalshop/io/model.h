#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "normalshop/core/vec.h"
#include "normalshop/io/file_source.h"
#include "normalshop/surface/mesh.h"

/// Model files: glTF 2.0 (.gltf, .glb) and Wavefront OBJ with MTL.
namespace normalshop {

/// An image that a material names. Exactly one of `path` and `bytes` is filled.
struct MapSource {
  std::string name;              ///< for messages
  std::filesystem::path path;    ///< file beside the model; it may be missing
  std::vector<std::byte> bytes;  ///< image embedded in the model file
};

/// Triangles that share one atlas: all materials with the same normal image and scale (or, where
/// none has one, the same colour image) and the same UVs. Its index is Mesh::texture_sets' value.
struct TextureSet {
  std::string name;        ///< safe as a file name, different from the others'
  int tile = 0;            ///< UDIM tile (1001 and on) that it is; 0: none
  std::string tiled_name;  ///< of a tile: that of the set that it is a tile of
  std::optional<MapSource> normal_map;
  float normal_scale = 1.0F;  ///< glTF: multiplies x and y of the normals
  std::optional<MapSource> albedo;
  Vec3f albedo_factor = Vec3f::Ones();  ///< linear RGB, multiplies the albedo
  std::vector<int> materials;           ///< of the file; -1 stands for "no material"
  std::vector<int> albedo_materials;    ///< those of them that show `albedo`
};

struct ModelSource;

struct Model {
  Mesh mesh;  ///< corners in the order of the file's faces; `tangents` as below
  std::vector<TextureSet> texture_sets;
  std::vector<std::string> notes;  ///< sentences: what was guessed or ignored
  std::filesystem::path path;
  bool has_normals = true;    ///< in the file for all faces; else computed where missing
  bool has_tangents = false;  ///< in the file for all faces
  /// In the file for some faces; the others' are computed. Without any, mesh.tangents is empty.
  bool some_tangents = false;
  /// The file's own content, for writing it back.
  std::shared_ptr<const ModelSource> source;
};

struct ModelReadOptions {
  /// The file's V runs the other way than its format says: v becomes 1 - v.
  bool flip_v = false;
  /// Faces without texture coordinates are kept, with all theirs at one point, instead of left out.
  bool keep_without_uvs = false;
  /// A file with more is refused.
  std::size_t max_triangles = std::size_t{1} << 27;
  /// Holds the model, and what that refers to.
  std::shared_ptr<const FileSource> files = disk_files();
};

/// Does the extension tell a model: .gltf, .glb or .obj?
bool is_model_file(const std::filesystem::path& path);

/// By extension: .gltf, .glb, .obj. Throws IoError (missing, unreadable) or InvalidInput (not what
/// it says, damaged, or needing something that is not supported).
Model read_model(const std::filesystem::path& path, const ModelReadOptions& options = {});

/// From memory. `path` stands for the file in messages; files that it refers to are looked for in
/// its folder.
Model parse_gltf(std::span<const std::byte> bytes, const std::filesystem::path& path,
                 const ModelReadOptions& options = {});
Model parse_obj(std::span<const std::byte> bytes, const std::filesystem::path& path,
                const ModelReadOptions& options = {});

/// A texture set's new maps, as the written model refers to them: paths relative to it, "/" between
/// folders. Where one is empty the model keeps what it has.
struct MapReferences {
  std::string normal;
  bool scale_applied = false;  ///< the normal map holds normal_scale already: the model's becomes 1
  std::string color = {};      ///< for the set's albedo_materials
};

struct WrittenModel {
  std::vector<std::filesystem::path> files;  ///< everything that was written, the model first
  std::vector<std::string> notes;
};

/// Writes the model with new maps. Everything else stays as the file has it: nodes, meshes,
/// vertex order, faces, materials, extras; only tangents go that were not used. Buffers, materials
/// and textures that the model refers to are copied beside it, except over files in `maps`, which
/// the caller writes. A model read with flip_v is written with v flipped in its UVs, so that it
/// shows right elsewhere; its maps are not flipped. The extension must be the source's. Throws
/// InvalidInput or IoError.
WrittenModel write_model(const Model& model, const std::filesystem::path& path,
                         const std::map<std::size_t, MapReferences>& maps);

}  // namespace normalshop
