#pragma once

#include <cstdint>

#include "normalshop/chart/nearest_fill.h"
#include "normalshop/chart/pull.h"

/// Big splats of a chart of points, private to floor 4.
namespace normalshop {

/// Where in its pixel a point lies, and in its chart of the atlas.
struct PointOffset {
  std::int8_t x;
  std::int8_t y;
  bool at_border;  ///< its texel has a neighbour that no triangle owns
  /// Parts of a pixel.
  static constexpr float unit = 1.0F / 254.0F;
};

/// Draws every point of chart.ids as its texel, tilted like its triangle, and tells which points
/// nothing hides and which pixels between them are holes in the surface. chart.ids holds the
/// points' triangles and depths at their pixels' centres.
///
/// The middle of a splat, a little more than the texel's own cell, hides what lies more than a
/// pixel behind it; the ring around it, up to twice the cell, what lies a texel's depth further
/// behind. A pixel that only rings cover is a hole where they come from opposite sides, as beside a
/// seam: past a silhouette they come from one. At a border in the atlas, where the surface goes on
/// past the last texel's cell, the ring is twice as wide, and what lies in one of the triangles
/// there is surface. Cracks of a single pixel are closed, also where
/// something far behind shows in them.
Image<Shown> cover(const Mesh& mesh, const StorageAtlas& storage, const EditingChart& chart,
                   const Image<PointOffset>& offsets);

}  // namespace normalshop
