#include "normalshop/chart/edit_sampler.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include "normalshop/chart/bicubic_change.h"
#include "normalshop/chart/visible_weight.h"
#include "normalshop/core/sample.h"

namespace normalshop {

EditSampler::EditSampler(const EditingChart& chart, const ChartEdit& edit)
    : EditSampler(chart, edit,
                  EditReach(chart, edit.region, [&](int x, int y) { return acts(edit, x, y); })) {}

EditSampler::EditSampler(const EditingChart& chart, const ChartEdit& edit, EditReach reach)
    : edit_(edit), reach_(std::move(reach)) {
  [[maybe_unused]] const Rect all{0, 0, chart.grid.width(), chart.grid.height()};
  assert(chart.ids.depth.rect() == all && chart.weight.rect() == all);
  assert(edit.change.rect() == all && (edit.coverage.empty() || edit.coverage.rect() == all));
}

void EditSampler::update(const PixelBlocks& changed) {
  reach_.update(changed, [this](int x, int y) { return acts(edit_, x, y); });
}

bool EditSampler::acts(const ChartEdit& edit, int x, int y) {
  const Vec2f& c = edit.change(x, y);
  return c.x() != 0.0F || c.y() != 0.0F || (!edit.coverage.empty() && edit.coverage(x, y) > 0.0F);
}

/// Bilinear, otherwise like read_change().
float EditSampler::coverage_at(float x, float y) const {
  const MaskView& coverage = edit_.coverage;
  const int x0 = floor_to_int(x);
  const int y0 = floor_to_int(y);
  const float fx = x - static_cast<float>(x0);
  const float fy = y - static_cast<float>(y0);
  float sum = 0.0F;
  for (int j = 0; j < 2; ++j) {
    const int yj = std::clamp(y0 + j, 0, coverage.height() - 1);
    for (int i = 0; i < 2; ++i) {
      const int xi = std::clamp(x0 + i, 0, coverage.width() - 1);
      sum += (i == 0 ? 1.0F - fx : fx) * (j == 0 ? 1.0F - fy : fy) * coverage(xi, yj);
    }
  }
  return std::clamp(sum, 0.0F, 1.0F);
}

/// Beside a hard edge the weight may be that of the other side.
void EditSampler::drop_averted(TexelBatch& batch) const {
  for (int i = 0; i < batch.count; ++i) {
    const Vec3f base = batch.base.get(i);
    const float facing = base.dot(edit_.direction.along);
    if (!(facing > grazing_cosine * base.norm())) batch.weight[static_cast<std::size_t>(i)] = 0.0F;
  }
}

/// Points outside edit.own, to a hundredth of a pixel: charts round differently, and no point must
/// fall between two of them.
void EditSampler::drop_others(TexelBatch& batch) const {
  constexpr float slack = 0.01F;
  const auto within = [](float p, int begin, int end) {
    return p >= static_cast<float>(begin) - 0.5F - slack &&
           p < static_cast<float>(end) - 0.5F + slack;
  };
  const Rect& own = *edit_.own;
  for (std::size_t i = 0; i < static_cast<std::size_t>(batch.count); ++i) {
    if (within(batch.point.x[i], own.x0, own.x1) && within(batch.point.y[i], own.y0, own.y1)) {
      continue;
    }
    batch.weight[i] = 0.0F;
  }
}

bool EditSampler::read(TexelBatch& batch) const {
  return read_visible_weight(reach_, batch) && read_weighed(batch);
}

bool EditSampler::read_weighed(TexelBatch& batch) const {
  if (edit_.direction.mode == EditMode::Along) drop_averted(batch);
  if (edit_.own) drop_others(batch);
  read_change(edit_.change, edit_.change.rect(), batch);
  batch.covered.fill(0.0F);
  bool any = false;
  for (int i = 0; i < batch.count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (batch.weight[k] > 0.0F && !edit_.coverage.empty()) {
      batch.covered[k] = batch.weight[k] * coverage_at(batch.point.x[k], batch.point.y[k]);
    }
    any = any || batch.acts(i);
  }
  return any;
}

}  // namespace normalshop
