#pragma once

#include <cstddef>
#include <span>

/// The inner loop of the bilateral filter, private to this floor.
namespace normalshop {

/// Range weights are (1 - s d / n)^n instead of exp(-d), with n = bilateral_power and s =
/// bilateral_scale: a handful of products that give the same bits on every machine, and 0 beyond 8
/// sigmas. The scale makes both equal at d = 3; their difference is at most 0.012.
inline constexpr int bilateral_power = 32;
inline constexpr double bilateral_scale = 1.0 - 1.5 / bilateral_power;

/// One pixel of the kernel: where it lies, in floats from the centre, and 1 - s d / n of the weight
/// in space (made so that this is exact) less the layout's normal_factor.
struct BilateralTap {
  std::ptrdiff_t offset;
  float nearness;
};

/// Pixels as planes of numbers, `pitch` floats apart. `guides` are compared: three of the unit
/// normal, whose s d / n is normal_factor (1 - <n_i, n_j>), and, if there are six, three of the
/// colour, whose squared distance is it. `values` (2 or 5) are averaged: each has a plane, but if
/// `averages_guide` the last three are the guide's colours. Where pixels are `weighted`, the last
/// plane is the weight of each.
struct BilateralLayout {
  int guides;
  int values;
  bool averages_guide;
  bool weighted;
  float normal_factor;
  std::ptrdiff_t pitch;
  int planes() const { return guides + values - (averages_guide ? 3 : 0) + (weighted ? 1 : 0); }
};

/// Rows are computed in pieces of this many pixels.
inline constexpr int bilateral_lanes = 16;

/// out[v * out_pitch + i] = the mean over the centre and the taps, an even number, of value v of a
/// pixel minus that of pixel i, for i in [0, count), count a multiple of bilateral_lanes. `pixels`
/// points at plane 0 of pixel 0.
void bilateral_row(const float* pixels, const BilateralLayout& layout,
                   std::span<const BilateralTap> taps, std::ptrdiff_t count, float* out,
                   std::ptrdiff_t out_pitch);

}  // namespace normalshop
