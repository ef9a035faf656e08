#pragma once

#include <cstdint>
#include <vector>

#include "normalshop/core/image.h"
#include "normalshop/core/normal_levels.h"
#include "normalshop/surface/frames.h"
#include "normalshop/surface/mesh.h"

namespace normalshop {

struct Topology;

inline constexpr std::uint32_t no_triangle = 0xFFFFFFFFU;

/// Column and row of a texel whose index is y * width + x. Maps hold up to 2^32 texels.
struct TexelPlace {
  int x;
  int y;
};
constexpr TexelPlace texel_place(std::uint32_t index, int width) {
  const auto columns = static_cast<std::uint32_t>(width);
  return {static_cast<int>(index % columns), static_cast<int>(index / columns)};
}

/// Affine map from a texel to barycentric weights of one triangle's corners 1 and 2:
/// b = origin_weights + (x - x0) * db_dx + (y - y0) * db_dy, (x, y) the texel's integer
/// coordinates. (x0, y0) lies near corner 0, so that differences stay exact in float.
struct TexelAffine {
  float x0 = 0.0F;
  float y0 = 0.0F;
  Vec2f origin_weights{0.0F, 0.0F};
  Vec2f db_dx{0.0F, 0.0F};
  Vec2f db_dy{0.0F, 0.0F};
  /// The triangle spans a border of the repeating unit square: texels of its other side need a
  /// shift by whole maps, see TexelMap::surface_point().
  bool wraps = false;
  /// No area in the atlas: it owns no texel and b is meaningless.
  bool degenerate = false;

  Vec2f at(float x, float y) const { return origin_weights + (x - x0) * db_dx + (y - y0) * db_dy; }
};

/// A texel that a further triangle covers too (overlapping or mirrored charts).
struct SharedTexel {
  std::uint32_t texel;  ///< y * width + x
  std::uint32_t triangle;
};

/// A texel beside a chart, which bilinear filtering and mip levels read.
struct GutterTexel {
  std::uint32_t texel;  ///< y * width + x
  std::uint32_t
      owner;       ///< triangle of the chart beside it; its frame, extrapolated, decodes the texel
  float owner_b1;  ///< extrapolated weights of the owner's corners 1 and 2 at the texel; further
  float owner_b2;  ///< out than the triangle is large they stop (no weight falls below -1)
  SurfacePoint source;  ///< the surface point that the texel stands for: across the seam, at the
                        ///< same distance from it on the surface; on the border itself where
                        ///< nothing of the texture set lies across
  float border_b1;      ///< weights of the owner's corners 1 and 2 at the nearest point of its
  float border_b2;      ///< border
  bool hard_edge;       ///< both sides' base normals differ there (hard_edge_degrees): what lies
                        ///< across is another surface, and the chart ends at its border
};

/// Which triangle each texel of one texture set's map shows: a texel belongs to a triangle that
/// holds its centre. Of several, the first in file order owns it and the others share it. Texels
/// outside every triangle within `gutter` texels of a chart's border (seam, open edge, or an edge
/// at which the chart is folded back) are the gutter; the nearest border's triangle owns them.
/// Where borders of overlapping charts lie on each other, the others' triangles share them.
///
/// A centre on an edge belongs to the triangle right of or below it, so that neighbours of one
/// chart never share a texel. UVs outside 0..1 repeat; where a triangle is larger than the map, a
/// texel stands for one of its repetitions on it, near the middle. The result does not depend on
/// threads.
class TexelMap {
 public:
  TexelMap() = default;
  /// Throws InvalidInput when the mesh has no UVs, the size is not 1 to 65,536 a side, or the
  /// gutter is not 0 to 256 texels. mesh.texture_sets must be filled.
  TexelMap(const Mesh& mesh, std::uint32_t texture_set, int width, int height, int gutter = 8);
  /// With the mesh's topology at hand, which only the gutter needs.
  TexelMap(const Mesh& mesh, const Topology& topology, std::uint32_t texture_set, int width,
           int height, int gutter = 8);

  int width() const { return owner_.width(); }
  int height() const { return owner_.height(); }
  /// Triangle or no_triangle, per texel.
  const Image<std::uint32_t>& owner() const { return owner_; }
  /// By texel, then triangle.
  const std::vector<SharedTexel>& shared() const { return shared_; }
  /// By texel; of several entries of one texel the first is its owner's, the others share it.
  const std::vector<GutterTexel>& gutter() const { return gutter_; }

  /// One per triangle of the mesh; degenerate for triangles of other texture sets.
  const std::vector<TexelAffine>& affines() const { return affines_; }
  /// Weights at a texel's centre in a triangle that covers it, whole-map shifts considered: of
  /// several repetitions one.
  SurfacePoint surface_point(std::uint32_t triangle, int x, int y) const;

 private:
  void find_owners(const Mesh& mesh);

  std::uint32_t texture_set_ = 0;
  Image<std::uint32_t> owner_;
  std::vector<TexelAffine> affines_;
  std::vector<SharedTexel> shared_;
  std::vector<GutterTexel> gutter_;
};

/// Texels count that a triangle owns; the gutter does not. Reads the map while it is used.
CoverageReader covered_texels(const TexelMap& texels);

}  // namespace normalshop
