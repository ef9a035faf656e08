#pragma once

#include <vector>

#include "normalshop/chart/edit_sampler.h"
#include "normalshop/chart/shared_texels.h"

/// What an edit makes of normals, private to floor 4.
namespace normalshop {

/// Applies an edit to the texels of one map as it is before the edit. Stores nothing.
class NormalEditor {
 public:
  using Triangles = TriangleCache<PushTriangle>;
  /// Do writes tell how squarely the view sees the texel? Others have facing 0.
  enum class Facing { Left, Told };

  NormalEditor(const Mesh& mesh, const EditSampler& sampler, const TexelMap& texels,
               const NormalMap& before, Facing facing = Facing::Left)
      : mesh_(mesh),
        sampler_(sampler),
        texels_(texels),
        before_(before),
        space_(before.convention().space),
        facing_(facing) {}

  const Mesh& mesh() const { return mesh_; }
  const EditSampler& sampler() const { return sampler_; }
  const TexelMap& texels() const { return texels_; }

  /// Fills result and turn of the lanes on which the edit acts; false where it acts on none.
  bool edit(TexelLanes& lanes) const;
  /// The same of lanes whose weight is there already, and what the map holds.
  bool edit_weighed(TexelLanes& lanes) const;
  /// The write of lane i, on which the edit acts, of a texel that the triangle's frame decodes.
  TexelWrite write_of(const TexelBatch& batch, int i, std::uint32_t texel,
                      std::uint32_t triangle) const {
    const auto k = static_cast<std::size_t>(i);
    TexelWrite write{texel, batch.weight[k], batch.result.get(i), batch.turn[k], 0.0F, triangle};
    if (facing_ == Facing::Told) {
      const Vec3f base = batch.base.get(i);
      write.facing = base.z() / base.norm();
    }
    return write;
  }

  /// One write for each gutter texel that stands for a point of a wanted(triangle) and that the
  /// edit changes: it takes the change of that point across the seam, in the frame of the chart
  /// beside it, which decodes it. Beside a hard edge it takes that of the border.
  template <class Wanted>
  std::vector<TexelWrite> gutter_writes(const std::vector<GutterTexel>& items,
                                        const Wanted& wanted) const;
  /// The same for texels that wanted triangles share with their owners, where the chart sees them
  /// more squarely than these.
  template <class Wanted>
  std::vector<TexelWrite> shared_writes(const std::vector<SharedTexel>& items,
                                        const Wanted& wanted) const;

 private:
  void apply_to(TexelLanes& lanes) const;
  Vec3f own_vector(int x, int y, const Vec3f& base, const Mat3f& frame) const;
  Vec3f gutter_vector(const GutterTexel& g, const Mat3f& frame, const Vec3f& own,
                      const PushTriangle& source, float strength) const;
  void edit_gutter(const PerLane<const GutterTexel*>& items, Triangles& triangles,
                   TexelBatch& batch, std::vector<TexelWrite>& out) const;
  void edit_shared(const PerLane<const SharedTexel*>& items, TexelBatch& batch,
                   std::vector<TexelWrite>& out) const;
  template <class Item>
  void collect(const TexelBatch& batch, const PerLane<const Item*>& items,
               std::vector<TexelWrite>& out) const;

  const Mesh& mesh_;
  const EditSampler& sampler_;
  const TexelMap& texels_;
  const NormalMap& before_;
  NormalSpace space_;
  Facing facing_;
};

template <class Wanted>
std::vector<TexelWrite> NormalEditor::gutter_writes(const std::vector<GutterTexel>& items,
                                                    const Wanted& wanted) const {
  std::vector<TexelWrite> writes = collect_gutter(
      items, mesh_, sampler_.grid(), wanted,
      [&](const auto& lanes, Triangles& triangles, TexelBatch& batch,
          std::vector<TexelWrite>& out) { edit_gutter(lanes, triangles, batch, out); });
  keep_strongest(writes);
  return writes;
}

template <class Wanted>
std::vector<TexelWrite> NormalEditor::shared_writes(const std::vector<SharedTexel>& items,
                                                    const Wanted& wanted) const {
  std::vector<TexelWrite> writes =
      collect_shared(items, texels_, mesh_, sampler_.grid(), wanted,
                     [&](const auto& lanes, Triangles& triangles, TexelBatch& batch,
                         std::vector<TexelWrite>& out) {
                       if (!sampler_.read(batch)) return;
                       drop_lanes_of_owners(lanes, texels_, wanted, triangles, sampler_, batch);
                       edit_shared(lanes, batch, out);
                     });
  keep_strongest(writes);
  return writes;
}

}  // namespace normalshop
