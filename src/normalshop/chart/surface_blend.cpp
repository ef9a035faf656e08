#include "normalshop/chart/surface_blend.h"

#include "normalshop/chart/cover.h"
#include "normalshop/chart/set_push.h"

namespace normalshop {

namespace {

constexpr int side = NormalMap::tile_size;
/// Squared: what adding up leaves of no change, a thirtieth of a 16-bit code.
constexpr float least_turn = 1e-12F;

std::size_t index_of(int x, int y) {
  return static_cast<std::size_t>((y % side) * side + x % side);
}

Vec3f unit_or_zero(const Vec3f& v) {
  const Vec3f direction = codes::direction_of(v);
  return direction.isZero() ? direction : Vec3f(direction.normalized());
}

}  // namespace

struct SurfaceBlend::Target {
  static constexpr bool reads_facing = true;
  const NormalMap& normals;
  Tiles& tiles;

  void put(int x, int y, const TexelWrite& write) {
    auto& tile = tiles[static_cast<std::size_t>(y / side * NormalMap::tiles_along(normals.width()) +
                                                x / side)];
    if (!tile) tile = std::make_unique<Tile>();
    const std::size_t i = index_of(x, y);
    const float factor = facing_share(write.facing);
    // The weight is in what the normal turns by already.
    tile->turned[i] += factor * (write.value - unit_or_zero(normals.vector(x, y)));
    tile->share[i] += factor * write.weight;
    tile->weight[i] += write.weight;
  }
};

SurfaceBlend::SurfaceBlend(const StorageAtlas& storage) {
  for (const StorageSet& set : storage.sets) {
    sets_.emplace_back(static_cast<std::size_t>(NormalMap::tiles_along(set.normals.width())) *
                       static_cast<std::size_t>(NormalMap::tiles_along(set.normals.height())));
  }
}

void SurfaceBlend::add(const Mesh& mesh, const EditingChart& chart, const ChartEdit& edit,
                       const StorageAtlas& storage) {
  const EditSampler sampler(chart, edit);
  for (std::size_t i = 0; i < storage.sets.size(); ++i) {
    Target target{storage.sets[i].normals, sets_[i]};
    SetPush push(mesh, sampler, storage.sets[i], static_cast<std::uint32_t>(i), target);
    visited_ += push.run().visited;
  }
}

PushResult SurfaceBlend::write(StorageAtlas& storage) const {
  PushTally all;
  std::mutex mutex;
  for (std::size_t s = 0; s < sets_.size(); ++s) {
    NormalMap& map = storage.sets[s].normals;
    const int columns = NormalMap::tiles_along(map.width());
    parallel_for(sets_[s].size(), 16, [&](std::size_t begin, std::size_t end) {
      PushTally local;
      for (std::size_t t = begin; t < end; ++t) {
        const Tile* tile = sets_[s][t].get();
        if (tile == nullptr) continue;
        const int x0 = static_cast<int>(t) % columns * side;
        const int y0 = static_cast<int>(t) / columns * side;
        for (int i = 0; i < side * side; ++i) {
          const auto k = static_cast<std::size_t>(i);
          if (!(tile->share[k] > 0.0F)) continue;
          const int x = x0 + i % side;
          const int y = y0 + i / side;
          const Vec3f before = unit_or_zero(map.vector(x, y));
          const float part = std::min(1.0F, tile->weight[k]) / tile->share[k];
          const Vec3f after = before + part * tile->turned[k];
          if (!after.allFinite() || !(after.norm() > 1e-6F)) continue;
          const Vec3f normal = after.normalized();
          if ((normal - before).squaredNorm() < least_turn) continue;
          map.set_normal(x, y, normal);
          if (!before.isZero()) local.largest = std::max(local.largest, 1.0F - normal.dot(before));
          ++local.changed;
        }
      }
      const std::lock_guard lock(mutex);
      all.add(local);
    });
  }
  return {visited_, all.changed, degrees_of_turn(all.largest)};
}

}  // namespace normalshop
