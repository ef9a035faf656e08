#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "normalshop/core/raw_image.h"
#include "normalshop/surface/mesh.h"

/// Small models and maps for tests of the command line.
namespace normalshop::test {

/// A square of 2 x 2 units at z = 0 around the origin, facing +z, as OBJ text. Its UVs cover the
/// whole map unless they are left out. Names the library "square.mtl", which does not exist.
std::string square_obj(bool uvs = true);
/// Mesh::uvs and all as a .gltf with a .bin beside it; `map` as in GltfMaterial.
std::filesystem::path write_gltf(const std::filesystem::path& path, const Mesh& mesh,
                                 const std::string& map = {});

/// A normal map of gentle waves: tangent space, green up, every length 1 as far as codes allow.
/// 4 channels: alpha differs from texel to texel.
RawImage wavy_map(int size, int channels, CodeType type, bool green_down = false);
/// All texels the same normal, tilted by this angle towards +x.
RawImage tilted_map(int size, double degrees, CodeType type);

/// A recipe of one pen stroke through the middle of the square, which reaches less than a fifth of
/// it. `strength` as in recipes.
std::string pen_recipe(double strength = 1.0);

}  // namespace normalshop::test
