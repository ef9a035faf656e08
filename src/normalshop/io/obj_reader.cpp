#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <sstream>

#include <tiny_obj_loader.h>

#include "normalshop/core/error.h"
#include "normalshop/io/conventions.h"
#include "normalshop/io/detail/model_source.h"
#include "normalshop/io/detail/obj_text.h"
#include "normalshop/io/detail/polygon.h"
#include "normalshop/io/image_file.h"
#include "normalshop/io/udim.h"

namespace normalshop {

namespace {

/// tinyobjloader reads the materials. Vertices and faces are read here: its 2.0 release counts a
/// face's corners in 8 bits, passes indices beyond the lists on, and makes lists as long as a
/// subdivision tag asks for.
class ObjReader {
 public:
  ObjReader(std::string_view text, const ModelReadOptions& options, Model& model,
            ModelSource& source)
      : text_(text), options_(options), model_(model), source_(source) {}

  void read() {
    for_each_obj_line(text_, [&](std::size_t number, std::string_view line, std::string_view) {
      line_ = number;
      read_line(line);
    });
    if (model_.mesh.triangles.empty() && skipped_ > 0) {
      fail_file("the model has no texture coordinates; \"normalshop unwrap\" writes it with some");
    }
    if (model_.mesh.triangles.empty()) fail_file("the model has no faces");
    if (skipped_ > 0) {
      model_.notes.push_back(std::to_string(skipped_) +
                             " faces without texture coordinates are left out");
    }
    if (ignored_) model_.notes.push_back("points, lines, curves and patches are left out");
    if (!model_.has_normals) {
      model_.notes.push_back("vertex normals are computed where the file has none");
    }
    fill_normals(model_.mesh);
    read_libraries();
    cut_comments();
    merge_sets();
  }

 private:
  struct Corner {
    std::size_t position;
    std::size_t uv;
    std::size_t normal;  ///< none: npos
  };
  static constexpr std::size_t none = static_cast<std::size_t>(-1);

  [[noreturn]] void fail_file(const std::string& what) const {
    throw InvalidInput("'" + model_.path.string() + "': " + what);
  }
  [[noreturn]] void fail(const std::string& what) const {
    fail_file("line " + std::to_string(line_) + ": " + what);
  }

  void read_line(std::string_view line) {
    const std::string_view key = next_word(line);
    if (key == "v") {
      const auto p = numbers<3>(line, "v needs three numbers");
      if (!(std::max({std::abs(p[0]), std::abs(p[1]), std::abs(p[2])}) < 1e18F)) {
        fail("a position must be finite and below 1e18");
      }
      model_.mesh.positions.emplace_back(p[0], p[1], p[2]);
    } else if (key == "vt") {
      const auto uv = texture_coordinate(line);
      // v runs up in OBJ; the mesh has it down.
      uvs_.emplace_back(uv[0], options_.flip_v ? uv[1] : 1.0F - uv[1]);
    } else if (key == "vn") {
      const auto n = numbers<3>(line, "vn needs three numbers");
      const Vec3f normal(n[0], n[1], n[2]);
      const float length = normal.stableNorm();
      normals_.push_back(length > 1e-30F && std::isfinite(length) ? Vec3f(normal / length)
                                                                  : Vec3f(Vec3f::Zero()));
    } else if (key == "f" || key == "fo") {
      read_face(line);
    } else if (key == "usemtl") {
      use_material(std::string(trimmed(line)));
    } else if (key == "mtllib") {
      source_.libraries.emplace_back(trimmed(line));
    } else if (key == "l" || key == "p" || key == "curv" || key == "curv2" || key == "surf") {
      ignored_ = true;
    }
  }

  float number(std::string_view word) const {
    float value = 0.0F;
    if (!word.empty() && word.front() == '+') word.remove_prefix(1);
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    // Too small for float becomes 0; too large becomes infinite, which the caller refuses.
    if (error == std::errc::result_out_of_range) {
      return static_cast<float>(std::strtod(std::string(word).c_str(), nullptr));
    }
    if (error != std::errc() || end != word.data() + word.size()) {
      fail("'" + std::string(word.substr(0, 40)) + "' is no number");
    }
    return value;
  }

  template <std::size_t N>
  std::array<float, N> numbers(std::string_view line, const char* message) const {
    std::array<float, N> values{};
    for (float& value : values) {
      const std::string_view word = next_word(line);
      if (word.empty()) fail(message);
      value = number(word);
      if (!std::isfinite(value)) fail("a number must be finite");
    }
    return values;
  }

  /// "vt u" alone has v = 0.
  std::array<float, 2> texture_coordinate(std::string_view line) const {
    std::array<float, 2> uv{number(next_word(line)), 0.0F};
    const std::string_view second = next_word(line);
    if (!second.empty()) uv[1] = number(second);
    if (!(std::abs(uv[0]) < 1e6F && std::abs(uv[1]) < 1e6F)) {
      fail("a texture coordinate must be finite and below 1e6");
    }
    return uv;
  }

  /// 1-based, or negative from the end, as an index into a list of `size`.
  std::size_t resolve(std::string_view word, std::size_t size, const char* what) const {
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    const auto count = static_cast<std::int64_t>(size);
    const bool parsed = error == std::errc() && end == word.data() + word.size();
    if (parsed && value >= 1 && value <= count) return static_cast<std::size_t>(value - 1);
    if (parsed && value < 0 && value >= -count) return static_cast<std::size_t>(count + value);
    fail("the face names " + std::string(what) + " " + std::string(word.substr(0, 40)) +
         ", but there are " + std::to_string(size) + " so far");
  }

  Corner corner(std::string_view word) const {
    const std::size_t first = word.find('/');
    const std::string_view position = word.substr(0, first);
    std::string_view uv;
    std::string_view normal;
    if (first != word.npos) {
      const std::size_t second = word.find('/', first + 1);
      uv = word.substr(first + 1, second == word.npos ? word.npos : second - first - 1);
      if (second != word.npos) normal = word.substr(second + 1);
    }
    return {resolve(position, model_.mesh.positions.size(), "vertex"),
            uv.empty() ? none : resolve(uv, uvs_.size(), "texture coordinate"),
            normal.empty() ? none : resolve(normal, normals_.size(), "normal")};
  }

  void read_face(std::string_view line) {
    corners_.clear();
    for (std::string_view word = next_word(line); !word.empty(); word = next_word(line)) {
      corners_.push_back(corner(word));
    }
    if (corners_.size() < 3) fail("a face needs at least three corners");
    if (!options_.keep_without_uvs && std::any_of(corners_.begin(), corners_.end(),
                                                  [](const Corner& c) { return c.uv == none; })) {
      ++skipped_;
      return;
    }
    face_positions_.clear();
    face_uvs_.clear();
    for (const Corner& c : corners_) {
      face_positions_.push_back(model_.mesh.positions[c.position]);
      face_uvs_.push_back(uv_of(c));
    }
    if (model_.mesh.triangles.size() + corners_.size() > options_.max_triangles) {
      fail("the model has more than " + std::to_string(options_.max_triangles) + " triangles");
    }
    if (current_ == none) use_material("");
    for (const auto& triangle : triangulate(face_positions_, face_uvs_)) append(triangle);
  }

  Vec2f uv_of(const Corner& c) const { return c.uv == none ? Vec2f(Vec2f::Zero()) : uvs_[c.uv]; }

  void append(const std::array<int, 3>& triangle) {
    Mesh& mesh = model_.mesh;
    Vec3u indices;
    for (int k = 0; k < 3; ++k) {
      const Corner& c = corners_[static_cast<std::size_t>(triangle[static_cast<std::size_t>(k)])];
      indices[k] = static_cast<std::uint32_t>(c.position);
      mesh.uvs.push_back(uv_of(c));
      if (c.normal == none) model_.has_normals = false;
      mesh.normals.push_back(c.normal == none ? Vec3f(Vec3f::Zero()) : normals_[c.normal]);
    }
    mesh.triangles.push_back(indices);
    mesh.texture_sets.push_back(static_cast<std::uint32_t>(current_));
  }

  /// Until the materials are known, each has its own texture set. "" stands for none.
  void use_material(const std::string& name) {
    auto& names = source_.material_names;
    const auto known = std::find(names.begin(), names.end(), name);
    current_ = static_cast<std::size_t>(known - names.begin());
    if (known == names.end()) names.push_back(name);
  }

  void read_libraries() {
    for (const std::string& name : obj_libraries(source_)) {
      try {
        std::istringstream stream(source_.files->read(source_.folder / name));
        std::map<std::string, int> by_name;
        std::string warning;
        std::string error;
        std::vector<tinyobj::material_t> list;
        tinyobj::LoadMtl(&by_name, &list, &stream, &warning, &error);
        for (auto& material : list) {
          material.name = std::string(trimmed(material.name));
          source_.defined_materials.insert(material.name);
          materials_.emplace_back(std::move(material), name);
        }
      } catch (const IoError& error) {
        model_.notes.push_back(std::string(error.what()) + "; its materials are left out");
      }
    }
  }

  /// "usemtl skin # 2" names "skin" where the libraries have that alone.
  void cut_comments() {
    for (std::string& name : source_.material_names) {
      if (source_.defined_materials.contains(name)) continue;
      const std::string cut(trimmed(std::string_view(name).substr(0, name.find('#'))));
      if (source_.defined_materials.contains(cut)) name = cut;
    }
  }

  std::optional<MapSource> map_source(const std::string& text, const std::string& library) const {
    const std::string name = obj_path(std::string(trimmed(text)));
    if (name.empty()) return std::nullopt;
    MapSource source;
    source.name = name;
    source.path = source_.folder / std::filesystem::path(obj_path(library)).parent_path() / name;
    return source;
  }

  /// `bump` names a height map or a normal map; only the latter is taken.
  std::optional<MapSource> bump_source(const tinyobj::material_t& material,
                                       const std::string& library) {
    auto source = map_source(material.bump_texname, library);
    if (!source) return std::nullopt;
    try {
      const std::filesystem::path seen =
          names_tiles(source->path)
              ? first_tile(source->path, *source_.files).value_or(source->path)
              : source->path;
      const std::string bytes = source_.files->read(seen);
      if (looks_like_normal_map(read_image(std::as_bytes(std::span(bytes)), seen.string()))) {
        model_.notes.push_back("the bump map '" + source->name + "' of the material '" +
                               material.name + "' holds normals and is taken as normal map");
        return source;
      }
      model_.notes.push_back("the bump map '" + source->name + "' of the material '" +
                             material.name + "' holds no normals and is left out");
    } catch (const Error& error) {
      model_.notes.push_back(std::string(error.what()) + "; it is left out");
    }
    return std::nullopt;
  }

  TextureSet set_of(int index, const std::string& name, std::string& key) {
    TextureSet set;
    set.materials = {name.empty() ? -1 : index};
    set.name = name.empty() ? model_.path.stem().string() : name;
    key = "m:" + name;
    for (const auto& [material, library] : materials_) {
      if (material.name != name || name.empty()) continue;
      set.albedo = map_source(material.diffuse_texname, library);
      set.normal_map = map_source(material.normal_texname, library);
      if (!set.normal_map) set.normal_map = bump_source(material, library);
      // With a colour image, exporters write any diffuse colour beside it.
      if (!set.albedo) {
        for (int c = 0; c < 3; ++c) set.albedo_factor[c] = material.diffuse[c];
      }
      if (!set.albedo_factor.allFinite()) set.albedo_factor = Vec3f::Ones();
      if (set.albedo) key = "a:" + set.albedo->path.string();
      if (set.normal_map) key = "n:" + set.normal_map->path.string();
      break;
    }
    return set;
  }

  void merge_sets() {
    std::vector<std::string> keys;
    std::vector<std::uint32_t> set_of_material(source_.material_names.size(), 0);
    std::vector<bool> used(source_.material_names.size(), false);
    for (const std::uint32_t material : model_.mesh.texture_sets) used[material] = true;
    for (std::size_t i = 0; i < used.size(); ++i) {
      if (!used[i]) continue;
      std::string key;
      TextureSet set = set_of(static_cast<int>(i), source_.material_names[i], key);
      const auto known = std::find(keys.begin(), keys.end(), key);
      set_of_material[i] = static_cast<std::uint32_t>(known - keys.begin());
      if (known != keys.end()) {
        TextureSet& other = model_.texture_sets[set_of_material[i]];
        other.materials.push_back(set.materials[0]);
        const bool same = set.albedo && other.albedo && set.albedo->path == other.albedo->path;
        if (same) other.albedo_materials.push_back(set.materials[0]);
        if (!same && (set.albedo || other.albedo)) note_other_colors(other.name, model_.notes);
        continue;
      }
      if (set.albedo) set.albedo_materials = set.materials;
      keys.push_back(key);
      set.name = file_safe_name(set.name, model_.texture_sets);
      model_.mesh.texture_set_names.push_back(set.name);
      model_.texture_sets.push_back(std::move(set));
    }
    for (std::uint32_t& set : model_.mesh.texture_sets) set = set_of_material[set];
  }

  std::string_view text_;
  const ModelReadOptions& options_;
  Model& model_;
  ModelSource& source_;
  std::vector<std::pair<tinyobj::material_t, std::string>> materials_;
  std::vector<Vec2f> uvs_;
  std::vector<Vec3f> normals_;
  std::vector<Corner> corners_;
  std::vector<Vec3f> face_positions_;
  std::vector<Vec2f> face_uvs_;
  std::size_t current_ = none;
  std::size_t line_ = 0;
  std::size_t skipped_ = 0;
  bool ignored_ = false;
};

}  // namespace

Model parse_obj(std::span<const std::byte> bytes, const std::filesystem::path& path,
                const ModelReadOptions& options) {
  auto source = std::make_shared<ModelSource>();
  source->format = ModelFormat::Obj;
  source->folder = path.parent_path();
  source->files = options.files;
  source->text.assign(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  source->flip_v = options.flip_v;
  Model model;
  model.path = path;
  ObjReader(source->text, options, model, *source).read();
  model.source = std::move(source);
  return model;
}

}  // namespace normalshop
