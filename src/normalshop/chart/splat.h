#pragma once

#include <vector>

#include "normalshop/chart/storage.h"
#include "normalshop/chart/texel_batch.h"

/// Splats of a chart of points, private to floor 4.
namespace normalshop {

/// Pixels from the middle of a splat that it reaches at most.
inline constexpr float largest_splat = 128.0F;

/// The texels of one triangle as splats. Offsets in pixels run down.
struct Splat {
  Mat2f to_texel = Mat2f::Zero();  ///< offsets in pixels to offsets in texels
  Mat2f to_wide = Mat2f::Zero();   ///< the same where texels are at least as wide as pixels
  Vec2f reach = Vec2f::Zero();     ///< half the box around a ring of one texel, pixels
  Vec2f depth_step = Vec2f::Zero();
  float wide_back = 0.0F;  ///< depth by which what is not the texel's own cell is behind the plane
  float ring_back = 0.0F;  ///< likewise the ring
  bool widened = false;    ///< to_wide differs from to_texel

  void load(const Mesh& mesh, const StorageAtlas& storage, const ChartGrid& grid,
            std::uint32_t triangle);
};

/// The splats that a task used last.
class SplatCache {
 public:
  SplatCache(const Mesh& mesh, const StorageAtlas& storage, const ChartGrid& grid)
      : mesh_(mesh), storage_(storage), grid_(grid), ids_(slots, no_triangle), splats_(slots) {}

  const Splat& get(std::uint32_t triangle) {
    const std::size_t slot = triangle % slots;
    if (ids_[slot] != triangle) {
      splats_[slot].load(mesh_, storage_, grid_, triangle);
      ids_[slot] = triangle;
    }
    return splats_[slot];
  }

 private:
  static constexpr std::size_t slots = 512;
  const Mesh& mesh_;
  const StorageAtlas& storage_;
  const ChartGrid& grid_;
  std::vector<std::uint32_t> ids_;
  std::vector<Splat> splats_;
};

}  // namespace normalshop
