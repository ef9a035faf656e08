#include "normalshop/rgbn/detail/line_kernels.h"

#ifndef NORMALSHOP_LINE_BLOCK
#define NORMALSHOP_LINE_BLOCK
namespace normalshop {
/// What the recursive kernels work on; this file is compiled once for every target.
struct Block {
  ConstSamples in;
  Samples out;
  std::ptrdiff_t count;
  std::ptrdiff_t lanes;
};
}  // namespace normalshop
#endif

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "normalshop/rgbn/line_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

// Every lane is a line of its own and no multiply-add is fused, so all targets give the same bits.
HWY_BEFORE_NAMESPACE();
namespace normalshop::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using FloatTag = hn::CappedTag<float, 16>;

/// N vectors of a line.
template <int N, bool keep, class D>
HWY_INLINE void FirVectors(D d, const float* in, std::ptrdiff_t step, const float* weights,
                           std::ptrdiff_t radius, float* out) {
  const auto lanes = static_cast<std::ptrdiff_t>(hn::Lanes(d));
  hn::Vec<D> twice[N];
  hn::Vec<D> sum[N];
  for (int j = 0; j < N; ++j) {
    const auto center = hn::LoadU(d, in + j * lanes);
    twice[j] = hn::Add(center, center);
    sum[j] = hn::Zero(d);
  }
  // From the smallest weights to the largest.
  for (std::ptrdiff_t k = radius; k >= 1; --k) {
    const auto w = hn::Set(d, weights[k - 1]);
    const float* before = in - k * step;
    const float* after = in + k * step;
    for (int j = 0; j < N; ++j) {
      const auto pair = hn::Add(hn::LoadU(d, before + j * lanes), hn::LoadU(d, after + j * lanes));
      sum[j] = hn::Add(sum[j], hn::Mul(w, hn::Sub(pair, twice[j])));
    }
  }
  for (int j = 0; j < N; ++j) {
    if (keep) sum[j] = hn::Add(hn::LoadU(d, in + j * lanes), sum[j]);
    hn::StoreU(sum[j], d, out + j * lanes);
  }
}

template <bool keep>
HWY_INLINE void Fir(const float* in, std::ptrdiff_t count, std::ptrdiff_t step,
                    const float* weights, std::ptrdiff_t radius, float* out) {
  const FloatTag d;
  const hn::CappedTag<float, 1> one;
  const auto lanes = static_cast<std::ptrdiff_t>(hn::Lanes(d));
  std::ptrdiff_t i = 0;
  for (; i + 4 * lanes <= count; i += 4 * lanes) {
    FirVectors<4, keep>(d, in + i, step, weights, radius, out + i);
  }
  for (; i + lanes <= count; i += lanes) {
    FirVectors<1, keep>(d, in + i, step, weights, radius, out + i);
  }
  for (; i < count; ++i) FirVectors<1, keep>(one, in + i, step, weights, radius, out + i);
}

void FirLine(const float* in, std::ptrdiff_t count, std::ptrdiff_t step, const float* weights,
             std::ptrdiff_t radius, float* out) {
  Fir<true>(in, count, step, weights, radius, out);
}

void FirDifferences(const float* in, std::ptrdiff_t count, std::ptrdiff_t step,
                    const float* weights, std::ptrdiff_t radius, float* out) {
  Fir<false>(in, count, step, weights, radius, out);
}

template <int N, class D>
HWY_INLINE void SumVectors(D d, const float* in, const std::ptrdiff_t* offsets,
                           const float* weights, std::ptrdiff_t taps, float* out) {
  const auto lanes = static_cast<std::ptrdiff_t>(hn::Lanes(d));
  hn::Vec<D> sum[N];
  for (int j = 0; j < N; ++j) sum[j] = hn::Zero(d);
  for (std::ptrdiff_t k = 0; k < taps; ++k) {
    const auto w = hn::Set(d, weights[k]);
    const float* from = in + offsets[k];
    for (int j = 0; j < N; ++j) {
      sum[j] = hn::Add(sum[j], hn::Mul(w, hn::LoadU(d, from + j * lanes)));
    }
  }
  for (int j = 0; j < N; ++j) hn::StoreU(sum[j], d, out + j * lanes);
}

void Sum(const float* in, std::ptrdiff_t count, const std::ptrdiff_t* offsets, const float* weights,
         std::ptrdiff_t taps, float* out) {
  const FloatTag d;
  const hn::CappedTag<float, 1> one;
  const auto lanes = static_cast<std::ptrdiff_t>(hn::Lanes(d));
  std::ptrdiff_t i = 0;
  for (; i + 8 * lanes <= count; i += 8 * lanes) {
    SumVectors<8>(d, in + i, offsets, weights, taps, out + i);
  }
  for (; i + lanes <= count; i += lanes) {
    SumVectors<1>(d, in + i, offsets, weights, taps, out + i);
  }
  for (; i < count; ++i) SumVectors<1>(one, in + i, offsets, weights, taps, out + i);
}

template <class D>
HWY_INLINE hn::Vec<D> LoadNumbers(D d, const float* from) {
  if constexpr (sizeof(hn::TFromD<D>) == sizeof(float)) {
    return hn::LoadU(d, from);
  } else {
    return hn::PromoteTo(d, hn::LoadU(hn::Rebind<float, D>(), from));
  }
}

template <class D>
HWY_INLINE void StoreNumbers(D d, hn::Vec<D> value, float* to) {
  if constexpr (sizeof(hn::TFromD<D>) == sizeof(float)) {
    hn::StoreU(value, d, to);
  } else {
    const hn::Rebind<float, D> narrow;
    hn::StoreU(hn::DemoteTo(narrow, value), narrow, to);
  }
}

/// The two sections over one vector of lines, and what they are relative to.
template <class D>
struct Sections {
  using V = hn::Vec<D>;
  using T = hn::TFromD<D>;

  HWY_INLINE void Read(D d, const T* from, std::ptrdiff_t lanes) {
    first = hn::LoadU(d, from);
    for (int k = 0; k < 2; ++k) {
      u[k] = hn::LoadU(d, from + (1 + k) * lanes);
      v[k] = hn::LoadU(d, from + (3 + k) * lanes);
    }
  }
  HWY_INLINE void Write(D d, T* to, std::ptrdiff_t lanes) const {
    for (int k = 0; k < 2; ++k) {
      hn::StoreU(u[k], d, to + (1 + k) * lanes);
      hn::StoreU(v[k], d, to + (3 + k) * lanes);
    }
  }
  /// Moves on to the next sample, which still counts as 0. Returns the sum of u.
  HWY_INLINE V Step(D d, const RecursiveKernel& kernel) {
    for (int k = 0; k < 2; ++k) {
      const auto& s = kernel.sections[static_cast<std::size_t>(k)];
      const V next = hn::Add(hn::Mul(hn::Set(d, static_cast<T>(s.a)), u[k]), v[k]);
      v[k] = hn::Add(hn::Mul(hn::Set(d, static_cast<T>(s.b)), u[k]),
                     hn::Mul(hn::Set(d, static_cast<T>(s.c)), v[k]));
      u[k] = next;
    }
    return hn::Add(u[0], u[1]);
  }
  HWY_INLINE V Take(D d, V x, const RecursiveKernel& kernel) {
    for (int k = 0; k < 2; ++k) {
      const auto& s = kernel.sections[static_cast<std::size_t>(k)];
      u[k] = hn::Add(u[k], hn::Mul(hn::Set(d, static_cast<T>(s.gain)), x));
    }
    return hn::Add(u[0], u[1]);
  }

  V first;
  V u[2];
  V v[2];
};

/// N vectors of lines.
struct Forward {
  template <int N, class D>
  HWY_INLINE void Run(D d, const Block& block, const RecursiveKernel& kernel, hn::TFromD<D>* state,
                      std::ptrdiff_t lane) const {
    const auto n = static_cast<std::ptrdiff_t>(hn::Lanes(d));
    Sections<D> sections[N];
    for (int j = 0; j < N; ++j) sections[j].Read(d, state + lane + j * n, block.lanes);
    for (std::ptrdiff_t i = 0; i < block.count; ++i) {
      for (int j = 0; j < N; ++j) {
        const auto x = LoadNumbers(d, block.in.at + i * block.in.stride + lane + j * n);
        sections[j].Step(d, kernel);
        const auto sum = sections[j].Take(d, hn::Sub(x, sections[j].first), kernel);
        StoreNumbers(d, sum, block.out.at + i * block.out.stride + lane + j * n);
      }
    }
    for (int j = 0; j < N; ++j) sections[j].Write(d, state + lane + j * n, block.lanes);
  }
};

/// The anticausal half leaves the sample itself out: it is taken after use.
struct Backward {
  template <int N, class D>
  HWY_INLINE void Run(D d, const Block& block, const RecursiveKernel& kernel, hn::TFromD<D>* state,
                      std::ptrdiff_t lane) const {
    const auto n = static_cast<std::ptrdiff_t>(hn::Lanes(d));
    Sections<D> sections[N];
    for (int j = 0; j < N; ++j) sections[j].Read(d, state + lane + j * n, block.lanes);
    for (std::ptrdiff_t i = block.count - 1; i >= 0; --i) {
      for (int j = 0; j < N; ++j) {
        const auto x = LoadNumbers(d, block.in.at + i * block.in.stride + lane + j * n);
        float* to = block.out.at + i * block.out.stride + lane + j * n;
        const auto later = sections[j].Step(d, kernel);
        sections[j].Take(d, hn::Sub(x, sections[j].first), kernel);
        const auto sum = hn::Add(LoadNumbers(d, to), later);
        StoreNumbers(d, hn::Add(sections[j].first, sum), to);
      }
    }
    for (int j = 0; j < N; ++j) sections[j].Write(d, state + lane + j * n, block.lanes);
  }
};

template <class T, class Direction>
HWY_INLINE void AllLanes(const Block& block, const RecursiveKernel& kernel, T* state,
                         const Direction& direction) {
  const hn::CappedTag<T, 64 / sizeof(T)> d;
  const auto n = static_cast<std::ptrdiff_t>(hn::Lanes(d));
  std::ptrdiff_t lane = 0;
  for (; lane + 2 * n <= block.lanes; lane += 2 * n) {
    direction.template Run<2>(d, block, kernel, state, lane);
  }
  for (; lane + n <= block.lanes; lane += n) {
    direction.template Run<1>(d, block, kernel, state, lane);
  }
  for (; lane < block.lanes; ++lane) {
    direction.template Run<1>(hn::CappedTag<T, 1>(), block, kernel, state, lane);
  }
}

void ForwardNarrow(const Block& block, const RecursiveKernel& kernel, float* state) {
  AllLanes(block, kernel, state, Forward());
}
void ForwardWide(const Block& block, const RecursiveKernel& kernel, double* state) {
  AllLanes(block, kernel, state, Forward());
}
void BackwardNarrow(const Block& block, const RecursiveKernel& kernel, float* state) {
  AllLanes(block, kernel, state, Backward());
}
void BackwardWide(const Block& block, const RecursiveKernel& kernel, double* state) {
  AllLanes(block, kernel, state, Backward());
}

}  // namespace normalshop::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <cmath>
#include <complex>

namespace normalshop {

HWY_EXPORT(FirLine);
HWY_EXPORT(FirDifferences);
HWY_EXPORT(Sum);
HWY_EXPORT(ForwardNarrow);
HWY_EXPORT(ForwardWide);
HWY_EXPORT(BackwardNarrow);
HWY_EXPORT(BackwardWide);

namespace {

/// Up to here single precision is as exact as the filter.
constexpr double narrow_limit = 64.0;

}  // namespace

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

FirKernel fir_second_derivative(double sigma) {
  const int radius = static_cast<int>(std::ceil(6.0 * sigma));
  std::vector<double> weights;
  double moment = 0.0;
  for (int k = 1; k <= radius; ++k) {
    const double t = k * k / (sigma * sigma);
    weights.push_back((t - 1.0) * std::exp(-0.5 * t));
    moment += k * k * weights.back();
  }
  FirKernel kernel;
  for (const double w : weights) kernel.weights.push_back(static_cast<float>(w / moment));
  return kernel;
}

void fir_line(const float* in, std::ptrdiff_t count, std::ptrdiff_t step, const FirKernel& kernel,
              float* out) {
  HWY_DYNAMIC_DISPATCH(FirLine)
  (in, count, step, kernel.weights.data(), kernel.radius(), out);
}

void fir_differences(const float* in, std::ptrdiff_t count, std::ptrdiff_t step,
                     const FirKernel& kernel, float* out) {
  HWY_DYNAMIC_DISPATCH(FirDifferences)
  (in, count, step, kernel.weights.data(), kernel.radius(), out);
}

void weighted_sum(const float* in, std::ptrdiff_t count, const WeightedSum& sum, float* out) {
  HWY_DYNAMIC_DISPATCH(Sum)
  (in, count, sum.offsets.data(), sum.weights.data(),
   static_cast<std::ptrdiff_t>(sum.weights.size()), out);
}

RecursiveKernel recursive_kernel(double sigma) {
  using Complex = std::complex<double>;
  // Amplitudes and exponents of order 4, for sigma 1, that keep the frequency response within
  // 1.4e-4 of the Gaussian's and the kernel within 4e-4 of its peak.
  const std::array<Complex, 2> amplitudes = {Complex(0.833364106, 1.88794012),
                                             Complex(-0.345450169, -0.137580997)};
  const std::array<Complex, 2> exponents = {Complex(1.80301452, 0.626301583),
                                            Complex(1.73845235, 1.9868776)};
  std::array<Complex, 2> poles;
  double sum = 0.0;
  for (std::size_t k = 0; k < 2; ++k) {
    poles[k] = std::exp(-exponents[k] / sigma);
    sum += (amplitudes[k] * (1.0 + poles[k]) / (1.0 - poles[k])).real();
  }
  // u = Re(amplitude s) where s[i] = pole s[i-1] + x[i].
  RecursiveKernel kernel{};
  for (std::size_t k = 0; k < 2; ++k) {
    const Complex d = poles[k];
    const Complex amplitude = amplitudes[k] / sum;
    auto& section = kernel.sections[k];
    section.gain = amplitude.real();
    section.c = (amplitude * std::conj(d)).real() / amplitude.real();
    section.a = 2.0 * d.real() - section.c;
    section.b = section.a * section.c - std::norm(d);
    section.steady_u = (amplitude / (1.0 - d)).real();
    section.steady_v = section.b * section.steady_u / (1.0 - section.c);
  }
  kernel.wide = sigma > narrow_limit;
  return kernel;
}

namespace {

template <class T>
void start_lines(const float* first, const float* edge, int lanes, const RecursiveKernel& kernel,
                 Image<T>& state) {
  for (int i = 0; i < lanes; ++i) {
    const T reference = first[i];
    const T x = edge[i] - reference;
    T* at = state.data() + i;
    at[0] = reference;
    for (const auto& section : kernel.sections) {
      at += lanes;
      at[0] = x * static_cast<T>(section.steady_u);
      at[2 * lanes] = x * static_cast<T>(section.steady_v);
    }
  }
}

}  // namespace

RecursiveLines::RecursiveLines(const RecursiveKernel& kernel, int lanes) : kernel_(kernel) {
  if (kernel.wide) {
    wide_.resize(lanes, 5);
  } else {
    narrow_.resize(lanes, 5);
  }
}

void RecursiveLines::start(const float* first, const float* edge, int lanes) {
  if (kernel_.wide) {
    start_lines(first, edge, lanes, kernel_, wide_);
  } else {
    start_lines(first, edge, lanes, kernel_, narrow_);
  }
}

void RecursiveLines::forward(const ConstSamples& in, const Samples& out, int count, int lanes) {
  const Block block{in, out, count, lanes};
  if (kernel_.wide) {
    HWY_DYNAMIC_DISPATCH(ForwardWide)(block, kernel_, wide_.data());
  } else {
    HWY_DYNAMIC_DISPATCH(ForwardNarrow)(block, kernel_, narrow_.data());
  }
}

void RecursiveLines::backward(const ConstSamples& in, const Samples& out, int count, int lanes) {
  const Block block{in, out, count, lanes};
  if (kernel_.wide) {
    HWY_DYNAMIC_DISPATCH(BackwardWide)(block, kernel_, wide_.data());
  } else {
    HWY_DYNAMIC_DISPATCH(BackwardNarrow)(block, kernel_, narrow_.data());
  }
}

}  // namespace normalshop
#endif
