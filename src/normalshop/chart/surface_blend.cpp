#include "normalshop/chart/surface_blend.h"

#include "normalshop/chart/cover.h"
#include "normalshop/chart/set_push.h"
#include "normalshop/core/normal_codes.h"

namespace normalshop {

namespace {

/// Squared: what adding up leaves of no change, a thirtieth of a 16-bit code.
constexpr float least_turn = 1e-12F;

Vec3f unit_or_zero(const Vec3f& v) {
  const Vec3f direction = codes::direction_of(v);
  return direction.isZero() ? direction : Vec3f(direction.normalized());
}

}  // namespace

struct SurfaceBlend::Target {
  static constexpr auto facing = NormalEditor::Facing::Told;
  const NormalMap& normals;
  const std::vector<std::uint8_t>& part;
  Tiles& tiles;

  void put(int x, int y, const TexelWrite& write) {
    if (!part.empty() && part[write.triangle] == 0) return;
    auto& tile = tiles[static_cast<std::size_t>(y / side * NormalMap::tiles_along(normals.width()) +
                                                x / side)];
    if (!tile) tile = std::make_unique<Tile>();
    const std::size_t i = NormalMap::index_in_tile(x, y);
    if (!tile->take(i, write.triangle)) return;
    const float factor = facing_share(write.facing);
    // The weight is in what the normal turns by already.
    tile->turned[i] += factor * (write.value - unit_or_zero(normals.vector(x, y)));
    tile->share[i] += factor * write.weight;
    tile->weight[i] += write.weight;
  }
};

/// Whether a triangle may have a texel; it loses what later ones did to it.
bool SurfaceBlend::Tile::take(std::size_t i, std::uint32_t by) {
  if (by > triangle[i]) return false;
  if (by < triangle[i]) {
    triangle[i] = by;
    turned[i] = Vec3f::Zero();
    share[i] = weight[i] = 0.0F;
  }
  return true;
}

SurfaceBlend::SurfaceBlend(const StorageAtlas& storage, std::vector<std::uint8_t> part)
    : part_(std::move(part)) {
  for (const StorageSet& set : storage.sets) {
    sets_.emplace_back(static_cast<std::size_t>(NormalMap::tiles_along(set.normals.width())) *
                       static_cast<std::size_t>(NormalMap::tiles_along(set.normals.height())));
  }
}

void SurfaceBlend::add(const Mesh& mesh, const EditingChart& chart, const ChartEdit& edit,
                       const StorageAtlas& storage) {
  const EditSampler sampler(chart, edit);
  for (std::size_t i = 0; i < storage.sets.size(); ++i) {
    Target target{storage.sets[i].normals, part_, sets_[i]};
    SetPush push(mesh, sampler, storage.sets[i], static_cast<std::uint32_t>(i), target);
    visited_ += push.run().visited;
  }
}

/// What the sums make of one texel; zero where they leave it as it is.
Vec3f SurfaceBlend::Tile::result(std::size_t i, const Vec3f& before) const {
  const float part = std::min(1.0F, weight[i]) / share[i];
  const Vec3f after = before + part * turned[i];
  if (!after.allFinite() || !(after.norm() > 1e-6F)) return Vec3f::Zero();
  const Vec3f normal = after.normalized();
  return (normal - before).squaredNorm() < least_turn ? Vec3f(Vec3f::Zero()) : normal;
}

PushTally SurfaceBlend::write_tile(const Tile& tile, int x0, int y0, StorageSet& set) {
  PushTally tally;
  NormalMap& map = set.normals;
  SharedCursor covered(set.texels.shared());
  for (int i = 0; i < side * side; ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (!(tile.share[k] > 0.0F)) continue;
    const int x = x0 + i % side;
    const int y = y0 + i / side;
    const Vec3f before = unit_or_zero(map.vector(x, y));
    const Vec3f normal = tile.result(k, before);
    if (normal.isZero()) continue;
    map.set_normal(x, y, normal);
    if (!before.isZero()) tally.largest = std::max(tally.largest, 1.0F - normal.dot(before));
    ++tally.changed;
    if (covered.holds(texel_index(x, y, map.width()))) ++tally.shared;
  }
  return tally;
}

PushResult SurfaceBlend::write(StorageAtlas& storage) const {
  PushTally all;
  std::mutex mutex;
  for (std::size_t s = 0; s < sets_.size(); ++s) {
    StorageSet& set = storage.sets[s];
    const int columns = NormalMap::tiles_along(set.normals.width());
    parallel_for(sets_[s].size(), 16, [&](std::size_t begin, std::size_t end) {
      PushTally local;
      for (std::size_t t = begin; t < end; ++t) {
        const auto i = static_cast<int>(t);
        if (!sets_[s][t]) continue;
        local.add(write_tile(*sets_[s][t], i % columns * side, i / columns * side, set));
      }
      const std::lock_guard lock(mutex);
      all.add(local);
    });
  }
  all.visited = visited_;
  return result_of(all);
}

}  // namespace normalshop
