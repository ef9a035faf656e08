#include "normalshop/surface/texel_density.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

namespace normalshop {
namespace {

struct Sample {
  double size;
  double area;
};

std::vector<Sample> sorted_samples(const Mesh& mesh, std::uint32_t texture_set, int width,
                                   int height) {
  const double texels = static_cast<double>(width) * height;
  std::vector<Sample> samples;
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    if (mesh.texture_sets[t] != texture_set) continue;
    const Vec3d p = mesh.position(3 * t).cast<double>();
    const Vec3d d1 = mesh.position(3 * t + 1).cast<double>() - p;
    const Vec3d d2 = mesh.position(3 * t + 2).cast<double>() - p;
    const Vec2d uv = mesh.uvs[3 * t].cast<double>();
    const Vec2d e1 = mesh.uvs[3 * t + 1].cast<double>() - uv;
    const Vec2d e2 = mesh.uvs[3 * t + 2].cast<double>() - uv;
    const double area = 0.5 * d1.cross(d2).norm();
    const double map_area = 0.5 * std::abs(e1.x() * e2.y() - e1.y() * e2.x()) * texels;
    const double size = std::sqrt(area / map_area);
    if (area > 0.0 && map_area > 1e-12 && std::isfinite(size)) samples.push_back({size, area});
  }
  std::sort(samples.begin(), samples.end(), [](const Sample& a, const Sample& b) {
    return std::pair(a.size, a.area) < std::pair(b.size, b.area);
  });
  return samples;
}

/// Smallest size such that texels of that size and below have `share` of the area.
double area_percentile(const std::vector<Sample>& sorted, double share) {
  double total = 0.0;
  for (const Sample& s : sorted) total += s.area;
  double sum = 0.0;
  for (const Sample& s : sorted) {
    sum += s.area;
    if (sum >= share * total) return s.size;
  }
  return sorted.back().size;
}

}  // namespace

TexelDensity texel_density(const Mesh& mesh, std::uint32_t texture_set, int width, int height) {
  TexelDensity density;
  if (mesh.uvs.empty()) return density;
  const std::vector<Sample> sorted = sorted_samples(mesh, texture_set, width, height);
  if (sorted.empty()) return density;
  density.triangles = sorted.size();
  density.min = sorted.front().size;
  density.max = sorted.back().size;
  density.median = sorted[sorted.size() / 2].size;
  density.p05 = area_percentile(sorted, 0.05);
  density.area_median = area_percentile(sorted, 0.5);
  density.p95 = area_percentile(sorted, 0.95);
  return density;
}

TexelUse texel_use(const TexelMap& map) {
  TexelUse use;
  const std::size_t texels = map.owner().size();
  if (texels == 0) return use;
  const std::uint32_t* owner = map.owner().data();
  use.covered = texels - static_cast<std::size_t>(std::count(owner, owner + texels, no_triangle));
  const auto& shared = map.shared();
  for (std::size_t i = 0; i < shared.size(); ++i) {
    if (i == 0 || shared[i].texel != shared[i - 1].texel) ++use.shared;
  }
  use.coverage = static_cast<double>(use.covered) / static_cast<double>(texels);
  if (use.covered > 0)
    use.overlap = static_cast<double>(use.shared) / static_cast<double>(use.covered);
  return use;
}

}  // namespace normalshop
