#include "normalshop/chart/edit_sampler.h"

#include <algorithm>
#include <array>

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

/// Bicubic. Pixels outside the region count as 0, and the image's border continues within it.
Vec2f EditSampler::change_at(float x, float y) const {
  const int x0 = floor_to_int(x);
  const int y0 = floor_to_int(y);
  const bool inside =
      x0 > region_.x0 && y0 > region_.y0 && x0 + 2 < region_.x1 && y0 + 2 < region_.y1;
  if (!inside) return change_near_border(x, y);
  const std::array<float, 4> across = cubic_weights(x - static_cast<float>(x0));
  const std::array<float, 4> down = cubic_weights(y - static_cast<float>(y0));
  std::array<float, 8> columns{};  // x and y of four pixels: one vector for the compiler
  for (int j = 0; j < 4; ++j) {
    const float* p = edit_.change.row(y0 - 1 + j)[x0 - 1].data();
    const float w = down[static_cast<std::size_t>(j)];
    for (std::size_t i = 0; i < 8; ++i) columns[i] += w * p[i];
  }
  Vec2f sum = Vec2f::Zero();
  for (std::size_t i = 0; i < 4; ++i) {
    sum += across[i] * Vec2f(columns[2 * i], columns[2 * i + 1]);
  }
  return sum;
}

Vec2f EditSampler::change_near_border(float x, float y) const {
  const SlopeView& change = edit_.change;
  const int x0 = floor_to_int(x);
  const int y0 = floor_to_int(y);
  const std::array<float, 4> wx = cubic_weights(x - static_cast<float>(x0));
  const std::array<float, 4> wy = cubic_weights(y - static_cast<float>(y0));
  Vec2f sum = Vec2f::Zero();
  for (int j = 0; j < 4; ++j) {
    const int yj = std::clamp(y0 - 1 + j, 0, change.height() - 1);
    for (int i = 0; i < 4; ++i) {
      const int xi = std::clamp(x0 - 1 + i, 0, change.width() - 1);
      if (!region_.contains(xi, yj)) continue;
      sum += wx[static_cast<std::size_t>(i)] * wy[static_cast<std::size_t>(j)] * change(xi, yj);
    }
  }
  return sum;
}

/// Bilinear, otherwise like change_at().
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
  bool any = false;
  for (int i = 0; i < batch.count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const float weight = batch.weight[k];
    const bool seen = weight > 0.0F;
    const float x = batch.point.x[k];
    const float y = batch.point.y[k];
    const Vec2f change = seen ? Vec2f(weight * change_at(x, y)) : Vec2f(0.0F, 0.0F);
    batch.change_x[k] = change.x();
    batch.change_y[k] = change.y();
    batch.covered[k] = seen && !edit_.coverage.empty() ? weight * coverage_at(x, y) : 0.0F;
    any = any || batch.acts(i);
  }
  return any;
}

}  // namespace normalshop
