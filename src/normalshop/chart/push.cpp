#include "normalshop/chart/push.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <vector>

#include <Eigen/LU>

#include "normalshop/chart/edit_sampler.h"
#include "normalshop/chart/push_candidates.h"
#include "normalshop/chart/texel_writes.h"
#include "normalshop/core/normal_codes.h"
#include "normalshop/core/parallel.h"

namespace normalshop {

namespace {

/// Sums that do not depend on the order of tasks.
struct Tally {
  std::size_t visited = 0;
  std::size_t changed = 0;
  float largest = 0.0F;  // 1 - cos of the angle

  void add(const Tally& other) {
    visited += other.visited;
    changed += other.changed;
    largest = std::max(largest, other.largest);
  }
};

/// The push into one texture set.
class SetPush {
 public:
  SetPush(const Mesh& mesh, const EditSampler& sampler, StorageSet& set, std::uint32_t index)
      : mesh_(mesh),
        sampler_(sampler),
        set_(set),
        space_(set.normals.convention().space),
        candidates_(mesh, sampler, index, set.normals.width(), set.normals.height()) {}
  Tally run();

 private:
  using Cache = TriangleCache<PushTriangle>;
  /// Texels side by side that one candidate owns.
  struct Run {
    int x;
    int count;
    std::uint32_t owner;
  };
  /// What a task keeps from tile to tile.
  struct Task {
    Cache triangles;
    std::array<std::vector<Run>, NormalMap::tile_size> runs;  // by row of the tile
    TexelBatch batch;
    PerLane<int> columns;
    PerLane<std::uint32_t> owners;
    PerLane<Vec3f> stored;
  };

  Tally push_tile(const Rect& tile, Task& task);
  void find_runs(const Rect& tile, int y, std::vector<Run>& runs) const;
  void find_texels(const std::vector<Run>& runs, int y, Task& task) const;
  void add_texels(std::uint32_t owner, int x, int y, int count, Cache& triangles,
                  TexelBatch& batch) const;
  void fill_frames(const PerLane<std::uint32_t>& triangles, TexelBatch& batch) const;
  Tally edit_row(int y, Task& task);
  bool is_taken(int x, int y) const;
  std::vector<TexelWrite> gutter_writes() const;
  std::vector<TexelWrite> shared_writes() const;
  static void collect(const TexelBatch& batch, int i, std::uint32_t texel,
                      std::vector<TexelWrite>& out);
  Vec3f own_vector(int x, int y, const Vec3f& base, const Mat3f& frame) const;
  static SurfacePoint gutter_source(const GutterTexel& g);
  Vec3f gutter_vector(const GutterTexel& g, const Mat3f& frame, const Vec3f& own,
                      const PushTriangle& source, float strength) const;
  void edit_gutter(const PerLane<const GutterTexel*>& items, Cache& triangles, TexelBatch& batch,
                   std::vector<TexelWrite>& out) const;
  void edit_shared(const PerLane<const SharedTexel*>& items, Cache& triangles, TexelBatch& batch,
                   std::vector<TexelWrite>& out) const;
  void drop_lanes_of_owners(const PerLane<const SharedTexel*>& items, Cache& triangles,
                            TexelBatch& batch) const;
  Tally write(const std::vector<TexelWrite>& writes);
  TexelPlace texel(std::uint32_t index) const { return texel_place(index, set_.normals.width()); }

  const Mesh& mesh_;
  const EditSampler& sampler_;
  StorageSet& set_;
  NormalSpace space_;
  PushCandidates candidates_;
  std::vector<TexelWrite> shared_;  // of texels that their owners leave to others
};

void SetPush::add_texels(std::uint32_t owner, int x, int y, int count, Cache& triangles,
                         TexelBatch& batch) const {
  const PushTriangle& triangle = triangles.get(owner);
  const TexelAffine& affine = set_.texels.affines()[owner];
  if (!affine.wraps) {
    add_run(triangle, affine, x, y, count, batch);
    return;
  }
  for (int i = 0; i < count; ++i) {
    const SurfacePoint p = set_.texels.surface_point(owner, x + i, y);
    batch.add_point(triangle, {1.0F, p.b1, p.b2});
  }
}

void SetPush::find_runs(const Rect& tile, int y, std::vector<Run>& runs) const {
  const std::uint32_t* owners = set_.texels.owner().row(y);
  runs.clear();
  for (int x = tile.x0; x < tile.x1;) {
    const int begin = x;
    const std::uint32_t owner = owners[begin];
    while (x < tile.x1 && owners[x] == owner) ++x;
    if (owner == no_triangle || !candidates_.contains(owner)) continue;
    runs.push_back({begin, x - begin, owner});
  }
}

/// Fills the batch with a row's texels.
void SetPush::find_texels(const std::vector<Run>& runs, int y, Task& task) const {
  task.batch.count = 0;
  for (const Run& run : runs) {
    const auto lane = static_cast<std::size_t>(task.batch.count);
    for (int i = 0; i < run.count; ++i) {
      task.columns[lane + static_cast<std::size_t>(i)] = run.x + i;
      task.owners[lane + static_cast<std::size_t>(i)] = run.owner;
    }
    add_texels(run.owner, run.x, y, run.count, task.triangles, task.batch);
  }
}

void SetPush::fill_frames(const PerLane<std::uint32_t>& triangles, TexelBatch& batch) const {
  if (space_ == NormalSpace::Tangent) {
    finish_frames(batch);
    return;
  }
  const View& view = sampler_.grid().view;
  for (int i = 0; i < batch.count; ++i) {
    Mat3f frame;
    frame << view.right.transpose(), view.up.transpose(), view.direction.transpose();
    if (space_ == NormalSpace::Object) {
      frame *= mesh_.node_frame(triangles[static_cast<std::size_t>(i)]);
    }
    batch.set_frame(i, frame);
  }
}

Tally SetPush::edit_row(int y, Task& task) {
  TexelBatch& batch = task.batch;
  Tally tally;
  tally.visited = static_cast<std::size_t>(batch.count);
  if (batch.count == 0 || !sampler_.read(batch)) return tally;
  fill_frames(task.owners, batch);
  const int x0 = task.columns[0];
  const int x1 = task.columns[static_cast<std::size_t>(batch.count - 1)] + 1;
  set_.normals.read_vectors(x0, x1 - x0, y, task.stored.data());
  for (int i = 0; i < batch.count; ++i) {
    const int column = task.columns[static_cast<std::size_t>(i)];
    batch.stored.set(i, task.stored[static_cast<std::size_t>(column - x0)]);
  }
  apply(sampler_.mode(), batch);
  for (int i = 0; i < batch.count; ++i) {
    if (!batch.acts(i)) continue;
    const auto k = static_cast<std::size_t>(i);
    if (!shared_.empty() && is_taken(task.columns[k], y)) continue;
    set_.normals.set_normal(task.columns[k], y, batch.result.get(i));
    tally.largest = std::max(tally.largest, batch.turn[k]);
    ++tally.changed;
  }
  return tally;
}

/// Does another triangle than its owner decide what a texel gets?
bool SetPush::is_taken(int x, int y) const {
  const std::uint32_t index =
      static_cast<std::uint32_t>(y) * static_cast<std::uint32_t>(set_.normals.width()) +
      static_cast<std::uint32_t>(x);
  const auto found =
      std::lower_bound(shared_.begin(), shared_.end(), index,
                       [](const TexelWrite& w, std::uint32_t t) { return w.texel < t; });
  return found != shared_.end() && found->texel == index;
}

Tally SetPush::push_tile(const Rect& tile, Task& task) {
  // Rows are looked through 4 ahead, and their triangles fetched in two steps.
  const auto look_ahead = [&](int row) {
    if (row + 4 < tile.height()) {
      std::vector<Run>& runs = task.runs[static_cast<std::size_t>(row + 4)];
      find_runs(tile, tile.y0 + row + 4, runs);
      for (const Run& run : runs) task.triangles.announce_attributes(run.owner);
    }
    if (row + 2 < 0 || row + 2 >= tile.height()) return;
    for (const Run& run : task.runs[static_cast<std::size_t>(row + 2)]) {
      task.triangles.announce_positions(run.owner);
    }
  };
  Tally tally;
  for (int row = -4; row < 0; ++row) look_ahead(row);
  for (int row = 0; row < tile.height(); ++row) {
    look_ahead(row);
    find_texels(task.runs[static_cast<std::size_t>(row)], tile.y0 + row, task);
    tally.add(edit_row(tile.y0 + row, task));
  }
  return tally;
}

/// The texel's vector; codes without a direction count as the base normal.
Vec3f SetPush::own_vector(int x, int y, const Vec3f& base, const Mat3f& frame) const {
  Vec3f stored = set_.normals.vector(x, y);
  if (!codes::direction_of(stored).isZero()) return stored;
  if (space_ == NormalSpace::Tangent) return Vec3f::UnitZ();
  return frame.inverse() * base;
}

/// Where a gutter texel's edit is read: beside a hard edge on the chart's own side of it.
SurfacePoint SetPush::gutter_source(const GutterTexel& g) {
  return g.hard_edge ? SurfacePoint{g.owner, g.border_b1, g.border_b2} : g.source;
}

/// What a gutter texel held before the edit, in its own frame. Where the edit is weak that is its
/// code; the stronger it is, the more the texel is grown anew from the surface that it stands for:
/// else a filter would leave there what it takes away on the other side of the seam.
Vec3f SetPush::gutter_vector(const GutterTexel& g, const Mat3f& frame, const Vec3f& own,
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

void SetPush::edit_gutter(const PerLane<const GutterTexel*>& items, Cache& triangles,
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
  for (int i = 0; i < batch.count; ++i) {
    collect(batch, i, items[static_cast<std::size_t>(i)]->texel, out);
  }
}

void SetPush::collect(const TexelBatch& batch, int i, std::uint32_t texel,
                      std::vector<TexelWrite>& out) {
  const auto k = static_cast<std::size_t>(i);
  if (batch.acts(i)) out.push_back({texel, batch.weight[k], batch.turn[k], batch.result.get(i)});
}

/// A gutter texel takes the change of the surface point across the seam that it stands for, in the
/// frame of the chart beside it, which decodes it. Beside a hard edge it takes that of the border.
std::vector<TexelWrite> SetPush::gutter_writes() const {
  return collect_writes(
      set_.texels.gutter(), mesh_, sampler_.grid(),
      [&](const GutterTexel& g) { return candidates_.contains(gutter_source(g).triangle); },
      [&](const GutterTexel& g, Cache& triangles, TexelBatch& batch) {
        const SurfacePoint p = gutter_source(g);
        batch.add_point(triangles.get(p.triangle), {1.0F, p.b1, p.b2});
      },
      [&](const auto& items, Cache& triangles, TexelBatch& batch, std::vector<TexelWrite>& out) {
        edit_gutter(items, triangles, batch, out);
      });
}

/// Where the owner's edit acts with as large a weight, it decides.
void SetPush::drop_lanes_of_owners(const PerLane<const SharedTexel*>& items, Cache& triangles,
                                   TexelBatch& batch) const {
  TexelBatch owners;
  PerLane<int> lanes;
  for (int i = 0; i < batch.count; ++i) {
    const auto [x, y] = texel(items[static_cast<std::size_t>(i)]->texel);
    const std::uint32_t owner = set_.texels.owner()(x, y);
    if (!batch.acts(i) || !candidates_.contains(owner)) continue;
    lanes[static_cast<std::size_t>(owners.count)] = i;
    const SurfacePoint p = set_.texels.surface_point(owner, x, y);
    owners.add_point(triangles.get(owner), {1.0F, p.b1, p.b2});
  }
  if (owners.count == 0 || !sampler_.read(owners)) return;
  for (int i = 0; i < owners.count; ++i) {
    const auto k = static_cast<std::size_t>(lanes[static_cast<std::size_t>(i)]);
    const float weight = owners.weight[static_cast<std::size_t>(i)];
    if (!owners.acts(i) || outweighs(batch.weight[k], weight)) continue;
    batch.change_x[k] = batch.change_y[k] = batch.covered[k] = 0.0F;
  }
}

void SetPush::edit_shared(const PerLane<const SharedTexel*>& items, Cache& triangles,
                          TexelBatch& batch, std::vector<TexelWrite>& out) const {
  if (!sampler_.read(batch)) return;
  drop_lanes_of_owners(items, triangles, batch);
  PerLane<std::uint32_t> ids{};
  for (int i = 0; i < batch.count; ++i) {
    const SharedTexel& s = *items[static_cast<std::size_t>(i)];
    ids[static_cast<std::size_t>(i)] = s.triangle;
    const auto [x, y] = texel(s.texel);
    batch.stored.set(i, set_.normals.vector(x, y));
  }
  fill_frames(ids, batch);
  apply(sampler_.mode(), batch);
  for (int i = 0; i < batch.count; ++i) {
    collect(batch, i, items[static_cast<std::size_t>(i)]->texel, out);
  }
}

/// Texels that further triangles cover, which the chart sees more squarely than their owner.
std::vector<TexelWrite> SetPush::shared_writes() const {
  return collect_writes(
      set_.texels.shared(), mesh_, sampler_.grid(),
      [&](const SharedTexel& s) { return candidates_.contains(s.triangle); },
      [&](const SharedTexel& s, Cache& triangles, TexelBatch& batch) {
        const auto [x, y] = texel(s.texel);
        const SurfacePoint p = set_.texels.surface_point(s.triangle, x, y);
        batch.add_point(triangles.get(s.triangle), {1.0F, p.b1, p.b2});
      },
      [&](const auto& items, Cache& triangles, TexelBatch& batch, std::vector<TexelWrite>& out) {
        edit_shared(items, triangles, batch, out);
      });
}

Tally SetPush::write(const std::vector<TexelWrite>& writes) {
  Tally tally;
  for (const TexelWrite& w : writes) {
    const auto [x, y] = texel(w.texel);
    set_.normals.set_normal(x, y, w.normal);
    tally.largest = std::max(tally.largest, w.turn);
    ++tally.changed;
  }
  return tally;
}

Tally SetPush::run() {
  // Before any texel changes: the gutter reads normals across its seams.
  shared_ = shared_writes();
  keep_strongest(shared_);
  std::vector<TexelWrite> gutter = gutter_writes();
  keep_strongest(gutter);
  const std::vector<Rect> tiles = candidates_.tiles();
  Tally tally;
  std::mutex mutex;
  parallel_for(tiles.size(), 1, [&](std::size_t begin, std::size_t end) {
    Tally local;
    Task task{{mesh_, sampler_.grid()}, {}, {}, {}, {}, {}};
    for (std::size_t i = begin; i < end; ++i) local.add(push_tile(tiles[i], task));
    const std::lock_guard lock(mutex);
    tally.add(local);
  });
  tally.add(write(shared_));
  tally.add(write(gutter));
  return tally;
}

}  // namespace

PushResult push(const Mesh& mesh, const EditingChart& chart, const ChartEdit& edit,
                StorageAtlas& storage) {
  const EditSampler sampler(chart, edit);
  Tally tally;
  for (std::size_t i = 0; i < storage.sets.size(); ++i) {
    SetPush set(mesh, sampler, storage.sets[i], static_cast<std::uint32_t>(i));
    tally.add(set.run());
  }
  const float half_sine = std::sqrt(std::min(1.0F, 0.5F * tally.largest));
  return {tally.visited, tally.changed, 2.0F * std::asin(half_sine) * 180.0F / 3.14159265F};
}

}  // namespace normalshop
