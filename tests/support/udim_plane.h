#pragma once

#include <filesystem>
#include <string>

#include "normalshop/io/atomic_file.h"

namespace normalshop::test {

/// An OBJ of the square [0, 2]^2 at z = 0, facing +z, u = x and v = y: it lies over the UDIM tiles
/// 1001, 1002, 1011 and 1012, up to their borders. n x n quads; where n is odd, some cross a
/// border. The material "skin" has `map_line` in its MTL.
inline std::filesystem::path write_udim_plane(const std::filesystem::path& folder, int n,
                                              const std::string& map_line) {
  std::string text = "mtllib plane.mtl\nvn 0 0 1\n";
  for (int y = 0; y <= n; ++y) {
    for (int x = 0; x <= n; ++x) {
      const std::string place = std::to_string(2.0 * x / n) + " " + std::to_string(2.0 * y / n);
      text += "v " + place + " 0\nvt " + place + "\n";
    }
  }
  text += "usemtl skin\n";
  for (int y = 0; y < n; ++y) {
    for (int x = 0; x < n; ++x) {
      const int first = y * (n + 1) + x + 1;
      text += "f";
      for (const int corner : {first, first + 1, first + n + 2, first + n + 1}) {
        const std::string index = std::to_string(corner);
        text += " " + index + "/" + index + "/1";
      }
      text += "\n";
    }
  }
  write_file(folder / "plane.mtl", "newmtl skin\nKd 0.8 0.8 0.8\n" + map_line + "\n");
  write_file(folder / "plane.obj", text);
  return folder / "plane.obj";
}

}  // namespace normalshop::test
