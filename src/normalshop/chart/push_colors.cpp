#include "normalshop/chart/push_colors.h"

#include <atomic>
#include <cassert>

#include "normalshop/chart/bicubic_change.h"
#include "normalshop/chart/edit_reach.h"
#include "normalshop/chart/push_candidates.h"
#include "normalshop/chart/shared_texels.h"
#include "normalshop/chart/visible_weight.h"
#include "normalshop/core/for_pixels.h"

namespace normalshop {

namespace {

/// Tells what an edit of colours does at points of the surface.
class ColorSampler {
 public:
  ColorSampler(const EditingChart& chart, const ColorEdit& edit)
      : reach_(chart, edit.region, [&](int x, int y) { return !edit.change(x, y).isZero(0.0F); }),
        red_green_(chart.grid.width(), chart.grid.height(), Vec2f(0.0F, 0.0F)),
        blue_(chart.grid.width(), chart.grid.height(), Vec2f(0.0F, 0.0F)) {
    assert(edit.change.rect() == chart.weight.rect());
    for_pixels(reach_.region(), [&](int x, int y) {
      const Vec3f& c = edit.change(x, y);
      red_green_(x, y) = c.head<2>();
      blue_(x, y) = Vec2f(c.z(), 0.0F);
    });
  }

  const EditReach& reach() const { return reach_; }
  /// Fills weight and change of the batch's points. False, and not all is filled, when nothing
  /// happens at any of them.
  bool read(TexelBatch& batch) const {
    if (!read_visible_weight(reach_, batch)) return false;
    read_change(blue_, reach_.region(), batch);
    batch.change_z = batch.change_x;
    read_change(red_green_, reach_.region(), batch);
    bool any = false;
    for (int i = 0; i < batch.count; ++i) any = any || batch.acts(i);
    return any;
  }

 private:
  EditReach reach_;
  SlopeImage red_green_;
  SlopeImage blue_;  ///< in x
};

Vec3f change_of(const TexelBatch& batch, int i) {
  const auto k = static_cast<std::size_t>(i);
  return {batch.change_x[k], batch.change_y[k], batch.change_z[k]};
}

/// The push into one texture set's colours.
class SetColorPush {
 public:
  SetColorPush(const Mesh& mesh, const ColorSampler& sampler, StorageSet& set, std::uint32_t index)
      : mesh_(mesh),
        sampler_(sampler),
        albedo_(set.albedo),
        texels_(set.albedo_texels.width() > 0 ? set.albedo_texels : set.texels),
        candidates_(mesh, sampler.reach(), index, texels_.width(), texels_.height()) {}

  ColorPushResult run() {
    const std::vector<Rect> tiles = candidates_.tiles();
    if (tiles.empty()) return {};
    shared_ = shared_writes();
    keep_strongest(shared_);
    std::vector<TexelWrite> gutter = gutter_writes();
    keep_strongest(gutter);
    std::atomic<std::size_t> visited = 0;
    std::atomic<std::size_t> changed = 0;
    parallel_for(tiles.size(), 1, [&](std::size_t begin, std::size_t end) {
      ColorPushResult local;
      TexelRows rows(mesh_, sampler_.reach().grid(), texels_, candidates_.wanted());
      for (std::size_t i = begin; i < end; ++i) {
        rows.visit(tiles[i], [&](TexelLanes& row) { edit_row(row, local); });
      }
      visited += local.visited;
      changed += local.changed;
    });
    ColorPushResult result{visited, changed};
    result.changed += write(shared_) + write(gutter);
    return result;
  }

 private:
  using Cache = TriangleCache<PushTriangle>;

  void edit_row(TexelLanes& row, ColorPushResult& result) {
    result.visited += static_cast<std::size_t>(row.batch.count);
    if (!sampler_.read(row.batch)) return;
    for (int i = 0; i < row.batch.count; ++i) {
      const std::uint32_t index = row.texels[static_cast<std::size_t>(i)];
      if (!row.batch.acts(i) || holds_texel(shared_, index)) continue;
      const auto [x, y] = texel_place(index, texels_.width());
      if (albedo_.add(x, y, change_of(row.batch, i))) ++result.changed;
    }
  }

  template <class Item>
  static void collect(const PerLane<const Item*>& items, const TexelBatch& batch,
                      std::vector<TexelWrite>& out) {
    for (int i = 0; i < batch.count; ++i) {
      const auto k = static_cast<std::size_t>(i);
      if (batch.acts(i)) out.push_back({items[k]->texel, batch.weight[k], change_of(batch, i)});
    }
  }

  std::vector<TexelWrite> gutter_writes() const {
    return collect_gutter(
        texels_.gutter(), mesh_, sampler_.reach().grid(), candidates_.wanted(),
        [&](const auto& items, Cache&, TexelBatch& batch, std::vector<TexelWrite>& out) {
          if (sampler_.read(batch)) collect(items, batch, out);
        });
  }

  std::vector<TexelWrite> shared_writes() const {
    return collect_shared(
        texels_.shared(), texels_, mesh_, sampler_.reach().grid(), candidates_.wanted(),
        [&](const auto& items, Cache& triangles, TexelBatch& batch, std::vector<TexelWrite>& out) {
          if (!sampler_.read(batch)) return;
          drop_lanes_of_owners(items, texels_, candidates_.wanted(), triangles, sampler_, batch);
          collect(items, batch, out);
        });
  }

  std::size_t write(const std::vector<TexelWrite>& writes) {
    std::size_t changed = 0;
    for (const TexelWrite& w : writes) {
      const auto [x, y] = texel_place(w.texel, texels_.width());
      if (albedo_.add(x, y, w.value)) ++changed;
    }
    return changed;
  }

  const Mesh& mesh_;
  const ColorSampler& sampler_;
  ColorMap& albedo_;
  const TexelMap& texels_;
  PushCandidates candidates_;
  std::vector<TexelWrite> shared_;  // of texels that their owners leave to others
};

/// The texels of a colour map that is not as large as the normals.
void find_texels(const Mesh& mesh, std::uint32_t index, StorageSet& set) {
  const int width = set.albedo.codes().width();
  const int height = set.albedo.codes().height();
  if (width == set.texels.width() && height == set.texels.height()) return;
  if (set.albedo_texels.width() == 0) set.albedo_texels = TexelMap(mesh, index, width, height);
}

}  // namespace

void prepare_colors(const Mesh& mesh, StorageAtlas& storage) {
  for (std::size_t i = 0; i < storage.sets.size(); ++i) {
    StorageSet& set = storage.sets[i];
    if (set.albedo.empty()) continue;
    find_texels(mesh, static_cast<std::uint32_t>(i), set);
    set.albedo.begin_edits();
  }
}

ColorPushResult push_colors(const Mesh& mesh, const EditingChart& chart, const ColorEdit& edit,
                            StorageAtlas& storage) {
  prepare_colors(mesh, storage);
  const ColorSampler sampler(chart, edit);
  ColorPushResult all;
  for (std::size_t i = 0; i < storage.sets.size(); ++i) {
    StorageSet& set = storage.sets[i];
    if (set.albedo.empty()) continue;
    const ColorPushResult pushed =
        SetColorPush(mesh, sampler, set, static_cast<std::uint32_t>(i)).run();
    all.visited += pushed.visited;
    all.changed += pushed.changed;
  }
  return all;
}

}  // namespace normalshop
