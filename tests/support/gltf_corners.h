#pragma once

#include <filesystem>

#include "normalshop/surface/mesh.h"

namespace normalshop::test {

/// Triangles of a plain glTF or GLB file, corners in the order of the index buffers, primitives in
/// file order, without node transforms and images. Only what the floors below file reading need
/// for their tests: float attributes, no sparse accessors. Throws std::runtime_error.
Mesh load_gltf_corners(const std::filesystem::path& file);

}  // namespace normalshop::test
