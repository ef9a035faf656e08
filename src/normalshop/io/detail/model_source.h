#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "normalshop/io/model.h"

/// Inside the io floor: what readers and writers of models share.
namespace normalshop {

enum class ModelFormat { Gltf, Glb, Obj };

/// Mesh and place in its list.
using PrimitiveIndex = std::pair<std::size_t, std::size_t>;

/// A model file's content as it was read.
struct ModelSource {
  ModelFormat format = ModelFormat::Gltf;
  std::filesystem::path folder;
  std::shared_ptr<const FileSource> files;     ///< that it came from
  std::string text;                            ///< glTF: its JSON; OBJ: the whole file
  std::vector<std::string> buffers;            ///< glTF: bytes of each buffer
  bool flip_v = false;                         ///< read with flipped v
  std::set<PrimitiveIndex> replaced_tangents;  ///< glTF: their TANGENT does not count
  std::vector<std::string> material_names;     ///< OBJ: by material index
  std::set<std::string> defined_materials;     ///< OBJ: names in its .mtl files
  std::vector<std::string> libraries;          ///< OBJ: its .mtl files, as the file names them
};

/// Unique, non-empty, ASCII letters, digits, "-", "_" and "." only, not starting with ".".
std::string file_safe_name(const std::string& wanted, const std::vector<TextureSet>& others);

/// Says once that not all materials of a texture set have the colours that it shows.
void note_other_colors(const std::string& set, std::vector<std::string>& notes);

/// Fills normals of corners that have none (zero vectors) from the faces.
void fill_normals(Mesh& mesh);

/// Copies files of the source's folder beside the written model.
class Companions {
 public:
  Companions(const ModelSource& source, const std::filesystem::path& model_path,
             const std::map<std::size_t, MapReferences>& maps);
  /// Copies `reference` (a path relative to the source's folder) and returns how the written model
  /// refers to it: the same, or its bare file name (numbered where another file has it) where it
  /// leads out of the folder.
  std::string copy(const std::string& reference);
  /// Writes bytes under that name, or a numbered one, instead of copying.
  std::string write(const std::string& reference, std::string_view bytes);

  WrittenModel result;

 private:
  std::string place(const std::string& reference) const;
  std::string copy_tiles(const std::string& reference);
  std::string unused(const std::string& wanted) const;
  bool reserved(const std::filesystem::path& target) const;
  void put(const std::string& name, std::string_view bytes);

  std::filesystem::path source_folder_;
  std::shared_ptr<const FileSource> files_;
  std::filesystem::path folder_;
  std::vector<std::filesystem::path> reserved_;
  std::map<std::string, std::string> done_;  ///< by source path
  std::set<std::string> taken_;              ///< names of companions
};

WrittenModel write_gltf(const Model& model, const std::filesystem::path& path,
                        const std::map<std::size_t, MapReferences>& maps);
WrittenModel write_obj(const Model& model, const std::filesystem::path& path,
                       const std::map<std::size_t, MapReferences>& maps);

}  // namespace normalshop
