#pragma once

#include "normalshop/surface/mesh.h"

/// Small analytic meshes with UVs, base normals and tangents. Texture set 0, named "map".
namespace normalshop::test {

/// Adds triangles corner by corner; positions are not shared (welding is the library's job).
class MeshBuilder {
 public:
  struct Corner {
    Vec3f position;
    Vec3f normal;
    Vec2f uv;
  };
  void triangle(const Corner& a, const Corner& b, const Corner& c);
  /// Two triangles a b c and a c d.
  void quad(const Corner& a, const Corner& b, const Corner& c, const Corner& d);
  /// Tangents are dP/du of each triangle, projected onto the plane of the corner's normal.
  Mesh finish();

 private:
  Mesh mesh_;
};

/// The square [0, 1]^2 at z = 0, facing +z, n x n quads; u = x, v = 1 - y.
Mesh plane_grid(int n);

/// The same square cut at x = 0.5. The left half keeps the scale: u = 0.1 + 0.4 x / 0.5,
/// v = 0.9 - 0.8 y. The right half is turned by 90 degrees and lies at u in 0.6..0.9.
/// n x n quads a half.
Mesh plane_two_charts(int n);

/// The cube [-1, 1]^3 with flat normals, n x n quads a face, six charts in a 3 x 2 layout with
/// a margin of 0.04 around each.
Mesh cube(int n = 1);

/// Sphere around the origin, analytic normals, u along the longitude, v from the pole +y down:
/// one seam, triangles at the poles with a whole pole edge in the map.
Mesh uv_sphere(int segments, int rings, float radius = 1.0F);

/// Upper half (z >= 0) of the unit sphere with analytic normals, one chart in the middle of the map
/// (azimuthal equidistant), open at the equator.
Mesh hemisphere(int rings, int segments);

/// The square [-1, 1] x [0, 1] at z = 0 whose left half is mirrored onto the right half's UVs:
/// u = |x|, v = 1 - y. n x n quads a half, right half first in the file.
Mesh mirrored_pair(int n);

}  // namespace normalshop::test
