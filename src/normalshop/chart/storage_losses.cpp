#include <atomic>
#include <vector>

#include "normalshop/chart/pixel_row.h"
#include "normalshop/chart/texel_walk.h"
#include "normalshop/chart/update_storage.h"
#include "normalshop/chart/visible_weight.h"
#include "normalshop/core/parallel.h"
#include "normalshop/core/sample.h"

namespace normalshop {

namespace {

/// Below this weight a texel counts as not seen.
constexpr float seen_weight = 0.1F;

/// The column or row of the texel at a coordinate of a repeating map.
std::uint32_t texel_at(float coordinate, int size) {
  const float inside = coordinate - std::floor(coordinate);
  const int at = static_cast<int>(inside * static_cast<float>(size));
  return static_cast<std::uint32_t>(std::clamp(at, 0, size - 1));
}

std::uint32_t texel_of(const PixelTriangle& t, int x, int y, const NormalMap& map) {
  const Vec2f weights =
      (static_cast<float>(x) - t.x0) * t.dx + (static_cast<float>(y) - t.y0) * t.dy;
  Vec2f b = weights.cwiseMax(0.0F).cwiseMin(1.0F);
  b /= std::max(b.sum(), 1.0F);
  const Vec2f uv = t.uv + b.x() * t.uv1 + b.y() * t.uv2;
  return texel_at(uv.y(), map.height()) * static_cast<std::uint32_t>(map.width()) +
         texel_at(uv.x(), map.width());
}

/// Per set, which texels the pixels of a region with a weight show.
std::vector<Image<std::uint8_t>> shown_texels(const Mesh& mesh, const EditingChart& chart,
                                              const Rect& region, const StorageAtlas& storage) {
  std::vector<Image<std::uint8_t>> shown;
  for (const StorageSet& set : storage.sets) {
    shown.emplace_back(set.normals.width(), set.normals.height(), std::uint8_t{0});
  }
  parallel_rows(region.height(), [&](int row) {
    const int y = region.y0 + row;
    for (int x = region.x0; x < region.x1; ++x) {
      const std::uint32_t triangle = chart.ids.triangle(x, y);
      if (triangle == no_triangle || !(chart.weight(x, y) > 0.0F)) continue;
      Image<std::uint8_t>& set = shown[mesh.texture_sets[triangle]];
      std::atomic_ref(set.data()[chart.texel(x, y)]).store(1, std::memory_order_relaxed);
    }
  });
  return shown;
}

}  // namespace

void find_texels(const Mesh& mesh, const StorageAtlas& storage, EditingChart& chart) {
  chart.texel.resize(chart.grid.width(), chart.grid.height());
  parallel_for(static_cast<std::size_t>(chart.grid.height()), 16,
               [&](std::size_t begin, std::size_t end) {
                 TriangleCache<PixelTriangle> triangles(mesh, chart.grid);
                 for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
                   for (int x = 0; x < chart.grid.width(); ++x) {
                     const std::uint32_t id = chart.ids.triangle(x, y);
                     chart.texel(x, y) = 0;
                     if (id == no_triangle) continue;
                     const PixelTriangle& triangle = triangles.get(id);
                     chart.texel(x, y) =
                         texel_of(triangle, x, y, storage.sets[triangle.texture_set].normals);
                   }
                 }
               });
}

std::size_t lost_texels(const Mesh& mesh, const EditingChart& chart, const Rect& region,
                        const StorageAtlas& storage) {
  const Rect inside = intersect(region, chart.ids.triangle.rect());
  if (inside.empty()) return 0;
  const std::vector<Image<std::uint8_t>> shown = shown_texels(mesh, chart, inside, storage);
  const EditReach reach(chart, inside, [](int, int) { return true; });
  std::atomic<std::size_t> lost{0};
  for (std::size_t i = 0; i < storage.sets.size(); ++i) {
    const auto wanted = [](std::uint32_t) { return true; };
    const auto count = [&](TexelLanes& lanes) {
      TexelBatch& batch = lanes.batch;
      if (!read_visible_weight(reach, batch)) return;
      std::size_t missed = 0;
      for (std::size_t k = 0; k < static_cast<std::size_t>(batch.count); ++k) {
        if (!(batch.weight[k] >= seen_weight)) continue;
        const int x = floor_to_int(batch.point.x[k] + 0.5F);
        const int y = floor_to_int(batch.point.y[k] + 0.5F);
        if (inside.contains(x, y) && shown[i].data()[lanes.texels[k]] == 0) ++missed;
      }
      lost += missed;
    };
    walk_owned(mesh, chart.grid, storage.sets[i].texels, wanted, count);
  }
  return lost;
}

}  // namespace normalshop
