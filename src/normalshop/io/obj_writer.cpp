#include <charconv>
#include <set>
#include <sstream>

#include <tiny_obj_loader.h>

#include "normalshop/core/error.h"
#include "normalshop/io/atomic_file.h"
#include "normalshop/io/detail/model_source.h"
#include "normalshop/io/detail/obj_text.h"

namespace normalshop {

namespace fs = std::filesystem;

namespace {

class ObjWriter {
 public:
  ObjWriter(const Model& model, const fs::path& path,
            const std::map<std::size_t, NormalMapReference>& normal_maps)
      : model_(model),
        source_(*model.source),
        path_(path),
        companions_(source_, path, normal_maps) {
    for (const auto& [set, reference] : normal_maps) {
      for (const int material : model.texture_sets[set].materials) {
        const std::string name = material < 0
                                     ? model.texture_sets[set].name
                                     : source_.material_names[static_cast<std::size_t>(material)];
        normal_of_[name] = reference.file;
        if (material < 0) unnamed_ = name;
      }
    }
  }

  WrittenModel write() {
    const std::string library = path_.stem().string() + ".mtl";
    const std::string materials = library_text();
    write_file(path_, model_text(library));
    write_file(path_.parent_path() / library, materials);
    auto& files = companions_.result.files;
    files.insert(files.begin(), {path_, path_.parent_path() / library});
    if (source_.flip_v) {
      companions_.result.notes.push_back("V of all texture coordinates is flipped in '" +
                                         path_.filename().string() +
                                         "', as it was on reading; the maps are not flipped");
    }
    return std::move(companions_.result);
  }

 private:
  /// Lines with their ends, so that they can be copied byte by byte.
  template <class Visitor>
  static void for_each_raw_line(std::string_view text, Visitor&& visit) {
    while (!text.empty()) {
      const std::size_t end = text.find('\n');
      const std::size_t size = end == text.npos ? text.size() : end + 1;
      visit(text.substr(0, size));
      text.remove_prefix(size);
    }
  }

  std::string model_text(const std::string& library) const {
    std::string out;
    out.reserve(source_.text.size() + 256);
    bool named_library = false;
    bool in_material = false;
    const auto insert_library = [&] {
      if (!named_library) out += "mtllib " + library + "\n";
      named_library = true;
    };
    if (source_.libraries.empty()) insert_library();
    for_each_raw_line(source_.text, [&](std::string_view line) {
      std::string_view rest = line;
      const std::string_view key = next_word(rest);
      if (key == "mtllib") return insert_library();
      if (key == "usemtl") in_material = true;
      if (key == "f" && !in_material && !unnamed_.empty()) {
        out += "usemtl " + unnamed_ + "\n";
        in_material = true;
      }
      if (key == "vt" && source_.flip_v) {
        out += flipped(rest);
        return;
      }
      out += line;
    });
    return out;
  }

  /// "vt u v" with 1 - v; the shortest digits that give the same float.
  static std::string flipped(std::string_view rest) {
    const std::string_view end_of_line = rest.ends_with("\r\n") ? "\r\n" : "\n";
    rest = trimmed(rest.substr(0, std::min(rest.find('#'), rest.find('\n'))));
    const std::string u(next_word(rest));
    std::string_view word = next_word(rest);
    if (word.starts_with('+')) word.remove_prefix(1);
    float v = 0.0F;
    std::from_chars(word.data(), word.data() + word.size(), v);
    std::array<char, 32> digits{};
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), 1.0F - v).ptr;
    return "vt " + u + " " + std::string(digits.data(), end) + std::string(end_of_line);
  }

  /// All libraries in one, `norm` of the edited materials replaced.
  std::string library_text() {
    std::string out;
    std::set<std::string> written;
    for (const std::string& name : obj_libraries(source_)) {
      std::string text;
      try {
        text = read_file(source_.folder / name);
      } catch (const IoError& error) {
        companions_.result.notes.push_back(error.what());
        continue;
      }
      copy_textures(text, fs::path(name).parent_path());
      if (!out.empty() && out.back() != '\n') out += '\n';
      append_library(text, out, written);
    }
    if (!out.empty() && out.back() != '\n') out += '\n';
    for (const auto& [name, file] : normal_of_) {
      if (written.contains(name)) continue;
      out += "newmtl ";
      out += name;
      out += "\nKd 0.8 0.8 0.8\nnorm ";
      out += file;
      out += '\n';
    }
    return out;
  }

  void append_library(const std::string& text, std::string& out, std::set<std::string>& written) {
    std::string material;
    const auto finish = [&] {
      const auto normal = normal_of_.find(material);
      if (normal == normal_of_.end() || !written.insert(material).second) return;
      if (!out.empty() && out.back() != '\n') out += '\n';
      out += "norm " + normal->second + "\n";
    };
    for_each_raw_line(text, [&](std::string_view line) {
      std::string_view rest = line;
      const std::string_view key = next_word(rest);
      if (key == "newmtl") {
        finish();
        material = std::string(trimmed(rest.substr(0, rest.find_first_of("\r\n"))));
      }
      if (normal_of_.contains(material) && replaces(material, key)) return;
      out += line;
    });
    finish();
  }

  bool replaces(const std::string& material, std::string_view key) const {
    if (key == "norm") return true;
    if (key != "bump" && key != "map_bump" && key != "map_Bump") return false;
    // A height map stays; a bump map that was read as normal map goes.
    for (const TextureSet& set : model_.texture_sets) {
      for (const int index : set.materials) {
        if (index < 0 || source_.material_names[static_cast<std::size_t>(index)] != material) {
          continue;
        }
        return set.normal_map.has_value();
      }
    }
    return false;
  }

  void copy_textures(const std::string& text, const fs::path& folder) {
    std::istringstream stream(text);
    std::map<std::string, int> by_name;
    std::vector<tinyobj::material_t> list;
    std::string warning;
    std::string error;
    tinyobj::LoadMtl(&by_name, &list, &stream, &warning, &error);
    for (const auto& m : list) {
      for (const std::string* name :
           {&m.ambient_texname, &m.diffuse_texname, &m.specular_texname,
            &m.specular_highlight_texname, &m.bump_texname, &m.displacement_texname,
            &m.alpha_texname, &m.reflection_texname, &m.roughness_texname, &m.metallic_texname,
            &m.sheen_texname, &m.emissive_texname, &m.normal_texname}) {
        if (name->empty()) continue;
        const std::string reference =
            (folder / obj_path(*name)).lexically_normal().generic_string();
        if (companions_.copy(reference) != obj_path(*name)) {
          companions_.result.notes.push_back("'" + *name + "' lies beside the model now; the " +
                                             "material still names its old place");
        }
      }
    }
  }

  const Model& model_;
  const ModelSource& source_;
  const fs::path& path_;
  Companions companions_;
  std::map<std::string, std::string> normal_of_;  ///< by material name
  std::string unnamed_;                           ///< name for faces without material
};

}  // namespace

WrittenModel write_obj(const Model& model, const fs::path& path,
                       const std::map<std::size_t, NormalMapReference>& normal_maps) {
  return ObjWriter(model, path, normal_maps).write();
}

}  // namespace normalshop
