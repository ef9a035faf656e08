#include "normalshop/rgbn/detail/line_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "normalshop/rgbn/line_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

// Every lane is a number of its own and no multiply-add is fused, so all targets give the same
// bits.
HWY_BEFORE_NAMESPACE();
namespace normalshop::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// What a sum is of, as the loops want it.
struct Taps {
  const std::ptrdiff_t* before;
  const std::ptrdiff_t* after;
  const float* weights;
  std::ptrdiff_t count;
};

struct PairSum {
  bool with_own;
  template <int N, class D>
  HWY_INLINE void Vectors(D d, const float* in, const Taps& taps, float* out) const {
    const auto lanes = static_cast<std::ptrdiff_t>(hn::Lanes(d));
    hn::Vec<D> twice[N];
    hn::Vec<D> sum[N];
    for (int j = 0; j < N; ++j) {
      const auto own = hn::LoadU(d, in + j * lanes);
      twice[j] = hn::Add(own, own);
      sum[j] = hn::Zero(d);
    }
    for (std::ptrdiff_t k = 0; k < taps.count; ++k) {
      const auto w = hn::Set(d, taps.weights[k]);
      const float* before = in + taps.before[k];
      const float* after = in + taps.after[k];
      for (int j = 0; j < N; ++j) {
        const auto pair =
            hn::Add(hn::LoadU(d, before + j * lanes), hn::LoadU(d, after + j * lanes));
        sum[j] = hn::Add(sum[j], hn::Mul(w, hn::Sub(pair, twice[j])));
      }
    }
    for (int j = 0; j < N; ++j) {
      if (with_own) sum[j] = hn::Add(hn::LoadU(d, in + j * lanes), sum[j]);
      hn::StoreU(sum[j], d, out + j * lanes);
    }
  }
};

struct PlainSum {
  template <int N, class D>
  HWY_INLINE void Vectors(D d, const float* in, const Taps& taps, float* out) const {
    const auto lanes = static_cast<std::ptrdiff_t>(hn::Lanes(d));
    hn::Vec<D> sum[N];
    for (int j = 0; j < N; ++j) sum[j] = hn::Zero(d);
    for (std::ptrdiff_t k = 0; k < taps.count; ++k) {
      const auto w = hn::Set(d, taps.weights[k]);
      const float* from = in + taps.after[k];
      for (int j = 0; j < N; ++j) {
        sum[j] = hn::Add(sum[j], hn::Mul(w, hn::LoadU(d, from + j * lanes)));
      }
    }
    for (int j = 0; j < N; ++j) hn::StoreU(sum[j], d, out + j * lanes);
  }
};

template <class Kind>
HWY_INLINE void AllNumbers(const Kind& kind, const float* in, std::ptrdiff_t count,
                           const Taps& taps, float* out) {
  const hn::CappedTag<float, 16> d;
  const hn::CappedTag<float, 1> one;
  const auto lanes = static_cast<std::ptrdiff_t>(hn::Lanes(d));
  std::ptrdiff_t i = 0;
  for (; i + 4 * lanes <= count; i += 4 * lanes) {
    kind.template Vectors<4>(d, in + i, taps, out + i);
  }
  for (; i + lanes <= count; i += lanes) kind.template Vectors<1>(d, in + i, taps, out + i);
  for (; i < count; ++i) kind.template Vectors<1>(one, in + i, taps, out + i);
}

void SumOfPairs(const float* in, std::ptrdiff_t count, const WeightedPairs& sum, bool with_own,
                float* out) {
  const Taps taps{sum.before.data(), sum.after.data(), sum.weights.data(),
                  static_cast<std::ptrdiff_t>(sum.weights.size())};
  AllNumbers(PairSum{with_own}, in, count, taps, out);
}

void Sum(const float* in, std::ptrdiff_t count, const WeightedSum& sum, float* out) {
  const Taps taps{nullptr, sum.offsets.data(), sum.weights.data(),
                  static_cast<std::ptrdiff_t>(sum.weights.size())};
  AllNumbers(PlainSum(), in, count, taps, out);
}

void Difference(const float* a, const float* b, std::ptrdiff_t count, float* out) {
  const hn::CappedTag<float, 16> d;
  const auto lanes = static_cast<std::ptrdiff_t>(hn::Lanes(d));
  std::ptrdiff_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    hn::StoreU(hn::Sub(hn::LoadU(d, a + i), hn::LoadU(d, b + i)), d, out + i);
  }
  for (; i < count; ++i) out[i] = a[i] - b[i];
}

}  // namespace normalshop::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <cmath>

namespace normalshop {

HWY_EXPORT(SumOfPairs);
HWY_EXPORT(Sum);
HWY_EXPORT(Difference);

std::vector<double> gaussian_weights(double sigma, double sigmas) {
  const int radius = static_cast<int>(std::ceil(sigmas * sigma));
  std::vector<double> weights;
  double sum = 1.0;
  for (int k = 1; k <= radius; ++k) {
    weights.push_back(std::exp(-0.5 * k * k / (sigma * sigma)));
    sum += 2.0 * weights.back();
  }
  for (double& w : weights) w /= sum;
  return weights;
}

std::vector<double> bending_weights(double sigma) {
  const int radius = static_cast<int>(std::ceil(6.0 * sigma));
  std::vector<double> weights;
  double moment = 0.0;
  for (int k = 1; k <= radius; ++k) {
    const double t = k * k / (sigma * sigma);
    // Over the factor of k = 1, which is 0 in double for the smallest sigmas.
    weights.push_back((t - 1.0) * std::exp(-0.5 * (k * k - 1.0) / (sigma * sigma)));
    moment += k * k * weights.back();
  }
  for (double& w : weights) w /= moment;
  return weights;
}

WeightedPairs line_pairs(const std::vector<double>& weights, std::ptrdiff_t step) {
  WeightedPairs pairs;
  // From the smallest weights to the largest.
  for (auto k = static_cast<std::ptrdiff_t>(weights.size()); k >= 1; --k) {
    pairs.add(-k * step, k * step, weights[static_cast<std::size_t>(k - 1)]);
  }
  return pairs;
}

void pairs_around(const float* in, std::ptrdiff_t count, const WeightedPairs& sum, float* out) {
  HWY_DYNAMIC_DISPATCH(SumOfPairs)(in, count, sum, true, out);
}

void pairs_only(const float* in, std::ptrdiff_t count, const WeightedPairs& sum, float* out) {
  HWY_DYNAMIC_DISPATCH(SumOfPairs)(in, count, sum, false, out);
}

void weighted_sum(const float* in, std::ptrdiff_t count, const WeightedSum& sum, float* out) {
  HWY_DYNAMIC_DISPATCH(Sum)(in, count, sum, out);
}

void difference(const float* a, const float* b, std::ptrdiff_t count, float* out) {
  HWY_DYNAMIC_DISPATCH(Difference)(a, b, count, out);
}

}  // namespace normalshop
#endif
