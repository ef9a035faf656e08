#include "normalshop/chart/push.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <mutex>
#include <vector>

#include <Eigen/LU>

#include "normalshop/chart/chart_triangle.h"
#include "normalshop/chart/edit_sampler.h"
#include "normalshop/chart/texel_batch.h"
#include "normalshop/core/normal_codes.h"
#include "normalshop/core/parallel.h"

namespace normalshop {

namespace {

constexpr int tile_size = NormalMap::tile_size;

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

/// A texel outside the plain owner pass and its new normal.
struct Write {
  std::uint32_t texel;
  Vec3f normal;
};

/// The push into one texture set.
class SetPush {
 public:
  SetPush(const Mesh& mesh, const EditSampler& sampler, StorageSet& set, std::uint32_t index);
  Tally run();

 private:
  using Cache = TriangleCache<PushTriangle>;

  bool may_change(std::uint32_t triangle) const;
  void find_candidates();
  void mark_tiles(std::uint32_t triangle);
  Tally push_tile(int tile, Cache& triangles, TexelBatch& batch);
  std::vector<Write> gutter_writes() const;
  std::vector<Write> shared_writes() const;
  Vec3f texel_weights(std::uint32_t triangle, int x, int y) const;
  Vec3f usable_vector(int x, int y, const Vec3f& base, const Mat3f& frame) const;
  Vec3f gutter_vector(const GutterTexel& g, const Mat3f& frame, const Vec3f& own,
                      const PushTriangle& source, const Effect& effect) const;
  void add_texel(int x, int y, const ChartTriangle& frame, const Vec3f& weights,
                 const Effect& effect, const Vec3f& base, TexelBatch& batch) const;
  Vec3f edited(int x, int y, const ChartTriangle& frame, const Vec3f& weights, const Effect& effect,
               const Vec3f& base) const;
  Tally write(const std::vector<Write>& writes);

  const Mesh& mesh_;
  const EditSampler& sampler_;
  StorageSet& set_;
  std::uint32_t index_;
  NormalSpace space_;
  int tile_columns_;
  std::vector<std::uint8_t> candidate_;  // per triangle of the mesh
  std::vector<std::uint8_t> tile_used_;
};

SetPush::SetPush(const Mesh& mesh, const EditSampler& sampler, StorageSet& set, std::uint32_t index)
    : mesh_(mesh),
      sampler_(sampler),
      set_(set),
      index_(index),
      space_(set.normals.convention().space),
      tile_columns_((set.normals.width() + tile_size - 1) / tile_size),
      candidate_(mesh.triangle_count(), 0),
      tile_used_(static_cast<std::size_t>(tile_columns_ *
                                          ((set.normals.height() + tile_size - 1) / tile_size))) {}

/// May the triangle hold points that the edit changes?
bool SetPush::may_change(std::uint32_t triangle) const {
  if (mesh_.texture_sets[triangle] != index_) return false;
  const std::size_t corner = 3 * static_cast<std::size_t>(triangle);
  const Vec3f& toward = sampler_.grid().view.direction;
  if (mesh_.normals[corner].dot(toward) <= 0.0F && mesh_.normals[corner + 1].dot(toward) <= 0.0F &&
      mesh_.normals[corner + 2].dot(toward) <= 0.0F) {
    return false;
  }
  const ChartGrid& grid = sampler_.grid();
  const Vec3f a = grid.project(mesh_.position(corner));
  const Vec3f b = grid.project(mesh_.position(corner + 1));
  const Vec3f c = grid.project(mesh_.position(corner + 2));
  const Vec3f low = a.cwiseMin(b).cwiseMin(c);
  const Vec3f high = a.cwiseMax(b).cwiseMax(c);
  return sampler_.reaches(low.x(), low.y(), high.x(), high.y());
}

void SetPush::find_candidates() {
  parallel_for(mesh_.triangle_count(), 8192, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto triangle = static_cast<std::uint32_t>(i);
      if (!may_change(triangle)) continue;
      candidate_[i] = 1;
      mark_tiles(triangle);
    }
  });
}

void SetPush::mark_tiles(std::uint32_t triangle) {
  const Vec2f size(static_cast<float>(set_.normals.width()),
                   static_cast<float>(set_.normals.height()));
  const std::size_t corner = 3 * static_cast<std::size_t>(triangle);
  const Vec2f a = mesh_.uvs[corner].cwiseProduct(size);
  const Vec2f b = mesh_.uvs[corner + 1].cwiseProduct(size);
  const Vec2f c = mesh_.uvs[corner + 2].cwiseProduct(size);
  const Vec2f low = a.cwiseMin(b).cwiseMin(c);
  const Vec2f high = a.cwiseMax(b).cwiseMax(c);
  const auto wrap = [](int v, int n) { return ((v % n) + n) % n; };
  // Whole maps further on come the same texels again.
  const int x0 = floor_to_int(low.x());
  const int y0 = floor_to_int(low.y());
  const int x1 = std::min(floor_to_int(high.x()), x0 + set_.normals.width());
  const int y1 = std::min(floor_to_int(high.y()), y0 + set_.normals.height());
  const auto next = [](int v, int n, int w) {  // first texel of the next tile, or of the next map
    return v + std::min(tile_size - w % tile_size, n - w);
  };
  for (int y = y0; y <= y1;) {
    const int wy = wrap(y, set_.normals.height());
    for (int x = x0; x <= x1;) {
      const int wx = wrap(x, set_.normals.width());
      // Several threads may mark one tile; the mark is the same.
      std::atomic_ref(
          tile_used_[static_cast<std::size_t>(wy / tile_size * tile_columns_ + wx / tile_size)])
          .store(1, std::memory_order_relaxed);
      x = next(x, set_.normals.width(), wx);
    }
    y = next(y, set_.normals.height(), wy);
  }
}

/// The texel's vector; codes without a direction count as the base normal.
Vec3f SetPush::usable_vector(int x, int y, const Vec3f& base, const Mat3f& frame) const {
  Vec3f stored = set_.normals.vector(x, y);
  if (!codes::direction_of(stored).isZero()) return stored;
  if (space_ == NormalSpace::Tangent) return Vec3f::UnitZ();
  return frame.inverse() * base;
}

/// Adds a texel whose code refers to `frame` at `weights`; `base` is the edited surface's.
void SetPush::add_texel(int x, int y, const ChartTriangle& frame, const Vec3f& weights,
                        const Effect& effect, const Vec3f& base, TexelBatch& batch) const {
  const View& view = sampler_.grid().view;
  const Mat3f m = frame.frame(weights, frame.normals * weights, space_, view);
  batch.add(m, base, usable_vector(x, y, base, m), effect);
}

Tally SetPush::push_tile(int tile, Cache& triangles, TexelBatch& batch) {
  Tally tally;
  const int x0 = tile % tile_columns_ * tile_size;
  const int y0 = tile / tile_columns_ * tile_size;
  const Rect rect = intersect({x0, y0, x0 + tile_size, y0 + tile_size}, set_.texels.owner().rect());
  const auto announce = [&](int y) {
    const auto owners = [&](int row) {
      const bool inside = row >= rect.y0 && row < rect.y1;
      return inside ? set_.texels.owner().row(row) + rect.x0 : nullptr;
    };
    triangles.announce(owners(y + 2), owners(y + 4), rect.width());
  };
  for (int y = rect.y0 - 4; y < rect.y0; ++y) announce(y);
  for (int y = rect.y0; y < rect.y1; ++y) {
    announce(y);
    std::array<int, TexelBatch::capacity> columns{};
    batch.count = 0;
    for (int x = rect.x0; x < rect.x1; ++x) {
      const std::uint32_t owner = set_.texels.owner().row(y)[x];
      if (owner == no_triangle || candidate_[owner] == 0) continue;
      ++tally.visited;
      const Vec3f weights = texel_weights(owner, x, y);
      const PushTriangle& triangle = triangles.get(owner);
      Vec3f base;
      const Effect effect = sampler_.at(triangle, weights, base);
      if (!effect.any()) continue;
      columns[static_cast<std::size_t>(batch.count)] = x;
      add_texel(x, y, triangle, weights, effect, base, batch);
    }
    apply(sampler_.mode(), batch);
    for (int i = 0; i < batch.count; ++i) {
      const auto k = static_cast<std::size_t>(i);
      set_.normals.set_normal(columns[k], y, batch.result.get(i));
      tally.largest = std::max(tally.largest, batch.turn[k]);
    }
    tally.changed += static_cast<std::size_t>(batch.count);
  }
  return tally;
}

Vec3f SetPush::texel_weights(std::uint32_t triangle, int x, int y) const {
  const TexelAffine& affine = set_.texels.affines()[triangle];
  if (affine.wraps) {
    const SurfacePoint p = set_.texels.surface_point(triangle, x, y);
    return {1.0F, p.b1, p.b2};
  }
  const float dx = static_cast<float>(x) - affine.x0;
  const float dy = static_cast<float>(y) - affine.y0;
  return {1.0F, affine.origin_weights.x() + dx * affine.db_dx.x() + dy * affine.db_dy.x(),
          affine.origin_weights.y() + dx * affine.db_dx.y() + dy * affine.db_dy.y()};
}

/// The new normal of a single texel.
Vec3f SetPush::edited(int x, int y, const ChartTriangle& frame, const Vec3f& weights,
                      const Effect& effect, const Vec3f& base) const {
  TexelBatch batch;
  add_texel(x, y, frame, weights, effect, base, batch);
  apply(sampler_.mode(), batch);
  return batch.result.get(0);
}

/// What body(item, triangles, writes) writes for all items, in their order.
template <class Item, class Body>
std::vector<Write> collect(const std::vector<Item>& items, const Mesh& mesh, const ChartGrid& grid,
                           const Body& body) {
  constexpr std::size_t run = 4096;
  std::vector<std::vector<Write>> parts((items.size() + run - 1) / run);
  parallel_for(parts.size(), 1, [&](std::size_t begin, std::size_t end) {
    TriangleCache<PushTriangle> triangles(mesh, grid);
    for (std::size_t part = begin; part < end; ++part) {
      for (std::size_t i = part * run; i < std::min(items.size(), (part + 1) * run); ++i) {
        body(items[i], triangles, parts[part]);
      }
    }
  });
  std::vector<Write> all;
  for (const auto& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

/// What a gutter texel held before the edit, in its own frame. Where the edit is weak that is its
/// code; the stronger it is, the more the texel is grown anew from the surface that it stands for:
/// else a filter would leave there what it takes away on the other side of the seam.
Vec3f SetPush::gutter_vector(const GutterTexel& g, const Mat3f& frame, const Vec3f& own,
                             const PushTriangle& source, const Effect& effect) const {
  if (g.source.triangle == g.owner) return own;
  const Vec3f weights(1.0F, g.source.b1, g.source.b2);
  const std::size_t corner = 3 * static_cast<std::size_t>(g.source.triangle);
  const Vec2f uv = interpolate(mesh_.uvs[corner], mesh_.uvs[corner + 1], mesh_.uvs[corner + 2],
                               g.source.b1, g.source.b2);
  const Mat3f across =
      source.frame(weights, source.normals * weights, space_, sampler_.grid().view);
  const Vec3f grown = frame.inverse() * (across * set_.normals.sample(uv));
  if (!grown.allFinite() || grown.isZero()) return own;
  constexpr float strong = 0.05F;  // a slope of three degrees
  const float share =
      std::min(1.0F, effect.weight * (effect.change.norm() + effect.coverage) / strong);
  return (1.0F - share) * own.normalized() + share * grown.normalized();
}

/// A gutter texel takes the change of the surface point across the seam that it stands for, in the
/// frame of the chart beside it, which decodes it.
std::vector<Write> SetPush::gutter_writes() const {
  const View& view = sampler_.grid().view;
  const auto visit = [&](const GutterTexel& g, Cache& triangles, std::vector<Write>& out) {
    if (candidate_[g.source.triangle] == 0) return;
    Vec3f base;
    const PushTriangle source = triangles.get(g.source.triangle);
    const Effect effect = sampler_.at(source, {1.0F, g.source.b1, g.source.b2}, base);
    if (!effect.any()) return;
    const int x = static_cast<int>(g.texel) % set_.normals.width();
    const int y = static_cast<int>(g.texel) / set_.normals.width();
    TexelBatch batch;
    const PushTriangle& owner = triangles.get(g.owner);
    const Vec3f weights(1.0F, g.owner_b1, g.owner_b2);
    const Mat3f frame = owner.frame(weights, owner.normals * weights, space_, view);
    const Vec3f own = usable_vector(x, y, base, frame);
    batch.add(frame, base, gutter_vector(g, frame, own, source, effect), effect);
    apply(sampler_.mode(), batch);
    out.push_back({g.texel, batch.result.get(0)});
  };
  return collect(set_.texels.gutter(), mesh_, sampler_.grid(), visit);
}

/// Texels that further triangles cover: where the owner's edit does nothing, the first of them that
/// the edit reaches decides.
std::vector<Write> SetPush::shared_writes() const {
  const auto visit = [&](const SharedTexel& s, Cache& triangles, std::vector<Write>& out) {
    if (candidate_[s.triangle] == 0) return;
    const int x = static_cast<int>(s.texel) % set_.normals.width();
    const int y = static_cast<int>(s.texel) / set_.normals.width();
    const std::uint32_t owner = set_.texels.owner()(x, y);
    Vec3f base;
    if (candidate_[owner] != 0) {
      const SurfacePoint p = set_.texels.surface_point(owner, x, y);
      if (sampler_.at(triangles.get(owner), {1.0F, p.b1, p.b2}, base).any()) return;
    }
    const SurfacePoint point = set_.texels.surface_point(s.triangle, x, y);
    const Vec3f weights(1.0F, point.b1, point.b2);
    const PushTriangle& triangle = triangles.get(s.triangle);
    const Effect effect = sampler_.at(triangle, weights, base);
    if (!effect.any()) return;
    out.push_back({s.texel, edited(x, y, triangle, weights, effect, base)});
  };
  return collect(set_.texels.shared(), mesh_, sampler_.grid(), visit);
}

Tally SetPush::write(const std::vector<Write>& writes) {
  Tally tally;
  for (std::size_t i = 0; i < writes.size(); ++i) {
    if (i > 0 && writes[i].texel == writes[i - 1].texel) continue;
    const int x = static_cast<int>(writes[i].texel) % set_.normals.width();
    const int y = static_cast<int>(writes[i].texel) / set_.normals.width();
    set_.normals.set_normal(x, y, writes[i].normal);
    ++tally.changed;
  }
  return tally;
}

Tally SetPush::run() {
  find_candidates();
  // Before any texel changes: the gutter reads normals across its seams.
  const std::vector<Write> shared = shared_writes();
  const std::vector<Write> gutter = gutter_writes();
  std::vector<int> tiles;
  for (std::size_t i = 0; i < tile_used_.size(); ++i) {
    if (tile_used_[i] != 0) tiles.push_back(static_cast<int>(i));
  }
  Tally tally;
  std::mutex mutex;
  parallel_for(tiles.size(), 1, [&](std::size_t begin, std::size_t end) {
    Tally local;
    Cache triangles(mesh_, sampler_.grid());
    TexelBatch batch;
    for (std::size_t i = begin; i < end; ++i) local.add(push_tile(tiles[i], triangles, batch));
    const std::lock_guard lock(mutex);
    tally.add(local);
  });
  tally.add(write(shared));
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
