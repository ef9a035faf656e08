#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "normalshop/surface/mesh.h"

namespace normalshop {

/// Images of one texture set, as paths relative to the written model; empty: none.
struct GltfMaterial {
  std::string name;
  std::string color_map;   ///< sRGB
  std::string normal_map;  ///< tangent space, green up
  float roughness = 0.9F;
};

/// Writes a mesh that has no file of its own yet: a .gltf with its .bin beside it, one primitive
/// and one material a texture set (in the order of mesh.texture_set_names; texture sets without
/// triangles are left out). Corners that are equal in position, normal, UV and tangent share a
/// vertex. Throws InvalidInput when the extension is another, the mesh has no triangles, normals or
/// UVs, or the numbers of materials and texture sets differ; IoError when it cannot be written.
void export_gltf(const std::filesystem::path& path, const Mesh& mesh,
                 const std::vector<GltfMaterial>& materials);

}  // namespace normalshop
