#include "normalshop/chart/update_storage.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include <Eigen/LU>

#include "normalshop/chart/details.h"
#include "normalshop/chart/push_tally.h"
#include "normalshop/chart/shared_cursor.h"
#include "normalshop/chart/texel_writes.h"
#include "normalshop/core/parallel.h"

namespace normalshop {

namespace {

constexpr int update_tile = NormalMap::tile_size;
constexpr auto texels_a_tile = static_cast<std::size_t>(update_tile * update_tile);

/// The pixels of a region by the tile of the atlas that they show, in a tile from the first to the
/// last: what one task writes no other reads.
class PixelsByTile {
 public:
  PixelsByTile(const Mesh& mesh, const EditingChart& chart, const Rect& region,
               const StorageAtlas& storage)
      : mesh_(mesh), chart_(chart), region_(region) {
    std::size_t tiles = 0;
    for (const StorageSet& set : storage.sets) {
      first_.push_back(tiles);
      widths_.push_back(static_cast<std::uint32_t>(set.normals.width()));
      columns_.push_back(static_cast<std::size_t>(NormalMap::tiles_along(set.normals.width())));
      tiles +=
          columns_.back() * static_cast<std::size_t>(NormalMap::tiles_along(set.normals.height()));
    }
    sort(tiles);
  }

  std::size_t count() const { return begin_.size() - 1; }
  std::span<const std::uint32_t> pixels(std::size_t tile) const {
    return {pixels_.data() + begin_[tile], begin_[tile + 1] - begin_[tile]};
  }

 private:
  static constexpr int rows_a_chunk = 64;

  template <class Visit>
  void visit_chunk(std::size_t chunk, const Visit& visit) const {
    const int y0 = region_.y0 + static_cast<int>(chunk) * rows_a_chunk;
    for (int y = y0; y < std::min(y0 + rows_a_chunk, region_.y1); ++y) {
      for (int x = region_.x0; x < region_.x1; ++x) {
        const std::uint32_t triangle = chart_.ids.triangle(x, y);
        if (triangle == no_triangle || !(chart_.weight(x, y) > 0.0F)) continue;
        const std::size_t set = mesh_.texture_sets[triangle];
        const std::uint32_t texel = chart_.texel(x, y);
        const std::size_t column = texel % widths_[set] / update_tile;
        const std::size_t row = texel / widths_[set] / update_tile;
        visit(first_[set] + row * columns_[set] + column,
              static_cast<std::uint32_t>(y * chart_.grid.width() + x));
      }
    }
  }
  void sort(std::size_t tiles);

  const Mesh& mesh_;
  const EditingChart& chart_;
  Rect region_;
  std::vector<std::size_t> first_;  // per set: its first tile
  std::vector<std::uint32_t> widths_;
  std::vector<std::size_t> columns_;
  std::vector<std::uint32_t> pixels_;
  std::vector<std::size_t> begin_;  // per tile, plus one
};

/// Counts, then places: chunk after chunk in each tile.
void PixelsByTile::sort(std::size_t tiles) {
  const auto chunks =
      static_cast<std::size_t>((region_.height() + rows_a_chunk - 1) / rows_a_chunk);
  std::vector<std::vector<std::uint32_t>> counts(chunks);
  parallel_for(chunks, 1, [&](std::size_t a, std::size_t b) {
    for (std::size_t i = a; i < b; ++i) {
      counts[i].assign(tiles, 0);
      visit_chunk(i, [&](std::size_t tile, std::uint32_t) { ++counts[i][tile]; });
    }
  });
  begin_.assign(tiles + 1, 0);
  std::size_t all = 0;
  for (std::size_t tile = 0; tile < tiles; ++tile) {
    begin_[tile] = all;
    for (std::vector<std::uint32_t>& chunk : counts) {
      const std::uint32_t here = chunk[tile];
      chunk[tile] = static_cast<std::uint32_t>(all);
      all += here;
    }
  }
  begin_[tiles] = all;
  pixels_.resize(all);
  parallel_for(chunks, 1, [&](std::size_t a, std::size_t b) {
    for (std::size_t i = a; i < b; ++i) {
      visit_chunk(i, [&](std::size_t tile, std::uint32_t p) { pixels_[counts[i][tile]++] = p; });
    }
  });
}

/// What the pixels of a tile say about one texel.
struct Sampled {
  float distance;  ///< squared, of the nearest pixel from the texel's centre
  std::uint32_t pixel;
  Vec3f sum;
};

/// The update of the tiles that one task gets.
class TileUpdate {
 public:
  TileUpdate(const Mesh& mesh, const EditingChart& chart, const ChartEdit& edit, Update how,
             StorageAtlas& storage)
      : mesh_(mesh),
        chart_(chart),
        edit_(edit),
        how_(how),
        storage_(storage),
        triangles_(mesh, chart.grid),
        sampled_(new std::array<Sampled, texels_a_tile>) {}

  void update(std::span<const std::uint32_t> pixels) {
    if (pixels.empty()) return;
    sampled_->fill({std::numeric_limits<float>::infinity(), 0, Vec3f::Zero()});
    for (const std::uint32_t pixel : pixels) sample(pixel);
    const std::size_t set = mesh_.texture_sets[chart_.ids.triangle.data()[pixels.front()]];
    SharedCursor covered(storage_.sets[set].texels.shared());
    for (const Sampled& s : *sampled_) {
      if (s.distance < std::numeric_limits<float>::infinity()) write(set, s, covered);
    }
  }
  const PushTally& tally() const { return tally_; }

 private:
  Vec3f edited_normal(std::size_t pixel) const;
  std::uint32_t frame_triangle(const TexelMap& map, std::uint32_t texel,
                               std::uint32_t triangle) const;
  void sample(std::uint32_t pixel);
  void write(std::size_t set, const Sampled& sampled, SharedCursor& covered);

  const Mesh& mesh_;
  const EditingChart& chart_;
  const ChartEdit& edit_;
  Update how_;
  StorageAtlas& storage_;
  TriangleCache<PushTriangle> triangles_;
  std::unique_ptr<std::array<Sampled, texels_a_tile>> sampled_;
  PushTally tally_;
};

/// push()'s formula at a pixel. Where nothing happens the pixel's normal as it is.
Vec3f TileUpdate::edited_normal(std::size_t pixel) const {
  const auto width = static_cast<std::size_t>(chart_.grid.width());
  const int x = static_cast<int>(pixel % width);
  const int y = static_cast<int>(pixel / width);
  const Vec3f& before = chart_.normal(x, y);
  const Vec3f& base = chart_.base_normal(x, y);
  const float weight = chart_.weight(x, y);
  const float covered = edit_.coverage.empty() ? 0.0F : weight * edit_.coverage(x, y);
  const Vec2f change = weight * edit_.change(x, y);
  if (!(std::abs(change.x()) + std::abs(change.y()) + covered > 0.0F)) return before;
  const Vec2f own = gradient_from_normal(before, base, edit_.direction);
  const Vec2f after = own + covered * (base_gradient(base, edit_.direction) - own) + change;
  const Vec3f n = normal_from_gradient(after, base, edit_.direction);
  return n.allFinite() ? n : before;
}

/// The triangle whose frame decodes the texel.
std::uint32_t TileUpdate::frame_triangle(const TexelMap& map, std::uint32_t texel,
                                         std::uint32_t triangle) const {
  const std::uint32_t owner = map.owner().data()[texel];
  if (owner == triangle || owner == no_triangle) return triangle;
  const std::vector<SharedTexel>& shared = map.shared();
  const auto found =
      std::lower_bound(shared.begin(), shared.end(), texel,
                       [](const SharedTexel& s, std::uint32_t t) { return s.texel < t; });
  return found != shared.end() && found->texel == texel ? triangle : owner;
}

void TileUpdate::sample(std::uint32_t pixel) {
  const std::uint32_t triangle = chart_.ids.triangle.data()[pixel];
  const TexelMap& map = storage_.sets[mesh_.texture_sets[triangle]].texels;
  const std::uint32_t texel = chart_.texel.data()[pixel];
  const TexelPlace at = texel_place(texel, map.width());
  const SurfacePoint p = map.surface_point(frame_triangle(map, texel, triangle), at.x, at.y);
  const Vec3f center = triangles_.get(p.triangle).points * Vec3f(1.0F, p.b1, p.b2);
  const TexelPlace q = texel_place(pixel, chart_.grid.width());
  const Vec2f here(static_cast<float>(q.x), static_cast<float>(q.y));
  // Whatever a degenerate triangle gives, the pixel shows the texel.
  constexpr float farthest = 1e18F;
  const float distance = (center.head<2>() - here).squaredNorm();
  Sampled& s =
      (*sampled_)[static_cast<std::size_t>(at.y % update_tile * update_tile + at.x % update_tile)];
  if (how_ == Update::Area) s.sum += edited_normal(pixel);
  const float bounded = distance < farthest ? distance : farthest;
  if (bounded < s.distance) {
    s.distance = bounded;
    s.pixel = pixel;
  }
}

void TileUpdate::write(std::size_t set, const Sampled& sampled, SharedCursor& covered) {
  StorageSet& storage = storage_.sets[set];
  const std::uint32_t texel = chart_.texel.data()[sampled.pixel];
  const TexelPlace at = texel_place(texel, storage.normals.width());
  const SurfacePoint p = storage.texels.surface_point(
      frame_triangle(storage.texels, texel, chart_.ids.triangle.data()[sampled.pixel]), at.x, at.y);
  const PushTriangle& triangle = triangles_.get(p.triangle);
  const Vec3f weights(1.0F, p.b1, p.b2);
  const Mat3f frame = triangle.frame(weights, triangle.normals * weights,
                                     storage.normals.convention().space, chart_.grid.view);
  const Vec3f edited = how_ == Update::Area ? sampled.sum : edited_normal(sampled.pixel);
  const Vec3f coded = (frame.inverse() * edited).normalized();
  if (!coded.allFinite() || coded.isZero()) return;
  const Vec3f before = storage.normals.normal(at.x, at.y);
  if (!before.isZero()) {
    tally_.largest = std::max(tally_.largest, 0.5F * (coded - before).squaredNorm());
  }
  storage.normals.set_normal(at.x, at.y, coded);
  ++tally_.changed;
  if (covered.holds(texel)) ++tally_.shared;
}

}  // namespace

PushResult update_storage(const Mesh& mesh, const EditingChart& chart, const ChartEdit& edit,
                          Update how, StorageAtlas& storage) {
  assert(how != Update::Gather && chart.texel.rect() == chart.ids.triangle.rect());
  assert(chart.normal.rect() == chart.ids.triangle.rect());
  const Rect region = intersect(edit.region, chart.ids.triangle.rect());
  if (region.empty()) return {};
  const PixelsByTile tiles(mesh, chart, region, storage);
  PushTally all;
  std::mutex mutex;
  parallel_for(tiles.count(), 4, [&](std::size_t begin, std::size_t end) {
    TileUpdate task(mesh, chart, edit, how, storage);
    for (std::size_t i = begin; i < end; ++i) task.update(tiles.pixels(i));
    const std::lock_guard lock(mutex);
    all.add(task.tally());
  });
  all.visited = all.changed;
  return result_of(all);
}

}  // namespace normalshop
