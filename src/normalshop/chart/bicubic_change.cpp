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

using Pairs = hn::CappedTag<float, 8>;

/// x and y of four pixels side by side, added up.
template <class V>
HWY_INLINE void sum_pixels(V pixels, float* sum) {
  const auto two = hn::Add(pixels, hn::Shuffle1032(pixels));
  const hn::Half<Pairs> half;
  const auto all = hn::Add(hn::LowerHalf(half, two), hn::UpperHalf(half, two));
  sum[0] = hn::GetLane(all);
  sum[1] = hn::ExtractLane(all, 1);
}

/// The weighted pixels from (x, y) on, 4 rows of 4, at a fraction fx beyond the second of a row.
HWY_INLINE void bicubic(const SlopeView& change, int x, int y, float fx, const float* down,
                        std::size_t stride, float* sum) {
  const Pairs d;
  std::array<const float*, 4> rows;
  for (int j = 0; j < 4; ++j) rows[static_cast<std::size_t>(j)] = change.row(y + j)[x].data();
  alignas(64) Eight part;
  for (std::size_t k = 0; k < 8; k += hn::Lanes(d)) {
    const auto row = [&](std::size_t j) {
      return hn::Mul(hn::Set(d, down[j * stride]), hn::LoadU(d, rows[j] + k));
    };
    const auto column = hn::Add(hn::Add(row(0), row(1)), hn::Add(row(2), row(3)));
    const auto t = hn::Set(d, fx);
    const auto high = hn::Add(hn::Load(d, &power2[k]), hn::Mul(t, hn::Load(d, &power3[k])));
    const auto middle = hn::Add(hn::Load(d, &power1[k]), hn::Mul(t, high));
    const auto across = hn::Add(hn::Load(d, &power0[k]), hn::Mul(t, middle));
    if constexpr (hn::MaxLanes(Pairs()) == 8) return sum_pixels(hn::Mul(across, column), sum);
    hn::Store(hn::Mul(across, column), d, &part[k]);
  }
  sum[0] = (part[0] + part[2]) + (part[4] + part[6]);
  sum[1] = (part[1] + part[3]) + (part[5] + part[7]);
}

/// Of some points: the pixels that they lie beyond, how far, and cubic_weights() of the rows.
struct Around {
  static constexpr std::size_t most = 16;
  alignas(64) std::array<std::int32_t, most> x;
  alignas(64) std::array<std::int32_t, most> y;
  alignas(64) std::array<float, most> fx;
  alignas(64) std::array<float, 4 * most> down;
};

HWY_INLINE void find_around(const float* px, const float* py, Around& out) {
  const hn::CappedTag<float, Around::most> d;
  const hn::RebindToSigned<decltype(d)> di;
  const auto times = [&](float factor, auto v) { return hn::Mul(hn::Set(d, factor), v); };
  for (std::size_t i = 0; i < Around::most; i += hn::Lanes(d)) {
    const auto x = hn::Load(d, px + i);
    const auto y = hn::Load(d, py + i);
    const auto x0 = hn::Floor(x);
    const auto y0 = hn::Floor(y);
    hn::Store(hn::ConvertTo(di, x0), di, &out.x[i]);
    hn::Store(hn::ConvertTo(di, y0), di, &out.y[i]);
    hn::Store(hn::Sub(x, x0), d, &out.fx[i]);
    const auto t = hn::Sub(y, y0);
    const auto t2 = hn::Mul(t, t);
    const auto t3 = hn::Mul(t2, t);
    float* down = &out.down[i];
    hn::Store(hn::Sub(hn::Add(times(-0.5F, t3), t2), times(0.5F, t)), d, down);
    hn::Store(hn::Add(hn::Sub(times(1.5F, t3), times(2.5F, t2)), hn::Set(d, 1.0F)), d,
              down + Around::most);
    hn::Store(hn::Add(hn::Add(times(-1.5F, t3), times(2.0F, t2)), times(0.5F, t)), d,
              down + 2 * Around::most);
    hn::Store(hn::Sub(times(0.5F, t3), times(0.5F, t2)), d, down + 3 * Around::most);
  }
}

void read_all(const SlopeView& change, const Rect& region, TexelBatch& batch) {
  Around around;
  for (std::size_t i = 0; i < static_cast<std::size_t>(batch.count); ++i) {
    const std::size_t k = i % Around::most;
    if (k == 0) find_around(&batch.point.x[i], &batch.point.y[i], around);
    const float weight = batch.weight[i];
    Vec2f moved(0.0F, 0.0F);
    if (weight > 0.0F) {
      const int x0 = around.x[k];
      const int y0 = around.y[k];
      const bool inside =
          x0 > region.x0 && y0 > region.y0 && x0 < region.x1 - 2 && y0 < region.y1 - 2;
      if (inside) {
        bicubic(change, x0 - 1, y0 - 1, around.fx[k], &around.down[k], Around::most, moved.data());
      } else {
        moved = change_near_border(change, region, batch.point.x[i], batch.point.y[i]);
      }
      moved *= weight;
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
