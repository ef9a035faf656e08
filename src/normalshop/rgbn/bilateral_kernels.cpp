#include "normalshop/rgbn/detail/bilateral_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "normalshop/rgbn/bilateral_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

// Every lane is a pixel of its own and no multiply-add is fused, so all targets give the same bits.
HWY_BEFORE_NAMESPACE();
namespace normalshop::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using FloatTag = hn::CappedTag<float, 16>;
using V = hn::Vec<FloatTag>;

/// Pixels that are taken together, so that their chains of operations overlap.
constexpr int side_by_side = 2;

/// The weight of 1 - s d / n.
HWY_INLINE V Power(const V one_minus_x) {
  V power = hn::Max(one_minus_x, hn::Zero(FloatTag()));
  for (int n = 1; n < bilateral_power; n *= 2) power = hn::Mul(power, power);
  return power;
}

/// `G` guides, `C` values with planes of their own, and whether the guide's colours are averaged.
template <int G, int C, bool AveragesGuide, bool Weighted>
HWY_INLINE void Pixels(const float* center, const BilateralLayout& layout, const BilateralTap* taps,
                       std::size_t tap_count, float* out, std::ptrdiff_t out_pitch) {
  const FloatTag d;
  const std::ptrdiff_t pitch = layout.pitch;
  constexpr int all_values = C + (AveragesGuide ? 3 : 0);
  V guide[G];
  V value[C];
  V sum[all_values];
  for (int g = 0; g < G; ++g) guide[g] = hn::LoadU(d, center + g * pitch);
  for (int g = 0; g < 3; ++g) guide[g] = hn::Mul(guide[g], hn::Set(d, layout.normal_factor));
  for (int c = 0; c < C; ++c) value[c] = hn::LoadU(d, center + (G + c) * pitch);
  for (V& s : sum) s = hn::Zero(d);
  V total = Weighted ? hn::LoadU(d, center + (G + C) * pitch) : hn::Set(d, 1.0F);
  for (std::size_t t = 0; t < tap_count; t += side_by_side) {
    const float* pixel[side_by_side];
    V weight[side_by_side];
    V apart[side_by_side][3];
    for (int i = 0; i < side_by_side; ++i) {
      pixel[i] = center + taps[t + i].offset;
      V product[3];
      for (int g = 0; g < 3; ++g) {
        product[g] = hn::Mul(hn::LoadU(d, pixel[i] + g * pitch), guide[g]);
      }
      weight[i] = hn::Add(hn::Add(product[0], product[1]),
                          hn::Add(product[2], hn::Set(d, taps[t + i].nearness)));
    }
    for (int i = 0; i < side_by_side && G == 6; ++i) {
      V square[3];
      for (int g = 0; g < 3; ++g) {
        apart[i][g] = hn::Sub(hn::LoadU(d, pixel[i] + (G - 3 + g) * pitch), guide[G - 3 + g]);
        square[g] = hn::Mul(apart[i][g], apart[i][g]);
      }
      weight[i] = hn::Sub(weight[i], hn::Add(hn::Add(square[0], square[1]), square[2]));
    }
    for (V& w : weight) w = Power(w);
    for (int i = 0; i < side_by_side; ++i) {
      if constexpr (Weighted) {
        weight[i] = hn::Mul(weight[i], hn::LoadU(d, pixel[i] + (G + C) * pitch));
      }
      total = hn::Add(total, weight[i]);
      // Relative to the pixel itself: what is constant stays so to the last bit.
      for (int c = 0; c < C; ++c) {
        const V change = hn::Sub(hn::LoadU(d, pixel[i] + (G + c) * pitch), value[c]);
        sum[c] = hn::Add(sum[c], hn::Mul(weight[i], change));
      }
      for (int c = C; c < all_values; ++c) {
        sum[c] = hn::Add(sum[c], hn::Mul(weight[i], apart[i][c - C]));
      }
    }
  }
  for (int c = 0; c < all_values; ++c) hn::StoreU(hn::Div(sum[c], total), d, out + c * out_pitch);
}

using RowFunction = void (*)(const float* pixels, const BilateralLayout& layout,
                             const BilateralTap* taps, std::size_t tap_count, std::ptrdiff_t count,
                             float* out, std::ptrdiff_t out_pitch);

template <int G, int C, bool AveragesGuide, bool Weighted>
void Row(const float* pixels, const BilateralLayout& layout, const BilateralTap* taps,
         std::size_t tap_count, std::ptrdiff_t count, float* out, std::ptrdiff_t out_pitch) {
  const auto step = static_cast<std::ptrdiff_t>(hn::Lanes(FloatTag()));
  for (std::ptrdiff_t x = 0; x < count; x += step) {
    Pixels<G, C, AveragesGuide, Weighted>(pixels + x, layout, taps, tap_count, out + x, out_pitch);
  }
}

template <int G, int C, bool AveragesGuide>
RowFunction RowFor(bool weighted) {
  return weighted ? Row<G, C, AveragesGuide, true> : Row<G, C, AveragesGuide, false>;
}

RowFunction RowFor(const BilateralLayout& layout) {
  if (layout.averages_guide) return RowFor<6, 2, true>(layout.weighted);
  const bool slopes = layout.values == 2;
  if (layout.guides == 3) {
    return slopes ? RowFor<3, 2, false>(layout.weighted) : RowFor<3, 5, false>(layout.weighted);
  }
  return slopes ? RowFor<6, 2, false>(layout.weighted) : RowFor<6, 5, false>(layout.weighted);
}

void BilateralRow(const float* pixels, const BilateralLayout& layout, const BilateralTap* taps,
                  std::size_t tap_count, std::ptrdiff_t count, float* out,
                  std::ptrdiff_t out_pitch) {
  RowFor(layout)(pixels, layout, taps, tap_count, count, out, out_pitch);
}

}  // namespace normalshop::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <cassert>

namespace normalshop {

HWY_EXPORT(BilateralRow);

void bilateral_row(const float* pixels, const BilateralLayout& layout,
                   std::span<const BilateralTap> taps, std::ptrdiff_t count, float* out,
                   std::ptrdiff_t out_pitch) {
  assert(layout.guides == 3 || layout.guides == 6);
  assert(layout.values == 2 || layout.values == 5);
  assert(!layout.averages_guide || (layout.guides == 6 && layout.values == 5));
  assert(count % bilateral_lanes == 0);
  assert(taps.size() % 2 == 0);
  HWY_DYNAMIC_DISPATCH(BilateralRow)
  (pixels, layout, taps.data(), taps.size(), count, out, out_pitch);
}

}  // namespace normalshop
#endif
