#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <map>
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
            const std::map<std::size_t, MapReferences>& maps)
      : model_(model), source_(*model.source), path_(path), companions_(source_, path, maps) {
    for (const auto& [set, references] : maps) {
      const TextureSet& textures = model.texture_sets[set];
      for (const int material : textures.materials) {
        if (material < 0) unnamed_ = unused_name(textures.name);
        const auto& colored = textures.albedo_materials;
        MapReferences own = references;
        if (std::find(colored.begin(), colored.end(), material) == colored.end()) own.color = "";
        maps_of_[material < 0 ? unnamed_
                              : source_.material_names[static_cast<std::size_t>(material)]] =
            std::move(own);
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
  /// For the faces without a material.
  std::string unused_name(const std::string& wanted) const {
    const auto& used = source_.material_names;
    std::string name = wanted;
    for (int i = 2; source_.defined_materials.contains(name) ||
                    std::find(used.begin(), used.end(), name) != used.end();
         ++i) {
      name = wanted + "_" + std::to_string(i);
    }
    return name;
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
    for_each_obj_line(source_.text, [&](std::size_t, std::string_view line, std::string_view raw) {
      const std::string_view key = next_word(line);
      if (key == "mtllib") return insert_library();
      if (key == "usemtl") in_material = !trimmed(line).empty();
      if (key == "f" && !in_material && !unnamed_.empty()) {
        out += "usemtl " + unnamed_ + "\n";
        in_material = true;
      }
      if (key != "vt" || !source_.flip_v) {
        out += raw;
        return;
      }
      out += flipped(raw);
    });
    return out;
  }

  /// The statement with spaces for what are no words: comments, "\" and the ends of its lines.
  static std::string words_alone(std::string_view raw) {
    std::string words(raw);
    for (std::size_t at = 0; at < words.size();) {
      const std::size_t end = std::min(words.find('\n', at), words.size());
      const std::size_t comment = std::min(words.find('#', at), end);
      std::fill(words.begin() + static_cast<std::ptrdiff_t>(comment),
                words.begin() + static_cast<std::ptrdiff_t>(end), ' ');
      const std::size_t last = words.find_last_not_of(" \t\r\f\v", end == 0 ? 0 : end - 1);
      if (last != std::string::npos && last >= at && words[last] == '\\') words[last] = ' ';
      if (end < words.size()) words[end] = ' ';
      at = end + 1;
    }
    return words;
  }

  /// "vt u v" with 1 - v, the shortest digits that give the same float; all else as it is.
  static std::string flipped(std::string_view raw) {
    const std::string words = words_alone(raw);
    std::string_view rest = words;
    next_word(rest);
    const std::string_view u = next_word(rest);
    const std::string_view word = next_word(rest);
    std::string_view number = word;
    if (number.starts_with('+')) number.remove_prefix(1);
    float v = 0.0F;
    std::from_chars(number.data(), number.data() + number.size(), v);
    std::array<char, 32> digits{};
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), 1.0F - v).ptr;
    const std::string text(digits.data(), end);
    std::string out(raw);
    if (!word.empty()) {
      return out.replace(static_cast<std::size_t>(word.data() - words.data()), word.size(), text);
    }
    return out.insert(static_cast<std::size_t>(u.data() + u.size() - words.data()), " " + text);
  }

  /// All libraries in one, the maps of the edited materials replaced.
  std::string library_text() {
    std::string out;
    std::set<std::string> written;
    for (const std::string& name : obj_libraries(source_)) {
      std::string text;
      try {
        text = source_.files->read(source_.folder / name);
      } catch (const IoError& error) {
        companions_.result.notes.push_back(error.what());
        continue;
      }
      const auto renamed = copy_textures(text, fs::path(name).parent_path());
      if (!out.empty() && out.back() != '\n') out += '\n';
      append_library(text, renamed, out, written);
    }
    if (!out.empty() && out.back() != '\n') out += '\n';
    for (const auto& [name, references] : maps_of_) {
      if (written.contains(name)) continue;
      out += "newmtl ";
      out += name;
      out += "\nKd 0.8 0.8 0.8\n";
      append_maps(references, out);
    }
    return out;
  }

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

  static void append_maps(const MapReferences& references, std::string& out) {
    if (!references.normal.empty()) out += "norm " + references.normal + "\n";
    if (!references.color.empty()) out += "map_Kd " + references.color + "\n";
  }

  using Renamed = std::map<std::string, std::string>;

  void append_library(const std::string& text, const Renamed& renamed, std::string& out,
                      std::set<std::string>& written) {
    std::string material;
    const auto finish = [&] {
      const auto maps = maps_of_.find(material);
      if (maps == maps_of_.end() || !written.insert(material).second) return;
      if (!out.empty() && out.back() != '\n') out += '\n';
      append_maps(maps->second, out);
    };
    for_each_raw_line(text, [&](std::string_view line) {
      std::string_view rest = line;
      const std::string_view key = next_word(rest);
      if (key == "newmtl") {
        finish();
        material = std::string(trimmed(rest.substr(0, rest.find_first_of("\r\n"))));
      }
      if (replaces(material, key)) return;
      out += is_texture(key) ? with_new_name(line, renamed) : std::string(line);
    });
    finish();
  }

  /// Does one of the new maps take this line's place?
  bool replaces(const std::string& material, std::string_view key) const {
    const auto maps = maps_of_.find(material);
    if (maps == maps_of_.end()) return false;
    if (key == "map_Kd") return !maps->second.color.empty();
    if (maps->second.normal.empty()) return false;
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

  static bool is_texture(std::string_view key) {
    return key.starts_with("map_") || key == "bump" || key == "norm" || key == "disp" ||
           key == "refl" || key == "decal";
  }

  /// A texture's name is the end of its line, behind the options.
  static std::string with_new_name(std::string_view line, const Renamed& renamed) {
    const std::size_t end = line.find_last_not_of(" \t\r\n\f\v") + 1;
    const std::pair<const std::string, std::string>* found = nullptr;
    for (const auto& entry : renamed) {
      const std::string& old = entry.first;
      const bool fits = line.substr(0, end).ends_with(old) && end > old.size() &&
                        std::isspace(static_cast<unsigned char>(line[end - old.size() - 1])) != 0;
      if (fits && (found == nullptr || old.size() > found->first.size())) found = &entry;
    }
    std::string out(line);
    if (found != nullptr) {
      out.replace(end - found->first.size(), found->first.size(), found->second);
    }
    return out;
  }

  /// Copies a library's textures. Returns those that the written library must name otherwise.
  Renamed copy_textures(const std::string& text, const fs::path& folder) {
    std::istringstream stream(text);
    std::map<std::string, int> by_name;
    std::vector<tinyobj::material_t> list;
    std::string warning;
    std::string error;
    tinyobj::LoadMtl(&by_name, &list, &stream, &warning, &error);
    Renamed renamed;
    for (const auto& m : list) {
      for (const std::string* name :
           {&m.ambient_texname, &m.diffuse_texname, &m.specular_texname,
            &m.specular_highlight_texname, &m.bump_texname, &m.displacement_texname,
            &m.alpha_texname, &m.reflection_texname, &m.roughness_texname, &m.metallic_texname,
            &m.sheen_texname, &m.emissive_texname, &m.normal_texname}) {
        const std::string old(trimmed(*name));
        if (old.empty()) continue;
        const fs::path path = obj_path(old);
        std::string placed = companions_.copy((folder / path).lexically_normal().generic_string());
        if (placed != path.lexically_normal().generic_string()) {
          renamed[old] = std::move(placed);
        }
      }
    }
    return renamed;
  }

  const Model& model_;
  const ModelSource& source_;
  const fs::path& path_;
  Companions companions_;
  std::map<std::string, MapReferences> maps_of_;  ///< by material name
  std::string unnamed_;                           ///< name for faces without material
};

}  // namespace

WrittenModel write_obj(const Model& model, const fs::path& path,
                       const std::map<std::size_t, MapReferences>& maps) {
  return ObjWriter(model, path, maps).write();
}

}  // namespace normalshop
