#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "normalshop/chart/edit_reach.h"
#include "normalshop/chart/texel_walk.h"

/// The texels that a chart sees, kept, private to floor 4.
namespace normalshop {

/// Up to a batch of texels of one tile of an atlas: where they lie in the chart, how well it sees
/// them, and what decodes them.
struct SeenTexels {
  static constexpr int capacity = TexelBatch::capacity;
  using Lane = std::array<float, capacity>;

  int count = 0;
  PerLane<std::uint32_t> texels;     ///< y * width + x, rising
  PerLane<std::uint32_t> triangles;  ///< their owners
  Lane x;                            ///< pixels
  Lane y;
  Lane weight;  ///< of the effective chart, above 0
  std::array<Lane, 3> base;
  std::array<Lane, 3> tangent;
  Lane sign;          ///< of the bitangent
  float left = 0.0F;  ///< a box around the pixels
  float top = 0.0F;
  float right = -1.0F;
  float bottom = -1.0F;

  /// Makes lanes of them, without weight where an edit does not reach. False when it reaches none.
  bool load(const EditReach& reach, TexelLanes& lanes) const;
};

/// Appends those of the lanes that the chart sees. `everywhere`: each of its pixels acts.
void append_seen(const EditReach& everywhere, TexelLanes& lanes, std::vector<SeenTexels>& seen);

}  // namespace normalshop
