#include "normalshop/surface/seam_mismatch.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

#include "normalshop/core/parallel.h"
#include "normalshop/core/sample.h"
#include "normalshop/core/slope.h"

namespace normalshop {

namespace {

constexpr std::size_t run = 1024;

const NormalMap& map_of(const Mesh& mesh, std::uint32_t triangle, NormalMaps maps) {
  return *maps[mesh.texture_sets[triangle]];
}

Vec2f place_in(const NormalMap& map, const Mesh& mesh, const SurfacePoint& p) {
  const std::size_t corner = 3 * static_cast<std::size_t>(p.triangle);
  return reading_place(
      mesh, mesh.texture_sets[p.triangle],
      interpolate<Vec2f>(mesh.uvs[corner], mesh.uvs[corner + 1], mesh.uvs[corner + 2], p.b1, p.b2),
      map.width(), map.height());
}

/// The point at fraction t of the way between two corners of a triangle.
SurfacePoint between(std::uint32_t triangle, std::uint32_t from, std::uint32_t to, float t) {
  const auto weight = [&](std::uint32_t corner) {
    return (from == corner ? 1.0F - t : 0.0F) + (to == corner ? t : 0.0F);
  };
  return {triangle, weight(3 * triangle + 1), weight(3 * triangle + 2)};
}

float texels_between(const Mesh& mesh, std::uint32_t from, std::uint32_t to, NormalMaps maps) {
  const NormalMap& map = map_of(mesh, from / 3, maps);
  const Vec2f size(static_cast<float>(map.width()), static_cast<float>(map.height()));
  return (mesh.uvs[to] - mesh.uvs[from]).cwiseProduct(size).norm();
}

Vec3f normal_at(const Mesh& mesh, const SurfacePoint& p, NormalMaps maps) {
  const NormalMap& map = map_of(mesh, p.triangle, maps);
  const Vec3f read = map.sample(place_in(map, mesh, p));
  const Vec3f n = frame_at(mesh, p, map.convention().space).object_normal(read);
  return n.isZero() ? base_normal_at(mesh, p) : n;
}

bool is_edited(const Mesh& mesh, const SurfacePoint& p, NormalMaps maps) {
  const NormalMap& map = map_of(mesh, p.triangle, maps);
  const WrappedTaps tap(place_in(map, mesh, p), map.width(), map.height());
  return map.edited(tap.x0, tap.y0) || map.edited(tap.x1, tap.y0) || map.edited(tap.x0, tap.y1) ||
         map.edited(tap.x1, tap.y1);
}

}  // namespace

std::vector<SeamSample> sample_seams(const Mesh& mesh, std::span<const SeamEdge> edges,
                                     NormalMaps maps) {
  assert(maps.size() >= mesh.texture_set_names.size());
  std::vector<SeamSample> samples;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const SeamEdge& e = edges[i];
    const float texels =
        std::max(texels_between(mesh, e.a0, e.a1, maps), texels_between(mesh, e.b0, e.b1, maps));
    // UVs may be no numbers.
    const int count = texels > 1.0F ? static_cast<int>(std::ceil(std::min(texels, 0x1p20F))) : 1;
    for (int k = 0; k < count; ++k) {
      const float t = (static_cast<float>(k) + 0.5F) / static_cast<float>(count);
      samples.push_back({static_cast<std::uint32_t>(i), between(e.triangle_a, e.a0, e.a1, t),
                         between(e.triangle_b, e.b0, e.b1, t)});
    }
  }
  return samples;
}

std::vector<float> seam_angles(const Mesh& mesh, std::span<const SeamSample> samples,
                               NormalMaps maps) {
  std::vector<float> angles(samples.size());
  parallel_for(samples.size(), run, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      angles[i] = static_cast<float>(
          angle_degrees(normal_at(mesh, samples[i].a, maps), normal_at(mesh, samples[i].b, maps)));
    }
  });
  return angles;
}

std::vector<std::uint32_t> edited_samples(const Mesh& mesh, std::span<const SeamSample> samples,
                                          NormalMaps maps) {
  std::vector<std::uint32_t> chosen;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (is_edited(mesh, samples[i].a, maps) || is_edited(mesh, samples[i].b, maps)) {
      chosen.push_back(static_cast<std::uint32_t>(i));
    }
  }
  return chosen;
}

SeamMismatch summarize(std::vector<float> degrees) {
  SeamMismatch out;
  out.count = degrees.size();
  if (degrees.empty()) return out;
  std::sort(degrees.begin(), degrees.end());
  const auto at = [&](double share) {
    const double place = std::ceil(share * static_cast<double>(degrees.size()));
    return static_cast<double>(degrees[static_cast<std::size_t>(std::max(place, 1.0)) - 1]);
  };
  out.mean =
      std::accumulate(degrees.begin(), degrees.end(), 0.0) / static_cast<double>(degrees.size());
  out.p50 = at(0.5);
  out.p99 = at(0.99);
  out.max = static_cast<double>(degrees.back());
  return out;
}

SeamMismatch measure_seams(const Mesh& mesh, std::span<const SeamEdge> edges, NormalMaps maps) {
  const std::vector<SeamSample> samples = sample_seams(mesh, edges, maps);
  return summarize(seam_angles(mesh, samples, maps));
}

SeamMismatch mismatch_growth(std::span<const float> before, std::span<const float> after,
                             std::span<const std::uint32_t> chosen) {
  assert(before.size() == after.size());
  std::vector<float> growth;
  growth.reserve(chosen.size());
  for (const std::uint32_t i : chosen) growth.push_back(after[i] - before[i]);
  return summarize(std::move(growth));
}

}  // namespace normalshop
