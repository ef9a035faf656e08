#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "normalshop/core/normal_map.h"
#include "normalshop/surface/mesh.h"
#include "normalshop/surface/seam_mismatch.h"
#include "normalshop/surface/seams.h"

namespace normalshop {

/// Keeps both sides of a seam together while an edit changes their texels.
///
/// Each side samples the edit at its own texels and interpolates bilinearly, so that a crease,
/// which is sharper than a texel, comes out at different places left and right of a seam. SeamFit
/// moves the changed texels that are read along the seam by as little as lets both sides'
/// object-space normals differ by no larger angle than before the edit: non-linear least squares.
/// Where they don't, nothing moves. Texels that the edit did not change are not touched, and hard
/// edges, whose base normals differ, keep what each side got.
///
/// Source: the idea of Liu, Ferguson, Jacobson, Gingold, "Seamless: Seam Erasure and Seam-Aware
/// Decoupling of Shape from Mesh Resolution" (2017), for normals and for the change only.
class SeamFit {
 public:
  /// Before the edit: remembers what is read along the edges. Every texture set needs its map.
  /// `kept`, 0 to 1: how much of the angle before both sides may keep; 0 closes the seams as far as
  /// the edit changed texels.
  SeamFit(const Mesh& mesh, std::span<const SeamEdge> edges, NormalMaps maps, float kept = 1.0F);

  /// After it. Returns how many texels that are read along the seams the edit changed: those that
  /// may have moved. The result does not depend on threads.
  std::size_t apply(std::span<NormalMap* const> maps) const;

 private:
  /// What one side reads at a sample.
  struct Side {
    Mat3f to_object = Mat3f::Identity();
    std::array<std::uint32_t, 4> texels{};  ///< indices into texels_
    std::array<float, 4> weights{};
  };
  struct Sample {
    std::array<Side, 2> sides;
    float weight = 1.0F;
    float allowed = 0.0F;  ///< distance of both sides' unit object-space normals
  };
  struct Texel {
    std::uint32_t set;
    std::uint32_t texel;  ///< y * width + x
    Vec3f before;
  };
  class Solver;

  Side side(const Mesh& mesh, const SurfacePoint& point, NormalMaps maps,
            std::vector<std::uint64_t>& keys) const;
  void add_sample(const Mesh& mesh, const SeamSample& place, float weight, NormalMaps maps,
                  std::vector<std::uint64_t>& keys);
  void collect_texels(const std::vector<std::uint64_t>& keys, NormalMaps maps);
  void remember_reads(float kept);

  std::vector<Sample> samples_;
  std::vector<Texel> texels_;
};

}  // namespace normalshop
