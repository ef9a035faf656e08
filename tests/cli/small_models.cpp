#include "cli/small_models.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "normalshop/core/normal_map.h"
#include "normalshop/io/gltf_export.h"

namespace normalshop::test {
namespace {

void set_code(RawImage& image, int x, int y, int channel, double from_0_to_1) {
  const int i = x * image.channels() + channel;
  if (image.type() == CodeType::U8) {
    image.row<std::uint8_t>(y)[i] = static_cast<std::uint8_t>(std::lround(255.0 * from_0_to_1));
  } else if (image.type() == CodeType::U16) {
    image.row<std::uint16_t>(y)[i] = static_cast<std::uint16_t>(std::lround(65535.0 * from_0_to_1));
  } else {
    image.row<float>(y)[i] = static_cast<float>(from_0_to_1);
  }
}

void set_normal(RawImage& image, int x, int y, const Vec3d& normal) {
  for (int c = 0; c < std::min(3, image.channels()); ++c)
    set_code(image, x, y, c, 0.5 + 0.5 * normal[c]);
}

}  // namespace

std::string square_obj(bool uvs) {
  std::string text = "mtllib square.mtl\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\n";
  if (!uvs) return text + "f 1 2 3 4\n";
  return text + "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl skin\nf 1/1 2/2 3/3 4/4\n";
}

std::filesystem::path write_gltf(const std::filesystem::path& path, const Mesh& mesh,
                                 const std::string& map) {
  GltfMaterial material;
  material.name = "map";
  material.normal_map = map;
  export_gltf(path, mesh, {material});
  return path;
}

RawImage wavy_map(int size, int channels, CodeType type, bool green_down) {
  RawImage image(size, size, channels, type);
  const double turn = 2.0 * std::numbers::pi / size;
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      // The gradient of a height, so that the curl tells green up from green down.
      // Nowhere flat, or 128 would be taken for the code of zero.
      const double a = 3 * turn * (x + 0.3);
      const double b = 5 * turn * (y + 0.3);
      const double slope_x = 0.5 * std::cos(a) * std::cos(b);
      const double slope_down = -0.83 * std::sin(a) * std::sin(b);
      const double slope_y = green_down ? slope_down : -slope_down;
      set_normal(image, x, y, Vec3d(-slope_x, -slope_y, 1.0).normalized());
      if (channels == 4) set_code(image, x, y, 3, (x * 7 + y * 13) % 256 / 255.0);
    }
  }
  return image;
}

RawImage tilted_map(int size, double degrees, CodeType type) {
  RawImage image(size, size, 3, type);
  const double angle = degrees * std::numbers::pi / 180.0;
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      set_normal(image, x, y, Vec3d(std::sin(angle), 0.0, std::cos(angle)));
    }
  }
  return image;
}

std::string pen_recipe(double strength) {
  return R"({"version": 1, "edits": [{"operator": "pen", "view": "front", "strength": )" +
         std::to_string(strength) +
         R"(, "options": {"width": 0.2, "height": 0.05}, "strokes": [[[-0.6, 0.1], [0.5, 0.1]]]}]})";
}

}  // namespace normalshop::test
