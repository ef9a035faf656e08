#include "normalshop/surface/surface_walk.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "normalshop/surface/detail/unfold.h"

namespace normalshop {
namespace {

constexpr int most_steps = 256;

SurfacePoint point_from_corner_weights(std::uint32_t triangle, const std::array<double, 3>& w) {
  const double sum = w[0] + w[1] + w[2];
  return {triangle, static_cast<float>(w[1] / sum), static_cast<float>(w[2] / sum)};
}

/// Where the way from `start` to `target` crosses the line of an edge, 0 to 1 along the edge.
double crossing(const UnfoldedEdge& e, const Vec2d& start, const Vec2d& target) {
  const double from = cross(e.second - e.first, start - e.first);
  const double to = cross(e.second - e.first, target - e.first);
  const double share = to - from > 0.0 ? std::clamp(-from / (to - from), 0.0, 1.0) : 0.0;
  const Vec2d place = start + share * (target - start);
  const Vec2d along = e.second - e.first;
  const double squared = along.squaredNorm();
  return squared > 0.0 ? std::clamp((place - e.first).dot(along) / squared, 0.0, 1.0) : 0.0;
}

SurfacePoint point_inside(std::uint32_t edge, const UnfoldedEdge& e, const Vec2d& apex,
                          const Vec2d& target) {
  const double area = cross(e.second - e.first, apex - e.first);
  const double to_first = std::max(0.0, cross(apex - e.second, target - e.second));
  const double to_second = std::max(0.0, cross(e.first - apex, target - apex));
  const double to_apex = std::max(0.0, cross(e.second - e.first, target - e.first));
  const double sum = to_first + to_second + to_apex;
  if (!(area > 0.0 && sum > 0.0)) return point_on_edge(edge, 1.0 - crossing(e, target, target));
  std::array<double, 3> w{};
  w[edge % 3] = to_second;
  w[next_corner(edge) % 3] = to_first;
  w[previous_corner(edge) % 3] = to_apex;
  return point_from_corner_weights(edge / 3, w);
}

}  // namespace

SurfacePoint point_on_edge(std::uint32_t edge, double t) {
  std::array<double, 3> w{};
  w[edge % 3] = 1.0 - t;
  w[next_corner(edge) % 3] = t;
  return point_from_corner_weights(edge / 3, w);
}

SurfacePoint walk(const Mesh& mesh, const Topology& topology, const SurfaceWalk& way) {
  const Vec3d leave =
      (mesh.position(next_corner(way.edge)) - mesh.position(way.edge)).cast<double>();
  UnfoldedEdge e{way.edge, {0.0, 0.0}, {leave.norm(), 0.0}};
  const Vec2d start = way.start * e.second;
  const Vec2d target(way.target.x(), std::max(0.0, way.target.y()));
  for (int step = 0; step < most_steps; ++step) {
    const std::uint32_t across = topology.neighbor[e.edge];
    if (across == no_edge || mesh.texture_sets[across / 3] != mesh.texture_sets[way.edge / 3]) {
      break;
    }
    const Vec2d apex = unfold_apex(mesh, across, e);
    // The triangle is to the right of both edges through which the way can leave it.
    const bool beyond_first = cross(apex - e.first, target - e.first) > 0.0;
    const bool beyond_second = cross(e.second - apex, target - apex) > 0.0;
    if (!beyond_first && !beyond_second) return point_inside(across, e, apex, target);
    const bool apex_is_left = cross(target - start, apex - start) > 0.0;
    const bool leave_second = beyond_first && beyond_second ? apex_is_left : beyond_second;
    e = leave_second ? UnfoldedEdge{previous_corner(across), apex, e.second}
                     : UnfoldedEdge{next_corner(across), e.first, apex};
  }
  return point_on_edge(e.edge, e.edge == way.edge ? way.start : crossing(e, start, target));
}

}  // namespace normalshop
