#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "normalshop/core/parallel.h"
#include "normalshop/surface/detail/atlas_chart.h"
#include "normalshop/surface/seams.h"
#include "normalshop/surface/topology.h"

namespace normalshop::unwrapping {

namespace {

constexpr std::size_t surface_grain = 4096;
/// Heights below this share of the model's extent are rounding of positions.
constexpr double least_height = 1e-7;
constexpr int smoothing_steps = 4;
/// Hard edges that cut off more parts than this, and of fewer triangles, bound facets.
constexpr std::size_t few_parts = 64;
constexpr std::size_t small_part = 8;

bool is_hard(const Mesh& mesh, std::uint32_t edge, std::uint32_t across) {
  static const float same = std::cos(hard_edge_degrees * 0.017453292519943295F);
  return mesh.normals[edge].dot(mesh.normals[next_corner(across)]) <= same ||
         mesh.normals[next_corner(edge)].dot(mesh.normals[across]) <= same;
}

/// Parts that hang together.
std::size_t count_parts(const std::vector<std::uint32_t>& across) {
  std::vector<bool> seen(across.size() / 3, false);
  std::vector<std::uint32_t> open;
  std::size_t count = 0;
  for (std::uint32_t first = 0; first < seen.size(); ++first) {
    if (seen[first]) continue;
    ++count;
    seen[first] = true;
    open.push_back(first);
    while (!open.empty()) {
      const std::uint32_t t = open.back();
      open.pop_back();
      for (std::uint32_t edge = 3 * t; edge < 3 * t + 3; ++edge) {
        const std::uint32_t next = across[edge] == none ? t : across[edge] / 3;
        if (seen[next]) continue;
        seen[next] = true;
        open.push_back(next);
      }
    }
  }
  return count;
}

/// Hard edges become borders, unless the normals are those of facets.
void cut_hard_edges(const Mesh& mesh, std::vector<std::uint32_t>& across) {
  std::vector<std::uint32_t> cut(across);
  for (std::uint32_t edge = 0; edge < across.size(); ++edge) {
    if (across[edge] != none && is_hard(mesh, edge, across[edge])) cut[edge] = none;
  }
  const std::size_t parts = count_parts(cut) - count_parts(across);
  if (parts <= few_parts || parts * small_part <= mesh.triangle_count()) across = std::move(cut);
}

void measure(Surface& surface, std::size_t t) {
  const Vec3d& a = surface.points[3 * t];
  const Vec3d& b = surface.points[3 * t + 1];
  const Vec3d& c = surface.points[3 * t + 2];
  const Vec3d normal = (b - a).cross(c - a);
  const double twice = normal.norm();
  const double longest =
      std::sqrt(std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()}));
  if (!(twice > least_height * surface.extent * longest)) return;
  surface.area[t] = 0.5 * twice;
  surface.normal[t] = normal / twice;
}

/// Sums over neighbours, again and again.
void smooth_normals(Surface& surface) {
  std::vector<Vec3d> from(surface.size());
  for (std::size_t t = 0; t < from.size(); ++t) from[t] = surface.area[t] * surface.normal[t];
  std::vector<Vec3d> to(from.size());
  for (int step = 0; step < smoothing_steps; ++step) {
    parallel_for(from.size(), surface_grain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t t = begin; t < end; ++t) {
        to[t] = from[t];
        for (std::size_t edge = 3 * t; edge < 3 * t + 3; ++edge) {
          if (surface.across[edge] != none) to[t] += from[surface.across[edge]];
        }
      }
    });
    from.swap(to);
  }
  for (std::size_t t = 0; t < from.size(); ++t) {
    const double length = from[t].norm();
    surface.smooth[t] = length > 0.0 ? Vec3d(from[t] / length) : surface.normal[t];
  }
}

}  // namespace

Surface make_surface(const Mesh& mesh, bool hard_edges) {
  Surface surface;
  const std::size_t count = mesh.triangle_count();
  surface.extent = static_cast<double>(bounds(mesh).diagonal());
  surface.points.resize(3 * count);
  surface.normal.assign(count, Vec3d::Zero());
  surface.smooth.assign(count, Vec3d::Zero());
  surface.area.assign(count, 0.0);
  parallel_for(count, surface_grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      for (std::size_t c = 3 * t; c < 3 * t + 3; ++c) {
        surface.points[c] = mesh.position(c).cast<double>();
      }
      measure(surface, t);
    }
  });
  Welding welding = weld_positions(mesh);
  surface.vertex = std::move(welding.vertex);
  surface.vertex_count = welding.vertex_count;
  surface.across = pair_edges(surface.vertex, surface.vertex_count);
  if (hard_edges && !mesh.normals.empty()) cut_hard_edges(mesh, surface.across);
  for (std::uint32_t& edge : surface.across) {
    if (edge != none) edge /= 3;
  }
  smooth_normals(surface);
  return surface;
}

ChartPlane::ChartPlane(const Vec3d& direction) {
  const Vec3d axis = std::abs(direction.y()) < 0.9 ? Vec3d::UnitY() : Vec3d::UnitZ();
  right = axis.cross(direction).normalized();
  up = direction.cross(right);
}

double worst_facing(const Surface& surface, std::span<const std::uint32_t> triangles,
                    const Vec3d& direction) {
  double worst = 1.0;
  for (const std::uint32_t t : triangles) worst = std::min(worst, surface.facing(t, direction));
  return worst;
}

Vec3d facing_direction(const Surface& surface, std::span<const std::uint32_t> triangles,
                       double cosine) {
  constexpr int most_steps = 40;
  constexpr double margin = 1e-3;
  Vec3d sum = Vec3d::Zero();
  for (const std::uint32_t t : triangles) sum += surface.area[t] * surface.normal[t];
  const double length = sum.norm();
  Vec3d mean = length > 0.0 ? Vec3d(sum / length) : surface.normal[triangles.front()];
  if (mean.isZero()) return Vec3d::UnitZ();
  Vec3d direction = mean;
  for (int step = 0; step < most_steps; ++step) {
    double worst = cosine;
    std::uint32_t at = none;
    for (const std::uint32_t t : triangles) {
      const double facing = surface.facing(t, direction);
      if (facing < worst) {
        worst = facing;
        at = t;
      }
    }
    if (at == none) return direction;
    // The triangle that faces least pulls the direction towards itself.
    direction = (direction + (cosine - worst + margin) * surface.normal[at]).normalized();
  }
  return mean;
}

double mean_stretch(const Surface& surface, std::span<const std::uint32_t> triangles,
                    const Vec3d& direction) {
  constexpr double least = 0.01;
  double area = 0.0;
  double shown = 0.0;
  for (const std::uint32_t t : triangles) {
    area += surface.area[t];
    shown += surface.area[t] * std::max(least, surface.normal[t].dot(direction));
  }
  if (!(area > 0.0)) return 1.0;
  const double mean = shown / area;
  double sum = 0.0;
  for (const std::uint32_t t : triangles) {
    const double ratio = std::max(least, surface.normal[t].dot(direction)) / mean;
    sum += surface.area[t] * std::max(ratio, 1.0 / ratio);
  }
  return sum / area;
}

}  // namespace normalshop::unwrapping
