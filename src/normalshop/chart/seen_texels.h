#pragma once

#include <array>
#include <cstdint>
#include <deque>

#include "normalshop/chart/edit_reach.h"
#include "normalshop/chart/texel_walk.h"

/// The texels that a chart sees, kept, private to floor 4.
namespace normalshop {

/// Up to a batch of texels of one tile of an atlas, near one another: where they lie in the chart,
/// how well it sees them, what they hold and what decodes them.
struct SeenTexels {
  static constexpr int capacity = TexelBatch::capacity;
  using Lane = std::array<float, capacity>;

  int count = 0;
  PerLane<std::uint16_t> places;     ///< NormalMap::index_in_tile()
  PerLane<std::uint32_t> triangles;  ///< their owners
  Lane x;                            ///< pixels
  Lane y;
  Lane weight;  ///< of the effective chart, above 0
  std::array<Lane, 3> base;
  std::array<Lane, 3> tangent;
  std::array<Lane, 3> stored;  ///< what the map holds
  Lane sign;                   ///< of the bitangent
  float left = 0.0F;           ///< a box around the pixels
  float top = 0.0F;
  float right = -1.0F;
  float bottom = -1.0F;

  /// Makes lanes of them, but for their indices in the map, without weight where an edit does not
  /// reach. False when it reaches none.
  bool load(const EditReach& reach, TexelLanes& lanes) const;
  void append(const SeenTexels& from, int i);
};

/// Gathers the texels of a tile that a chart sees, square after square of 8 by 8.
class SeenTile {
 public:
  /// `everywhere`: each pixel of the chart acts.
  SeenTile(const EditReach& everywhere, const NormalMap& map)
      : everywhere_(everywhere), map_(map) {}

  /// Adds those of the lanes that the chart sees. They lie in one row, below those before.
  void add(TexelLanes& lanes, std::deque<SeenTexels>& seen);
  /// After the last ones.
  void finish(std::deque<SeenTexels>& seen);

 private:
  static constexpr int side = 8;
  static_assert(side * side <= SeenTexels::capacity);

  const EditReach& everywhere_;
  const NormalMap& map_;
  int band_ = -1;  ///< of rows that are being gathered
  std::array<SeenTexels, NormalMap::tile_size / side> squares_;
};

}  // namespace normalshop
