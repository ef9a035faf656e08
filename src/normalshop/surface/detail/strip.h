#pragma once

#include <vector>

#include "normalshop/surface/detail/unfold.h"
#include "normalshop/surface/frames.h"

/// Geodesics in strips of triangles, private to this floor.
namespace normalshop {

/// What paths may cross.
class Crossings {
 public:
  explicit Crossings(const Topology& topology);
  /// The same edge of the triangle across; no_edge where no path leads.
  std::uint32_t across(std::uint32_t edge) const {
    return closed_[edge] ? no_edge : topology_.neighbor[edge];
  }

 private:
  const Topology& topology_;
  std::vector<bool> closed_;
};

/// Triangles in a row between two points.
struct Strip {
  SurfacePoint start;
  SurfacePoint end;
  std::vector<std::uint32_t> edges;  ///< that are crossed, each of the triangle that is left
};

/// Some short way from start to end: along the midpoints of edges. False where none leads there.
bool find_strip(const Mesh& mesh, const Crossings& crossings, Strip& strip);

/// Of the shortest way in a strip, for each of its edges: where it is crossed, 0 to 1 along it.
struct StripPath {
  std::vector<double> crossings;
  double length = 0.0;
};

/// Straightens the strip until no way beside it is shorter.
StripPath straighten(const Mesh& mesh, const Crossings& crossings, Strip& strip);

}  // namespace normalshop
