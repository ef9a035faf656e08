#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "normalshop/core/normal_map.h"
#include "normalshop/surface/frames.h"
#include "normalshop/surface/mesh.h"
#include "normalshop/surface/seams.h"

/// How well both sides of the atlas' seams agree: the angle between the object-space normals that a
/// renderer reads (bilinear, each side with its own tangent frame) at one and the same place of a
/// seam edge.
namespace normalshop {

/// The normal maps by texture set.
using NormalMaps = std::span<const NormalMap* const>;

/// A place on a seam edge as both sides see it.
struct SeamSample {
  std::uint32_t edge;  ///< index into the edges
  SurfacePoint a;      ///< on edges[edge].triangle_a
  SurfacePoint b;      ///< on edges[edge].triangle_b
};

/// Evenly along every edge, about one sample for each texel of the side that has more of them, at
/// least one an edge. In the order of the edges. Every texture set of the mesh needs its map.
std::vector<SeamSample> sample_seams(const Mesh& mesh, std::span<const SeamEdge> edges,
                                     NormalMaps maps);

/// Degrees between both sides' normals, one a sample. Where a map holds no direction its side
/// counts as the base normal.
std::vector<float> seam_angles(const Mesh& mesh, std::span<const SeamSample> samples,
                               NormalMaps maps);

/// Indices, ascending, of the samples at which one of the four texels that either side reads is
/// edited: the seams that edits crossed or touched.
std::vector<std::uint32_t> edited_samples(const Mesh& mesh, std::span<const SeamSample> samples,
                                          NormalMaps maps);

/// Of angles, or of differences between angles, in degrees. All 0 without any.
struct SeamMismatch {
  std::size_t count = 0;
  double mean = 0.0;
  double p50 = 0.0;
  double p99 = 0.0;
  double max = 0.0;
};
SeamMismatch summarize(std::vector<float> degrees);

/// sample_seams(), seam_angles() and summarize() of all edges.
SeamMismatch measure_seams(const Mesh& mesh, std::span<const SeamEdge> edges, NormalMaps maps);

/// By how much the mismatch has grown (negative: shrunk) at the chosen samples. `before` and
/// `after` are the seam_angles() of the same samples.
SeamMismatch mismatch_growth(std::span<const float> before, std::span<const float> after,
                             std::span<const std::uint32_t> chosen);

}  // namespace normalshop
