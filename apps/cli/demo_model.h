#pragma once

#include <filesystem>

#include "normalshop/core/raw_image.h"
#include "normalshop/surface/mesh.h"

namespace normalshop::demo {

/// A weathered stone head with six charts in one atlas: the model that needs no file.
struct DemoModel {
  Mesh mesh;         ///< about 2.3 units tall, front +z, up +y
  RawImage color;    ///< 8 bits, sRGB
  RawImage normals;  ///< 16 bits, tangent space, green up
};

struct DemoModelOptions {
  int cells = 50;       ///< quads along a chart's side
  int map_size = 2048;  ///< texels a side
};
Mesh make_demo_mesh(const DemoModelOptions& options = {});
DemoModel make_demo_model(const DemoModelOptions& options = {});

/// Writes head.gltf, head.bin, head_color.png and head_normal.png into an existing folder and
/// returns the model's path. Throws IoError.
std::filesystem::path write_demo_model(const DemoModel& model, const std::filesystem::path& folder);

}  // namespace normalshop::demo
