#pragma once

#include <algorithm>
#include <cmath>
#include <mutex>
#include <vector>

#include <Eigen/LU>

#include "normalshop/chart/edit_sampler.h"
#include "normalshop/chart/shared_texels.h"
#include "normalshop/core/normal_codes.h"
#include "normalshop/core/parallel.h"

/// How an edit of normals comes to the texels of one map, private to floor 4.
namespace normalshop {

/// Sums that do not depend on the order of tasks.
struct PushTally {
  std::size_t visited = 0;
  std::size_t changed = 0;
  float largest = 0.0F;  // 1 - cos of the angle

  void add(const PushTally& other) {
    visited += other.visited;
    changed += other.changed;
    largest = std::max(largest, other.largest);
  }
};

/// The push into one texture set. Target: put(x, y, write) takes what a texel gets, with
/// write.facing where reads_facing; different threads put into different tiles of
/// NormalMap::tile_size. It may store it in set.normals.
template <class Target>
class SetPush {
 public:
  SetPush(const Mesh& mesh, const EditSampler& sampler, const StorageSet& set, std::uint32_t index,
          Target& target)
      : mesh_(mesh),
        sampler_(sampler),
        set_(set),
        target_(target),
        space_(set.normals.convention().space),
        candidates_(mesh, sampler.reach(), index, set.normals.width(), set.normals.height()) {}
  PushTally run();

 private:
  using Cache = TriangleCache<PushTriangle>;
  PushTally edit_row(TexelLanes& row);
  std::vector<TexelWrite> gutter_writes() const;
  std::vector<TexelWrite> shared_writes() const;
  static TexelWrite write_of(const TexelBatch& batch, int i, std::uint32_t texel);
  template <class Item>
  static void collect(const TexelBatch& batch, const PerLane<const Item*>& items,
                      std::vector<TexelWrite>& out);
  Vec3f own_vector(int x, int y, const Vec3f& base, const Mat3f& frame) const;
  Vec3f gutter_vector(const GutterTexel& g, const Mat3f& frame, const Vec3f& own,
                      const PushTriangle& source, float strength) const;
  void edit_gutter(const PerLane<const GutterTexel*>& items, Cache& triangles, TexelBatch& batch,
                   std::vector<TexelWrite>& out) const;
  void edit_shared(const PerLane<const SharedTexel*>& items, Cache& triangles, TexelBatch& batch,
                   std::vector<TexelWrite>& out) const;
  PushTally put(const std::vector<TexelWrite>& writes);
  void put(int x, int y, const TexelWrite& write, PushTally& tally);
  TexelPlace texel(std::uint32_t index) const { return texel_place(index, set_.normals.width()); }

  const Mesh& mesh_;
  const EditSampler& sampler_;
  const StorageSet& set_;
  Target& target_;
  NormalSpace space_;
  PushCandidates candidates_;
  std::vector<TexelWrite> shared_;  // of texels that their owners leave to others
};

template <class Target>
PushTally SetPush<Target>::edit_row(TexelLanes& row) {
  TexelBatch& batch = row.batch;
  PushTally tally;
  tally.visited = static_cast<std::size_t>(batch.count);
  if (!sampler_.read(batch)) return tally;
  fill_frames(mesh_, sampler_.grid().view, space_, row.triangles, batch);
  const std::uint32_t first = row.texels[0];
  const auto [x0, y] = texel(first);
  read_stored(set_.normals, row);
  apply(sampler_.mode(), batch);
  for (int i = 0; i < batch.count; ++i) {
    if (!batch.acts(i)) continue;
    const auto k = static_cast<std::size_t>(i);
    const std::uint32_t index = row.texels[k];
    if (holds_texel(shared_, index)) continue;
    put(x0 + static_cast<int>(index - first), y, write_of(batch, i, index), tally);
  }
  return tally;
}

/// The texel's vector; codes without a direction count as the base normal.
template <class Target>
Vec3f SetPush<Target>::own_vector(int x, int y, const Vec3f& base, const Mat3f& frame) const {
  Vec3f stored = set_.normals.vector(x, y);
  if (!codes::direction_of(stored).isZero()) return stored;
  if (space_ == NormalSpace::Tangent) return Vec3f::UnitZ();
  return frame.inverse() * base;
}

/// What a gutter texel held before the edit, in its own frame. Where the edit is weak that is its
/// code; the stronger it is, the more the texel is grown anew from the surface that it stands for:
/// else a filter would leave there what it takes away on the other side of the seam.
template <class Target>
Vec3f SetPush<Target>::gutter_vector(const GutterTexel& g, const Mat3f& frame, const Vec3f& own,
                                     const PushTriangle& source, float strength) const {
  if (g.hard_edge || g.source.triangle == g.owner) return own;
  const Vec3f weights(1.0F, g.source.b1, g.source.b2);
  const std::size_t corner = 3 * static_cast<std::size_t>(g.source.triangle);
  const Vec2f uv = interpolate(mesh_.uvs[corner], mesh_.uvs[corner + 1], mesh_.uvs[corner + 2],
                               g.source.b1, g.source.b2);
  const Mat3f across =
      source.frame(weights, source.normals * weights, space_, sampler_.grid().view);
  const Vec3f grown = frame.inverse() * (across * set_.normals.sample(uv));
  if (!grown.allFinite() || grown.isZero()) return own;
  constexpr float strong = 0.05F;  // a slope of three degrees
  const float share = std::min(1.0F, strength / strong);
  return (1.0F - share) * own.normalized() + share * grown.normalized();
}

template <class Target>
void SetPush<Target>::edit_gutter(const PerLane<const GutterTexel*>& items, Cache& triangles,
                                  TexelBatch& batch, std::vector<TexelWrite>& out) const {
  if (!sampler_.read(batch)) return;
  for (int i = 0; i < batch.count; ++i) {
    if (!batch.acts(i)) continue;
    const auto k = static_cast<std::size_t>(i);
    const GutterTexel& g = *items[k];
    const PushTriangle source = triangles.get(gutter_source(g).triangle);
    const PushTriangle& owner = triangles.get(g.owner);
    const Vec3f weights(1.0F, g.owner_b1, g.owner_b2);
    const Mat3f frame = owner.frame(weights, owner.normals * weights, space_, sampler_.grid().view);
    batch.set_frame(i, frame);
    const auto [x, y] = texel(g.texel);
    const float strength = Vec2f(batch.change_x[k], batch.change_y[k]).norm() + batch.covered[k];
    const Vec3f own = own_vector(x, y, batch.base.get(i), frame);
    batch.stored.set(i, gutter_vector(g, frame, own, source, strength));
  }
  apply(sampler_.mode(), batch);
  collect(batch, items, out);
}

template <class Target>
TexelWrite SetPush<Target>::write_of(const TexelBatch& batch, int i, std::uint32_t texel) {
  const auto k = static_cast<std::size_t>(i);
  TexelWrite write{texel, batch.weight[k], batch.result.get(i), batch.turn[k]};
  if constexpr (Target::reads_facing) {
    const Vec3f base = batch.base.get(i);
    write.facing = base.z() / base.norm();
  }
  return write;
}

template <class Target>
template <class Item>
void SetPush<Target>::collect(const TexelBatch& batch, const PerLane<const Item*>& items,
                              std::vector<TexelWrite>& out) {
  for (int i = 0; i < batch.count; ++i) {
    if (!batch.acts(i)) continue;
    out.push_back(write_of(batch, i, items[static_cast<std::size_t>(i)]->texel));
  }
}

/// A gutter texel takes the change of the surface point across the seam that it stands for, in the
/// frame of the chart beside it, which decodes it. Beside a hard edge it takes that of the border.
template <class Target>
std::vector<TexelWrite> SetPush<Target>::gutter_writes() const {
  return collect_gutter(
      set_.texels, mesh_, sampler_.grid(), candidates_,
      [&](const auto& items, Cache& triangles, TexelBatch& batch, std::vector<TexelWrite>& out) {
        edit_gutter(items, triangles, batch, out);
      });
}

template <class Target>
void SetPush<Target>::edit_shared(const PerLane<const SharedTexel*>& items, Cache& triangles,
                                  TexelBatch& batch, std::vector<TexelWrite>& out) const {
  if (!sampler_.read(batch)) return;
  drop_lanes_of_owners(items, set_.texels, candidates_, triangles, sampler_, batch);
  PerLane<std::uint32_t> ids{};
  for (int i = 0; i < batch.count; ++i) {
    const SharedTexel& s = *items[static_cast<std::size_t>(i)];
    ids[static_cast<std::size_t>(i)] = s.triangle;
    const auto [x, y] = texel(s.texel);
    batch.stored.set(i, set_.normals.vector(x, y));
  }
  fill_frames(mesh_, sampler_.grid().view, space_, ids, batch);
  apply(sampler_.mode(), batch);
  collect(batch, items, out);
}

/// Texels that further triangles cover, which the chart sees more squarely than their owner.
template <class Target>
std::vector<TexelWrite> SetPush<Target>::shared_writes() const {
  return collect_shared(
      set_.texels, mesh_, sampler_.grid(), candidates_,
      [&](const auto& items, Cache& triangles, TexelBatch& batch, std::vector<TexelWrite>& out) {
        edit_shared(items, triangles, batch, out);
      });
}

template <class Target>
void SetPush<Target>::put(int x, int y, const TexelWrite& write, PushTally& tally) {
  target_.put(x, y, write);
  tally.largest = std::max(tally.largest, write.turn);
  ++tally.changed;
}

template <class Target>
PushTally SetPush<Target>::put(const std::vector<TexelWrite>& writes) {
  PushTally tally;
  for (const TexelWrite& w : writes) {
    const auto [x, y] = texel(w.texel);
    put(x, y, w, tally);
  }
  return tally;
}

template <class Target>
PushTally SetPush<Target>::run() {
  // Before any texel changes: the gutter reads normals across its seams.
  shared_ = shared_writes();
  keep_strongest(shared_);
  std::vector<TexelWrite> gutter = gutter_writes();
  keep_strongest(gutter);
  const std::vector<Rect> tiles = candidates_.tiles();
  PushTally tally;
  std::mutex mutex;
  parallel_for(tiles.size(), 1, [&](std::size_t begin, std::size_t end) {
    PushTally local;
    TexelRows rows(mesh_, sampler_.grid(), set_.texels, candidates_.wanted());
    for (std::size_t i = begin; i < end; ++i) {
      rows.visit(tiles[i], [&](TexelLanes& row) { local.add(edit_row(row)); });
    }
    const std::lock_guard lock(mutex);
    tally.add(local);
  });
  tally.add(put(shared_));
  tally.add(put(gutter));
  return tally;
}

}  // namespace normalshop
