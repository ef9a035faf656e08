#include "normalshop/io/model.h"

#include <algorithm>
#include <cctype>

#include <Eigen/Geometry>

#include "normalshop/core/error.h"
#include "normalshop/io/detail/extension.h"
#include "normalshop/io/detail/model_source.h"
#include "normalshop/surface/vertex_normals.h"

namespace normalshop {

namespace {

namespace fs = std::filesystem;

}  // namespace

std::string file_safe_name(const std::string& wanted, const std::vector<TextureSet>& others) {
  std::string name;
  for (const char c : wanted.substr(0, 80)) {
    const auto byte = static_cast<unsigned char>(c);
    const bool safe = byte < 128 && (std::isalnum(byte) || c == '-' || c == '_' || c == '.');
    name += safe ? c : '_';
  }
  if (name.empty() || name.front() == '.') name.insert(0, "set");
  // Names that differ by case alone are one file on some systems.
  const auto taken = [&](const std::string& candidate) {
    return std::any_of(others.begin(), others.end(), [&](const TextureSet& other) {
      return lower_case(other.name) == lower_case(candidate);
    });
  };
  std::string unique = name;
  for (int i = 2; taken(unique); ++i) unique = name + "_" + std::to_string(i);
  return unique;
}

void fill_normals(Mesh& mesh) {
  const auto missing = [](const Vec3f& n) { return n.isZero(); };
  if (std::none_of(mesh.normals.begin(), mesh.normals.end(), missing)) return;
  std::vector<Vec3f> given = std::move(mesh.normals);
  compute_normals(mesh);
  for (std::size_t i = 0; i < given.size(); ++i) {
    if (!missing(given[i])) mesh.normals[i] = given[i];
  }
}

bool is_model_file(const fs::path& path) {
  const std::string extension = extension_of(path);
  return extension == ".gltf" || extension == ".glb" || extension == ".obj";
}

void note_other_colors(const std::string& set, std::vector<std::string>& notes) {
  std::string sentence = "the materials of the texture set '" + set +
                         "' have different colours: those of the first are shown, and edits move "
                         "no others";
  if (std::find(notes.begin(), notes.end(), sentence) == notes.end()) {
    notes.push_back(std::move(sentence));
  }
}

Model read_model(const fs::path& path, const ModelReadOptions& options) {
  const std::string extension = extension_of(path);
  if (!is_model_file(path)) {
    throw InvalidInput("'" + path.string() + "' is no model of a known kind; accepted are .gltf, " +
                       ".glb and .obj");
  }
  const std::string text = options.files->read(path);
  const auto bytes = std::as_bytes(std::span(text));
  return extension == ".obj" ? parse_obj(bytes, path, options) : parse_gltf(bytes, path, options);
}

WrittenModel write_model(const Model& model, const fs::path& path,
                         const std::map<std::size_t, MapReferences>& maps) {
  if (!model.source) throw InvalidInput("'" + path.string() + "': the model came from no file");
  const ModelFormat format = model.source->format;
  const std::string wanted = format == ModelFormat::Obj   ? ".obj"
                             : format == ModelFormat::Glb ? ".glb"
                                                          : ".gltf";
  if (extension_of(path) != wanted) {
    throw InvalidInput("cannot write '" + path.string() + "': the model is written back as " +
                       wanted + ", the format it came in");
  }
  for (const auto& [set, reference] : maps) {
    if (set >= model.texture_sets.size() || (reference.normal.empty() && reference.color.empty())) {
      throw InvalidInput("cannot write '" + path.string() + "': there is no texture set " +
                         std::to_string(set) + " with a map of that name");
    }
  }
  return format == ModelFormat::Obj ? write_obj(model, path, maps) : write_gltf(model, path, maps);
}

}  // namespace normalshop
