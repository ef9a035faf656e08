#include "normalshop/rgbn/detail/gaussian_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "normalshop/rgbn/gaussian_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

// Every lane is a column of its own and no multiply-add is fused, so all targets give the same
// bits.
HWY_BEFORE_NAMESPACE();
namespace normalshop::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using FloatTag = hn::CappedTag<float, 16>;
using DoubleTag = hn::CappedTag<double, 8>;
using NarrowTag = hn::Rebind<float, DoubleTag>;

void FirPanel(const float* in, std::ptrdiff_t count, const float* weights, std::ptrdiff_t radius,
              float* out) {
  const FloatTag d;
  const auto step = static_cast<std::ptrdiff_t>(2 * hn::Lanes(d));
  const auto half = static_cast<std::ptrdiff_t>(hn::Lanes(d));
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    for (std::ptrdiff_t lane = 0; lane < panel_lanes; lane += step) {
      const float* center = in + i * panel_lanes + lane;
      const auto c0 = hn::LoadU(d, center);
      const auto c1 = hn::LoadU(d, center + half);
      const auto twice0 = hn::Add(c0, c0);
      const auto twice1 = hn::Add(c1, c1);
      auto sum0 = hn::Zero(d);
      auto sum1 = hn::Zero(d);
      // From the smallest weights to the largest.
      for (std::ptrdiff_t k = radius; k >= 1; --k) {
        const auto w = hn::Set(d, weights[k - 1]);
        const float* before = center - k * panel_lanes;
        const float* after = center + k * panel_lanes;
        const auto pair0 = hn::Add(hn::LoadU(d, before), hn::LoadU(d, after));
        const auto pair1 = hn::Add(hn::LoadU(d, before + half), hn::LoadU(d, after + half));
        sum0 = hn::Add(sum0, hn::Mul(w, hn::Sub(pair0, twice0)));
        sum1 = hn::Add(sum1, hn::Mul(w, hn::Sub(pair1, twice1)));
      }
      hn::StoreU(hn::Add(c0, sum0), d, out + i * panel_lanes + lane);
      hn::StoreU(hn::Add(c1, sum1), d, out + i * panel_lanes + lane + half);
    }
  }
}

using V = hn::Vec<DoubleTag>;

/// Two one-pole filters over one vector of columns.
struct State {
  V re[2];
  V im[2];
};

HWY_INLINE V Advance(State& s, const V x, const RecursiveKernel& kernel) {
  const DoubleTag d;
  V sum = hn::Zero(d);
  for (int k = 0; k < 2; ++k) {
    const auto& p = kernel.poles[static_cast<std::size_t>(k)];
    const V p_re = hn::Set(d, p.re);
    const V p_im = hn::Set(d, p.im);
    const V re = hn::Add(hn::Sub(hn::Mul(p_re, s.re[k]), hn::Mul(p_im, s.im[k])), x);
    s.im[k] = hn::Add(hn::Mul(p_re, s.im[k]), hn::Mul(p_im, s.re[k]));
    s.re[k] = re;
    sum = hn::Add(
        sum, hn::Sub(hn::Mul(hn::Set(d, p.a_re), s.re[k]), hn::Mul(hn::Set(d, p.a_im), s.im[k])));
  }
  return sum;
}

HWY_INLINE V LoadWide(const float* from) {
  return hn::PromoteTo(DoubleTag(), hn::LoadU(NarrowTag(), from));
}

template <int N>
void RecursiveLanes(const float* in, std::ptrdiff_t count, const RecursiveKernel& kernel,
                    float* out) {
  const DoubleTag d;
  const auto n = static_cast<std::ptrdiff_t>(hn::Lanes(d));
  State states[N];
  V first[N];
  for (int j = 0; j < N; ++j) {
    first[j] = LoadWide(in + j * n);
    for (int k = 0; k < 2; ++k) states[j].re[k] = states[j].im[k] = hn::Zero(d);
  }
  // Relative to the first sample: the filter starts at rest and constants stay exact.
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    for (int j = 0; j < N; ++j) {
      const V x = hn::Sub(LoadWide(in + i * panel_lanes + j * n), first[j]);
      const V y = Advance(states[j], x, kernel);
      hn::StoreU(hn::DemoteTo(NarrowTag(), y), NarrowTag(), out + i * panel_lanes + j * n);
    }
  }
  for (int j = 0; j < N; ++j) {
    const V last = hn::Sub(LoadWide(in + (count - 1) * panel_lanes + j * n), first[j]);
    for (int k = 0; k < 2; ++k) {
      const auto& p = kernel.poles[static_cast<std::size_t>(k)];
      states[j].re[k] = hn::Mul(last, hn::Set(d, p.steady_re));
      states[j].im[k] = hn::Mul(last, hn::Set(d, p.steady_im));
    }
  }
  // The anticausal half leaves the sample itself out: advance with it after use.
  for (std::ptrdiff_t i = count - 1; i >= 0; --i) {
    for (int j = 0; j < N; ++j) {
      float* at = out + i * panel_lanes + j * n;
      V sum = hn::Zero(d);
      for (int k = 0; k < 2; ++k) {
        const auto& p = kernel.poles[static_cast<std::size_t>(k)];
        const V p_re = hn::Set(d, p.re);
        const V p_im = hn::Set(d, p.im);
        const V re = hn::Sub(hn::Mul(p_re, states[j].re[k]), hn::Mul(p_im, states[j].im[k]));
        const V im = hn::Add(hn::Mul(p_re, states[j].im[k]), hn::Mul(p_im, states[j].re[k]));
        sum =
            hn::Add(sum, hn::Sub(hn::Mul(hn::Set(d, p.a_re), re), hn::Mul(hn::Set(d, p.a_im), im)));
        const V x = hn::Sub(LoadWide(in + i * panel_lanes + j * n), first[j]);
        states[j].re[k] = hn::Add(re, x);
        states[j].im[k] = im;
      }
      const V y = hn::Add(first[j], hn::Add(LoadWide(at), sum));
      hn::StoreU(hn::DemoteTo(NarrowTag(), y), NarrowTag(), at);
    }
  }
}

void RecursivePanel(const float* in, std::ptrdiff_t count, const RecursiveKernel& kernel,
                    float* out) {
  constexpr int unroll = 2;
  const auto step = static_cast<std::ptrdiff_t>(unroll * hn::Lanes(DoubleTag()));
  for (std::ptrdiff_t lane = 0; lane < panel_lanes; lane += step) {
    RecursiveLanes<unroll>(in + lane, count, kernel, out + lane);
  }
}

}  // namespace normalshop::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <cmath>
#include <complex>

namespace normalshop {

HWY_EXPORT(FirPanel);
HWY_EXPORT(RecursivePanel);

FirKernel fir_kernel(double sigma) {
  const int radius = static_cast<int>(std::ceil(4.0 * sigma));
  std::vector<double> weights;
  double sum = 1.0;
  for (int k = 1; k <= radius; ++k) {
    weights.push_back(std::exp(-0.5 * k * k / (sigma * sigma)));
    sum += 2.0 * weights.back();
  }
  FirKernel kernel;
  for (const double w : weights) kernel.weights.push_back(static_cast<float>(w / sum));
  return kernel;
}

void fir_panel(const float* in, std::ptrdiff_t count, const FirKernel& kernel, float* out) {
  HWY_DYNAMIC_DISPATCH(FirPanel)
  (in, count, kernel.weights.data(), static_cast<std::ptrdiff_t>(kernel.weights.size()), out);
}

RecursiveKernel recursive_kernel(double sigma) {
  using Complex = std::complex<double>;
  // Amplitudes and exponents of Deriche's order 4 as optimised by Getreuer (IPOL 2013).
  const std::array<Complex, 2> amplitudes = {Complex(0.84, 1.8675), Complex(-0.34015, -0.1299)};
  const std::array<Complex, 2> exponents = {Complex(1.783, 0.6318), Complex(1.723, 1.997)};
  RecursiveKernel kernel;
  double sum = 0.0;
  for (std::size_t k = 0; k < 2; ++k) {
    const Complex d = std::exp(-exponents[k] / sigma);
    const Complex steady = 1.0 / (1.0 - d);
    const Complex a = 2.0 * amplitudes[k];  // with its conjugate
    kernel.poles[k] = {d.real(), d.imag(), a.real(), a.imag(), steady.real(), steady.imag()};
    sum += (a * steady + a * d * steady).real();
  }
  for (auto& pole : kernel.poles) {
    pole.a_re /= sum;
    pole.a_im /= sum;
  }
  return kernel;
}

void recursive_panel(const float* in, std::ptrdiff_t count, const RecursiveKernel& kernel,
                     float* out) {
  HWY_DYNAMIC_DISPATCH(RecursivePanel)(in, count, kernel, out);
}

}  // namespace normalshop
#endif
