#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "normalshop/core/vec.h"

namespace normalshop {

/// A triangle mesh with a texture atlas, as floor 3 and above see it: in object units (a file's
/// world units, after its node transforms), with attributes per triangle corner, so that seams,
/// hard edges and unwelded files need no special case.
///
/// Corner k of triangle t has the index 3 t + k. Every per-corner array has 3 * triangles.size()
/// entries, or is empty where it says so.
struct Mesh {
  std::vector<Vec3f> positions;
  std::vector<Vec3u> triangles;  ///< indices into positions, counter-clockwise from outside

  std::vector<Vec3f> normals;  ///< per corner, unit: the base normals N^b at the corners
  /// Per corner. u runs right, v DOWN: (0, 0) is the top left corner of the map's first texel, as
  /// in glTF. Values outside 0..1 repeat.
  std::vector<Vec2f> uvs;
  /// Per corner: unit tangent and the sign w of the bitangent B = w * cross(N, T), where B points
  /// up in the map (towards smaller v) for w = +1 on unmirrored triangles. May be empty: see
  /// tangents.h.
  std::vector<Vec4f> tangents;

  std::vector<std::uint32_t> texture_sets;  ///< per triangle, index into texture_set_names
  std::vector<std::string> texture_set_names;
  /// Per texture set, 1: its map ends at 0 and 1 instead of repeating, and all its UVs lie there (a
  /// UDIM tile). Empty: all maps repeat.
  std::vector<std::uint8_t> single_maps;
  bool repeats(std::uint32_t set) const { return single_maps.empty() || single_maps[set] == 0; }

  /// For object-space maps of files whose nodes are turned or scaled: per triangle, which of
  /// node_normals takes a node's own normals to this mesh's space (not normalised; the inverse
  /// transpose of its transform). Both empty: none is needed.
  std::vector<std::uint32_t> nodes;
  std::vector<Mat3f> node_normals;

  /// Node space to mesh space for normals of that triangle.
  Mat3f node_frame(std::size_t triangle) const {
    return nodes.empty() ? Mat3f(Mat3f::Identity()) : node_normals[nodes[triangle]];
  }

  std::size_t triangle_count() const { return triangles.size(); }
  std::size_t corner_count() const { return 3 * triangles.size(); }
  const Vec3f& position(std::size_t corner) const {
    return positions[triangles[corner / 3][static_cast<Eigen::Index>(corner % 3)]];
  }
};

/// Where a texture set's map of that size is read for a UV: there, or, where the map does not
/// repeat, at the nearest place that takes nothing from its opposite border.
Vec2f reading_place(const Mesh& mesh, std::uint32_t set, const Vec2f& uv, int width, int height);

/// Smallest box around all positions that a triangle uses; low > high for a mesh without triangles.
struct Bounds {
  Vec3f low = Vec3f::Constant(3.4e38F);
  Vec3f high = Vec3f::Constant(-3.4e38F);
  Vec3f center() const { return 0.5F * (low + high); }
  float diagonal() const { return (high - low).norm(); }
};
Bounds bounds(const Mesh& mesh);

}  // namespace normalshop
