#include "normalshop/chart/edit_sampler.h"

#include <algorithm>
#include <cassert>

#include "normalshop/chart/bicubic_change.h"
#include "normalshop/chart/visible_weight.h"
#include "normalshop/core/parallel.h"
#include "normalshop/core/sample.h"

namespace normalshop {

namespace {

constexpr int block = edit_block;

Image<std::int32_t> dilate(const Image<std::uint8_t>& in) {
  Image<std::int32_t> out(in.width(), in.height(), 0);
  for (int y = 0; y < in.height(); ++y) {
    for (int x = 0; x < in.width(); ++x) {
      if (in(x, y) == 0) continue;
      const Rect around = intersect({x - 1, y - 1, x + 2, y + 2}, in.rect());
      for (int j = around.y0; j < around.y1; ++j) {
        std::fill_n(out.row(j) + around.x0, around.width(), 1);
      }
    }
  }
  return out;
}

}  // namespace

EditSampler::EditSampler(const EditingChart& chart, const ChartEdit& edit)
    : chart_(chart), edit_(edit), region_(intersect(edit.region, edit.change.rect())) {
  [[maybe_unused]] const Rect all{0, 0, chart.grid.width(), chart.grid.height()};
  assert(chart.ids.depth.rect() == all && chart.weight.rect() == all);
  assert(edit.change.rect() == all && (edit.coverage.empty() || edit.coverage.rect() == all));
  Image<std::uint8_t> exact((chart.grid.width() + block - 1) / block,
                            (chart.grid.height() + block - 1) / block, 0);
  parallel_for(static_cast<std::size_t>(exact.height()), 4, [&](std::size_t a, std::size_t b) {
    const int first = std::max(static_cast<int>(a) * block, region_.y0);
    const int last = std::min(static_cast<int>(b) * block, region_.y1);
    for (int y = first; y < last; ++y) {
      std::uint8_t* row = exact.row(y / block);
      for (int x = region_.x0; x < region_.x1; ++x) {
        if (row[x / block] == 0 && acts(x, y)) row[x / block] = 1;
      }
    }
  });
  blocks_ = dilate(exact);  // the bicubic kernel reaches two pixels
}

bool EditSampler::acts(int x, int y) const {
  if (!(chart_.weight(x, y) > 0.0F)) return false;
  const Vec2f& c = edit_.change(x, y);
  return c.x() != 0.0F || c.y() != 0.0F || (!edit_.coverage.empty() && edit_.coverage(x, y) > 0.0F);
}

bool EditSampler::reaches(float x0, float y0, float x1, float y1) const {
  // Whatever a stray vertex gives stays within what int holds.
  const auto bounded = [](float v) { return v > -1.0F ? std::min(v, 1e6F) : -1.0F; };
  const Rect pixels =
      intersect({floor_to_int(bounded(x0)), floor_to_int(bounded(y0)),
                 static_cast<int>(bounded(x1)) + 1, static_cast<int>(bounded(y1)) + 1},
                chart_.ids.depth.rect());
  if (pixels.empty()) return false;
  for (int y = pixels.y0 / block; y <= (pixels.y1 - 1) / block; ++y) {
    for (int x = pixels.x0 / block; x <= (pixels.x1 - 1) / block; ++x) {
      if (blocks_(x, y) != 0) return true;
    }
  }
  return false;
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
      if (!region_.contains(xi, yj)) continue;
      sum += (i == 0 ? 1.0F - fx : fx) * (j == 0 ? 1.0F - fy : fy) * coverage(xi, yj);
    }
  }
  return std::clamp(sum, 0.0F, 1.0F);
}

bool EditSampler::read(TexelBatch& batch) const {
  if (!read_visible_weight(chart_, blocks_, batch)) return false;
  read_change(edit_.change, region_, batch);
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
