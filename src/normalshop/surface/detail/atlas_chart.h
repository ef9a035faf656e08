#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "normalshop/core/vec.h"
#include "normalshop/surface/mesh.h"

/// What the steps of unwrapping share.
namespace normalshop::unwrapping {

inline constexpr std::uint32_t none = 0xFFFFFFFFU;

/// Connected triangles and the direction towards the viewer that they are projected along.
struct AtlasChart {
  std::vector<std::uint32_t> triangles;
  Vec3d direction{0.0, 0.0, 1.0};
};

/// The mesh as unwrapping sees it.
struct Surface {
  std::vector<Vec3d> points;          ///< per corner
  std::vector<std::uint32_t> vertex;  ///< per corner, welded by position
  std::uint32_t vertex_count = 0;
  std::vector<std::uint32_t> across;  ///< per edge: the triangle beyond, or none (hard edges too)
  std::vector<Vec3d> normal;          ///< per triangle, unit; 0: without area
  std::vector<Vec3d> smooth;          ///< likewise, with noise taken off
  std::vector<double> area;           ///< per triangle; 0: without area
  double extent = 0.0;                ///< diagonal of the bounds

  std::size_t size() const { return area.size(); }
  bool has_area(std::uint32_t triangle) const { return area[triangle] > 0.0; }
  /// Cosine of the angle to a direction; 1 without area.
  double facing(std::uint32_t triangle, const Vec3d& direction) const {
    return has_area(triangle) ? normal[triangle].dot(direction) : 1.0;
  }
};
Surface make_surface(const Mesh& mesh, bool hard_edges);

/// What a chart must keep to.
struct ChartLimits {
  double cosine;   ///< least, of the angle between direction and normals
  double stretch;  ///< largest mean area stretch
};

/// Right and up of a picture seen from a direction.
struct ChartPlane {
  explicit ChartPlane(const Vec3d& direction);
  Vec2d operator()(const Vec3d& p) const { return {right.dot(p), up.dot(p)}; }
  Vec3d right;
  Vec3d up;
};

/// The mean normal, turned away from it only as far as needed so that every triangle faces it with
/// at least `cosine`, if that can be had.
Vec3d facing_direction(const Surface& surface, std::span<const std::uint32_t> triangles,
                       double cosine);
/// Least cosine over the triangles.
double worst_facing(const Surface& surface, std::span<const std::uint32_t> triangles,
                    const Vec3d& direction);
/// Mean area stretch (unwrap.h) of one chart by itself.
double mean_stretch(const Surface& surface, std::span<const std::uint32_t> triangles,
                    const Vec3d& direction);

/// A counter-clockwise triangle in the plane, with the number to report it by.
struct FlatTriangle {
  Vec2d corner[3];
  std::uint32_t name;
};
using NamePair = std::pair<std::uint32_t, std::uint32_t>;

/// Pairs of triangles that overlap by more than `tolerance` (a length), each once, the lower name
/// first, in ascending order.
std::vector<NamePair> overlapping_pairs(std::span<const FlatTriangle> triangles, double tolerance);
/// The triangles of a chart that have an area, as it shows them.
std::vector<FlatTriangle> flatten(const Surface& surface, const AtlasChart& chart);
/// Pairs of a chart's triangles that overlap in its projection.
std::vector<NamePair> overlaps_of(const Surface& surface, const AtlasChart& chart);

/// Variational partition: charts that cover every triangle. They keep to the limits as far as the
/// smoothed normals tell, but may overlap in their own projections.
std::vector<AtlasChart> partition(const Surface& surface, const ChartLimits& limits);

/// Shortens the borders between charts by moving triangles across. Charts may fall apart.
std::vector<AtlasChart> straighten(const Surface& surface, const std::vector<AtlasChart>& charts,
                                   const ChartLimits& limits);

/// Splits charts until each is connected, faces its direction and does not overlap itself. A
/// triangle without area that hangs on nothing is left out.
std::vector<AtlasChart> make_valid(const Surface& surface, std::vector<AtlasChart> charts,
                                   const ChartLimits& limits);

/// Merges neighbours while the limits allow.
std::vector<AtlasChart> merge(const Surface& surface, std::vector<AtlasChart> charts,
                              const ChartLimits& limits);

}  // namespace normalshop::unwrapping
