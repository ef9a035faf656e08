#pragma once

#include <optional>

#include "normalshop/chart/details.h"
#include "normalshop/chart/pull.h"

namespace normalshop {

/// What an operator did to an editing chart, as push carries it to the texels:
///
///     texel' = texel + weight * (coverage * (base - texel) + change)
///
/// in the two numbers of `direction`. An edit that adds has no coverage; one that ignores or
/// replaces the details under it covers them.
struct ChartEdit {
  EditDirection direction;  ///< in chart axes
  SlopeView change;         ///< size of the chart
  MaskView coverage;        ///< 0 to 1; empty: 0 everywhere
  Rect region;              ///< outside, change and coverage are 0
  /// Texels whose surface points lie outside these pixels stay as they are; none: all are edited.
  std::optional<Rect> own = {};
};

struct PushResult {
  std::size_t visited = 0;  ///< texels of triangles that may lie in the region
  std::size_t changed = 0;  ///< texels and gutter texels with a new normal
  /// Of these, the texels that further triangles cover (TexelMap::shared()): the model changes
  /// there, too.
  std::size_t shared = 0;
  float largest_change = 0.0F;  ///< degrees by which the edit turned one of them at most
};

/// Carries an edit back by gathering: every texel of the storage atlas that the chart sees within
/// the region projects its base point into the chart, is dropped where something nearer hides it,
/// and reads change, coverage and chart.weight there (bicubic, bilinear). A texel for which nothing
/// changes is not written, so it keeps its code. Gutter texels take what happens at the surface
/// point that they stand for, beside a hard edge at their own side's border. Texels shared by
/// several triangles, and the gutter that these share, take the edit of the one with the largest
/// chart.weight, of equal ones the first; of a triangle on which the map repeats, only the
/// repetition that TexelMap::surface_point() tells carries its edit. Deterministic for any number
/// of threads.
///
/// The chart has its weight (compute_weight()), and change and coverage are of its size. Every
/// texture set of the mesh has its set in the storage, whose texels are of the size of its normals.
///
/// Source: thesis 5.3.3, with differences gathered by texels instead of values scattered by pixels.
PushResult push(const Mesh& mesh, const EditingChart& chart, const ChartEdit& edit,
                StorageAtlas& storage);

}  // namespace normalshop
