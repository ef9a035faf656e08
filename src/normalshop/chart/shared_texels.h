#pragma once

#include "normalshop/chart/texel_walk.h"

/// Which of several triangles decides what a texel gets, private to floor 4.
namespace normalshop {

/// A gutter texel takes what happens at the surface point that it stands for, beside a hard edge
/// at the border on the chart's own side of it.
inline SurfacePoint gutter_source(const GutterTexel& g) {
  return g.hard_edge ? SurfacePoint{g.owner, g.border_b1, g.border_b2} : g.source;
}

/// Takes the edit from the lanes of `batch` whose texel's owner has it with as large a weight:
/// there the owner decides. wanted(triangle) tells which owners may have it at all. Sampler: bool
/// read(TexelBatch&) const.
template <class Wanted, class Sampler>
void drop_lanes_of_owners(const PerLane<const SharedTexel*>& items, const TexelMap& texels,
                          const Wanted& wanted, TriangleCache<PushTriangle>& triangles,
                          const Sampler& sampler, TexelBatch& batch) {
  TexelBatch owners;
  PerLane<int> lanes;
  for (int i = 0; i < batch.count; ++i) {
    const std::uint32_t index = items[static_cast<std::size_t>(i)]->texel;
    const auto [x, y] = texel_place(index, texels.width());
    const std::uint32_t owner = texels.owner()(x, y);
    if (!batch.acts(i) || !wanted(owner)) continue;
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

/// collect_writes() of the gutter texels that wanted(triangle) triangles decide.
template <class Wanted, class Edit>
std::vector<TexelWrite> collect_gutter(const std::vector<GutterTexel>& items, const Mesh& mesh,
                                       const ChartGrid& grid, const Wanted& wanted,
                                       const Edit& edit) {
  return collect_writes(
      items, mesh, grid, [&](const GutterTexel& g) { return wanted(gutter_source(g).triangle); },
      [](const GutterTexel& g, TriangleCache<PushTriangle>& triangles, TexelBatch& batch) {
        const SurfacePoint p = gutter_source(g);
        batch.add_point(triangles.get(p.triangle), {1.0F, p.b1, p.b2});
      },
      edit);
}

/// collect_writes() of the texels that wanted(triangle) triangles share with their owners.
template <class Wanted, class Edit>
std::vector<TexelWrite> collect_shared(const std::vector<SharedTexel>& items,
                                       const TexelMap& texels, const Mesh& mesh,
                                       const ChartGrid& grid, const Wanted& wanted,
                                       const Edit& edit) {
  return collect_writes(
      items, mesh, grid, [&](const SharedTexel& s) { return wanted(s.triangle); },
      [&](const SharedTexel& s, TriangleCache<PushTriangle>& triangles, TexelBatch& batch) {
        const auto [x, y] = texel_place(s.texel, texels.width());
        add_texel(texels, s.triangle, x, y, triangles, batch);
      },
      edit);
}

}  // namespace normalshop
