#pragma once

#include "normalshop/chart/push_candidates.h"
#include "normalshop/chart/texel_walk.h"

/// Which of several triangles decides what a texel gets, private to floor 4.
namespace normalshop {

/// A gutter texel takes what happens at the surface point that it stands for, beside a hard edge
/// at the border on the chart's own side of it.
inline SurfacePoint gutter_source(const GutterTexel& g) {
  return g.hard_edge ? SurfacePoint{g.owner, g.border_b1, g.border_b2} : g.source;
}

/// Takes the edit from the lanes of `batch` whose texel's owner has it with as large a weight:
/// there the owner decides. Sampler: bool read(TexelBatch&) const.
template <class Sampler>
void drop_lanes_of_owners(const PerLane<const SharedTexel*>& items, const TexelMap& texels,
                          const PushCandidates& candidates, TriangleCache<PushTriangle>& triangles,
                          const Sampler& sampler, TexelBatch& batch) {
  TexelBatch owners;
  PerLane<int> lanes;
  for (int i = 0; i < batch.count; ++i) {
    const std::uint32_t index = items[static_cast<std::size_t>(i)]->texel;
    const auto [x, y] = texel_place(index, texels.width());
    const std::uint32_t owner = texels.owner()(x, y);
    if (!batch.acts(i) || !candidates.contains(owner)) continue;
    lanes[static_cast<std::size_t>(owners.count)] = i;
    add_texel(texels, owner, x, y, triangles, owners);
  }
  if (owners.count == 0 || !sampler.read(owners)) return;
  for (int i = 0; i < owners.count; ++i) {
    const auto k = static_cast<std::size_t>(lanes[static_cast<std::size_t>(i)]);
    const float weight = owners.weight[static_cast<std::size_t>(i)];
    if (owners.acts(i) && !outweighs(batch.weight[k], weight))
      batch.clear_edit(static_cast<int>(k));
  }
}

}  // namespace normalshop
