#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "normalshop/core/image.h"

/// The inner loops of linear filters, private to this floor.
namespace normalshop {

/// out[i] = in[i] + sum_k weights[k] (in[i - k step] + in[i + k step] - 2 in[i]), k = 1..radius: a
/// constant stays what it is to the last bit.
struct FirKernel {
  std::vector<float> weights;  ///< of k = 1..radius
  int radius() const { return static_cast<int>(weights.size()); }
};
FirKernel fir_kernel(double sigma);
/// Of the second derivative of the Gaussian: the sum without in[i] is 1 for in[i] = i^2 / 2.
FirKernel fir_second_derivative(double sigma);
void fir_line(const float* in, std::ptrdiff_t count, std::ptrdiff_t step, const FirKernel& kernel,
              float* out);
/// The sum without in[i].
void fir_differences(const float* in, std::ptrdiff_t count, std::ptrdiff_t step,
                     const FirKernel& kernel, float* out);

/// Some numbers near a number, and their weights.
struct WeightedSum {
  std::vector<std::ptrdiff_t> offsets;
  std::vector<float> weights;

  void add(std::ptrdiff_t offset, float weight) {
    if (weight == 0.0F) return;
    offsets.push_back(offset);
    weights.push_back(weight);
  }
};

/// out[i] = the sum of weights[k] in[i + offsets[k]], in the order of k.
void weighted_sum(const float* in, std::ptrdiff_t count, const WeightedSum& sum, float* out);

/// Deriche's recursive Gaussian of order 4: two sections each way, normalised so that constants
/// pass. A section turns x into u by
///     u[i] = a u[i-1] + v[i-1] + gain x[i],    v[i] = b u[i-1] + c v[i-1],
/// where v is about u / sigma and b about 1 / sigma^2, so that few digits are lost at any sigma.
struct RecursiveKernel {
  struct Section {
    double a, b, c, gain;
    double steady_u, steady_v;  ///< for x = 1 for ever
  };
  std::array<Section, 2> sections;
  bool wide;  ///< in double precision
};
RecursiveKernel recursive_kernel(double sigma);

/// Successive samples of neighbouring lines: sample i of line j is at[i * stride + j].
struct Samples {
  float* at;
  std::ptrdiff_t stride;
};
struct ConstSamples {
  const float* at;
  std::ptrdiff_t stride;
};

/// Lines on their way through the filter: forward over all blocks, then backward over all blocks
/// from the last to the first. They are computed relative to `first`, one number a line: lines of
/// one value keep it to the last bit.
class RecursiveLines {
 public:
  RecursiveLines(const RecursiveKernel& kernel, int lanes);

  /// Before the first block in either direction: `edge` has been there for ever.
  void start(const float* first, const float* edge, int lanes);
  /// out = the filter of all samples up to each.
  void forward(const ConstSamples& in, const Samples& out, int count, int lanes);
  /// Turns `out` of forward() into the result.
  void backward(const ConstSamples& in, const Samples& out, int count, int lanes);

 private:
  RecursiveKernel kernel_;
  Image<float> narrow_;  ///< first, u, u, v, v of all lines
  Image<double> wide_;
};

}  // namespace normalshop
