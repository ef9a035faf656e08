#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>

#include "normalshop/core/error.h"
#include "normalshop/io/model.h"

/// Any bytes give a consistent model or an Error.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace normalshop;
  try {
    ModelReadOptions options;
    options.max_triangles = 1U << 16U;
    options.flip_v = size % 2 != 0;
    const Model model =
        parse_gltf(std::as_bytes(std::span(data, size)), "/nonexistent/fuzz.gltf", options);
    const Mesh& mesh = model.mesh;
    const std::size_t corners = mesh.corner_count();
    bool good = mesh.uvs.size() == corners && mesh.normals.size() == corners &&
                mesh.texture_sets.size() == mesh.triangle_count();
    for (const Vec3u& t : mesh.triangles) good = good && t.maxCoeff() < mesh.positions.size();
    if (!good) __builtin_trap();
  } catch (const Error&) {
  }
  return 0;
}
