#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "normalshop/chart/texel_batch.h"
#include "normalshop/core/parallel.h"

/// Edits of texels listed one by one, private to floor 4.
namespace normalshop {

/// A listed texel and what it gets.
struct TexelWrite {
  std::uint32_t texel;  ///< y * width + x
  float weight;         ///< of the effective chart
  Vec3f value;          ///< the new normal, or what its colour grows by
  float turn = 0.0F;    ///< of normals: 1 - cos of the angle between before and after
  float facing = 0.0F;  ///< of normals: cosine between the base normal and the viewing direction
  std::uint32_t triangle = 0;  ///< of normals: the one whose frame decodes the texel
  std::uint32_t rank = 0;  ///< of normals of listed texels: 1 and on, as they stand in their list
};

/// Index of a texel as TexelWrite has it.
inline std::uint32_t texel_index(int x, int y, int width) {
  return static_cast<std::uint32_t>(y) * static_cast<std::uint32_t>(width) +
         static_cast<std::uint32_t>(x);
}

/// Is a texel among the writes? They are sorted by texel.
inline bool holds_texel(const std::vector<TexelWrite>& writes, std::uint32_t texel) {
  if (writes.empty()) return false;
  const auto found =
      std::lower_bound(writes.begin(), writes.end(), texel,
                       [](const TexelWrite& w, std::uint32_t t) { return w.texel < t; });
  return found != writes.end() && found->texel == texel;
}

/// Degrees of the angle whose cosine is 1 - turn.
inline float degrees_of_turn(float turn) {
  const float half_sine = std::sqrt(std::min(1.0F, 0.5F * turn));
  return 2.0F * std::asin(half_sine) * 180.0F / 3.14159265F;
}

/// Is a weight larger than another by more than rounding?
inline bool outweighs(float weight, float other) { return weight > other + 1e-3F; }

/// One write a texel: that of the largest weight, of equal ones the first. `writes` by texel.
inline void keep_strongest(std::vector<TexelWrite>& writes) {
  std::size_t count = 0;
  for (const TexelWrite& w : writes) {
    if (count == 0 || writes[count - 1].texel != w.texel) {
      writes[count++] = w;
    } else if (outweighs(w.weight, writes[count - 1].weight)) {
      writes[count - 1] = w;
    }
  }
  writes.resize(count);
}

/// The texels of a batch, by lane.
template <class T>
using PerLane = std::array<T, TexelBatch::capacity>;

/// What edit(items, triangles, batch, writes) writes for all wanted items, in their order, given
/// batches of the points that add(item, triangles, batch) adds.
template <class Item, class Wanted, class Add, class Edit>
std::vector<TexelWrite> collect_writes(const std::vector<Item>& items, const Mesh& mesh,
                                       const ChartGrid& grid, const Wanted& wanted, const Add& add,
                                       const Edit& edit) {
  constexpr std::size_t run = 4096;
  std::vector<std::vector<TexelWrite>> parts((items.size() + run - 1) / run);
  parallel_for(parts.size(), 1, [&](std::size_t begin, std::size_t end) {
    TriangleCache<PushTriangle> triangles(mesh, grid);
    TexelBatch batch;
    PerLane<const Item*> lanes;
    for (std::size_t part = begin; part < end; ++part) {
      batch.count = 0;
      const std::size_t last = std::min(items.size(), (part + 1) * run);
      for (std::size_t i = part * run; i < last; ++i) {
        if (wanted(items[i])) {
          lanes[static_cast<std::size_t>(batch.count)] = &items[i];
          add(items[i], triangles, batch);
        }
        if (batch.count == TexelBatch::capacity || (i + 1 == last && batch.count > 0)) {
          edit(lanes, triangles, batch, parts[part]);
          batch.count = 0;
        }
      }
    }
  });
  std::vector<TexelWrite> all;
  for (const auto& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

}  // namespace normalshop
