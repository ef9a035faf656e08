#pragma once

#include <array>
#include <cstddef>
#include <vector>

/// The inner loops of the Gaussian, private to this floor. A panel is `lanes` neighbouring columns
/// (or transposed rows) of numbers, sample after sample, each sample `lanes` floats in a row.
namespace normalshop {

inline constexpr int panel_lanes = 32;

/// out[i] = in[i] + sum_k weights[k] (in[i-k] + in[i+k] - 2 in[i]), k = 1..radius: a constant stays
/// what it is to the last bit. `in` points at sample 0 and has `radius` samples on both sides.
struct FirKernel {
  std::vector<float> weights;  ///< of k = 1..radius
};
FirKernel fir_kernel(double sigma);
void fir_panel(const float* in, std::ptrdiff_t count, const FirKernel& kernel, float* out);

/// Deriche's recursive Gaussian of order 4 as two complex one-pole filters each way (stable in this
/// form at any sigma), normalised so that constants pass. The end samples continue on both sides.
struct RecursiveKernel {
  struct Pole {
    double re, im;                ///< d in s[i] = d s[i-1] + x[i]
    double a_re, a_im;            ///< contribution Re(a s[i])
    double steady_re, steady_im;  ///< 1 / (1 - d)
  };
  std::array<Pole, 2> poles;
};
RecursiveKernel recursive_kernel(double sigma);
void recursive_panel(const float* in, std::ptrdiff_t count, const RecursiveKernel& kernel,
                     float* out);

}  // namespace normalshop
