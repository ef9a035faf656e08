#pragma once

#include <cstddef>
#include <vector>

/// The inner loops of linear filters over numbers in a row, private to this floor.
namespace normalshop {

/// Weights of k = 1.. to both sides of a Gaussian that is cut off after so many sigmas; with the
/// middle one they add to 1.
std::vector<double> gaussian_weights(double sigma, double sigmas = 4.0);
/// Of its second derivative, cut off after 6 sigmas: the pairs' sum is 1 for in[i] = i^2 / 2.
std::vector<double> bending_weights(double sigma);

/// Pairs of numbers near a number, and their weights.
struct WeightedPairs {
  std::vector<std::ptrdiff_t> before;
  std::vector<std::ptrdiff_t> after;
  std::vector<float> weights;

  void add(std::ptrdiff_t before_offset, std::ptrdiff_t after_offset, double weight) {
    before.push_back(before_offset);
    after.push_back(after_offset);
    weights.push_back(static_cast<float>(weight));
  }
};
/// Those at k steps, for such weights.
WeightedPairs line_pairs(const std::vector<double>& weights, std::ptrdiff_t step);
/// out[i] = in[i] + sum_k weights[k] (in[i + before[k]] + in[i + after[k]] - 2 in[i]): a constant
/// stays what it is to the last bit.
void pairs_around(const float* in, std::ptrdiff_t count, const WeightedPairs& sum, float* out);
/// The sum without in[i].
void pairs_only(const float* in, std::ptrdiff_t count, const WeightedPairs& sum, float* out);

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

/// out = a - b.
void difference(const float* a, const float* b, std::ptrdiff_t count, float* out);

}  // namespace normalshop
