#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "normalshop/chart/bicubic_change.cpp"
#include <hwy/foreach_target.h>
// After foreach_target, as Highway asks.
#include <algorithm>
#include <array>

#include <hwy/highway.h>

#include "normalshop/chart/bicubic_change.h"
#include "normalshop/core/sample.h"

#ifndef NORMALSHOP_CHANGE_NEAR_BORDER
#define NORMALSHOP_CHANGE_NEAR_BORDER
namespace normalshop {
Vec2f change_near_border(SlopeView change, const Rect& region, float x, float y);
}  // namespace normalshop
#endif

HWY_BEFORE_NAMESPACE();
namespace normalshop {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// x and y of four pixels side by side.
using Eight = std::array<float, 8>;

/// cubic_weights() of four pixels, each twice, by powers of the fraction.
alignas(64) constexpr Eight power0{0.0F, 0.0F, 1.0F, 1.0F, 0.0F, 0.0F, 0.0F, 0.0F};
alignas(64) constexpr Eight power1{-0.5F, -0.5F, 0.0F, 0.0F, 0.5F, 0.5F, 0.0F, 0.0F};
alignas(64) constexpr Eight power2{1.0F, 1.0F, -2.5F, -2.5F, 2.0F, 2.0F, -0.5F, -0.5F};
alignas(64) constexpr Eight power3{-0.5F, -0.5F, 1.5F, 1.5F, -1.5F, -1.5F, 0.5F, 0.5F};

/// The pixels from `corner` on, 4 rows of 4, at fractions (fx, fy) beyond the second of each.
HWY_INLINE Vec2f bicubic(const SlopeView& change, int x, int y, float fx, float fy) {
  const hn::CappedTag<float, 8> d;
  const std::array<float, 4> down = cubic_weights(fy);
  std::array<const float*, 4> rows;
  for (int j = 0; j < 4; ++j) rows[static_cast<std::size_t>(j)] = change.row(y + j)[x].data();
  alignas(64) Eight part;
  for (std::size_t k = 0; k < 8; k += hn::Lanes(d)) {
    const auto row = [&](std::size_t j) {
      return hn::Mul(hn::Set(d, down[j]), hn::LoadU(d, rows[j] + k));
    };
    const auto column = hn::Add(hn::Add(row(0), row(1)), hn::Add(row(2), row(3)));
    const auto t = hn::Set(d, fx);
    const auto high = hn::Add(hn::Load(d, &power2[k]), hn::Mul(t, hn::Load(d, &power3[k])));
    const auto middle = hn::Add(hn::Load(d, &power1[k]), hn::Mul(t, high));
    const auto across = hn::Add(hn::Load(d, &power0[k]), hn::Mul(t, middle));
    hn::Store(hn::Mul(across, column), d, &part[k]);
  }
  return {(part[0] + part[2]) + (part[4] + part[6]), (part[1] + part[3]) + (part[5] + part[7])};
}

void read_all(const SlopeView& change, const Rect& region, TexelBatch& batch) {
  for (std::size_t i = 0; i < static_cast<std::size_t>(batch.count); ++i) {
    const float weight = batch.weight[i];
    Vec2f moved(0.0F, 0.0F);
    if (weight > 0.0F) {
      const float x = batch.point.x[i];
      const float y = batch.point.y[i];
      const int x0 = floor_to_int(x);
      const int y0 = floor_to_int(y);
      const bool inside =
          x0 > region.x0 && y0 > region.y0 && x0 + 2 < region.x1 && y0 + 2 < region.y1;
      moved = weight * (inside ? bicubic(change, x0 - 1, y0 - 1, x - static_cast<float>(x0),
                                         y - static_cast<float>(y0))
                               : change_near_border(change, region, x, y));
    }
    batch.change_x[i] = moved.x();
    batch.change_y[i] = moved.y();
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace normalshop
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace normalshop {

HWY_EXPORT(read_all);

Vec2f change_near_border(SlopeView change, const Rect& region, float x, float y) {
  const int x0 = floor_to_int(x);
  const int y0 = floor_to_int(y);
  const std::array<float, 4> wx = cubic_weights(x - static_cast<float>(x0));
  const std::array<float, 4> wy = cubic_weights(y - static_cast<float>(y0));
  Vec2f sum = Vec2f::Zero();
  for (int j = 0; j < 4; ++j) {
    const int yj = std::clamp(y0 - 1 + j, 0, change.height() - 1);
    for (int i = 0; i < 4; ++i) {
      const int xi = std::clamp(x0 - 1 + i, 0, change.width() - 1);
      if (!region.contains(xi, yj)) continue;
      sum += wx[static_cast<std::size_t>(i)] * wy[static_cast<std::size_t>(j)] * change(xi, yj);
    }
  }
  return sum;
}

void read_change(SlopeView change, const Rect& region, TexelBatch& batch) {
  HWY_DYNAMIC_DISPATCH(read_all)(change, region, batch);
}

}  // namespace normalshop
#endif
