#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "normalshop/io/detail/gltf_file.h"
#include "normalshop/io/model.h"

/// Inside the io floor: which materials of a glTF file share an atlas.
namespace normalshop::gltf {

/// KHR_texture_transform: uv' = offset + rotation * (scale * uv).
struct UvTransform {
  std::array<double, 2> offset{0.0, 0.0};
  double rotation = 0.0;
  std::array<double, 2> scale{1.0, 1.0};

  Vec2f apply(const Vec2f& uv) const;
};

struct UvChoice {
  int set = 0;
  UvTransform transform;
};

/// Texture sets of the materials in the order in which they are asked for.
class MaterialTable {
 public:
  MaterialTable(const File& file, Model& model) : file_(file), model_(model) {}
  /// Which UVs the maps of a material have: -1 (none) or above.
  UvChoice uv_choice(int material) const { return textures_of(material).uv(); }
  /// Its texture set, made on the first call.
  std::size_t texture_set(int material);

 private:
  struct Texture {
    std::size_t image;
    UvChoice uv;
    float scale;
  };
  struct Textures {
    std::optional<Texture> normal;
    std::optional<Texture> albedo;
    UvChoice uv() const { return normal ? normal->uv : albedo ? albedo->uv : UvChoice{}; }
  };
  const Json& material_json(int material) const;
  Textures textures_of(int material) const;
  std::optional<Texture> texture_at(const Json& owner, const char* key,
                                    const std::string& where) const;
  std::optional<MapSource> source_of(const Texture& texture);
  std::string identity(std::size_t image) const;
  std::size_t make(int material);
  void read_factor(const Json& material, const std::string& where, Vec3f& factor) const;
  void note(const std::string& sentence);

  const File& file_;
  Model& model_;
  std::vector<int> materials_;  ///< parallel to sets_
  std::vector<std::size_t> sets_;
  std::vector<std::string> keys_;         ///< by texture set
  std::vector<std::string> albedo_keys_;  ///< likewise
};

}  // namespace normalshop::gltf
