#include "normalshop/rgbn/detail/lattice.h"

namespace normalshop {

namespace {

// In steps: sigma and cut of the Gaussians before and after the points.
constexpr double narrow_sigma = 1.0;
constexpr double narrow_cut = 5.0;
constexpr double join_sigma = 0.85;
constexpr double join_cut = 3.6;

/// Weights of the points from `before` before a pixel's own one on.
std::vector<float> join_weights(double place, int before, int after) {
  std::vector<double> weights;
  double sum = 0.0;
  for (int k = -before; k <= after; ++k) {
    const double t = (k - place) / join_sigma;
    weights.push_back(std::abs(k - place) <= join_cut ? std::exp(-0.5 * t * t) : 0.0);
    sum += weights.back();
  }
  std::vector<float> result;
  result.reserve(weights.size());
  for (const double w : weights) result.push_back(static_cast<float>(w / sum));
  return result;
}

}  // namespace

Lattice::Lattice(double sigma, int point_step) : step(point_step), rest(sigma), joins(1) {
  if (step == 1) {
    joins[0].push_back(1.0F);
    return;
  }
  narrow = gaussian_weights(narrow_sigma * step, narrow_cut);
  const double part = std::hypot(narrow_sigma, join_sigma);
  rest = std::sqrt(sigma * sigma / (step * step) - part * part);
  before = static_cast<int>(join_cut);
  after = before + 1;
  joins.clear();
  for (int p = 0; p < step; ++p) joins.push_back(join_weights(1.0 * p / step, before, after));
}

std::vector<WeightedSum> Lattice::sums(std::ptrdiff_t stride) const {
  std::vector<WeightedSum> result;
  for (const std::vector<float>& weights : joins) {
    WeightedSum& sum = result.emplace_back();
    sum.add(0, 1.0F);
    int line = 0;
    for (int k = -before; k <= after; ++k) {
      if (k != 0) sum.add(++line * stride, weights[static_cast<std::size_t>(k + before)]);
    }
  }
  return result;
}

}  // namespace normalshop
