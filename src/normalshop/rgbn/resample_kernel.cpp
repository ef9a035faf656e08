#include "normalshop/rgbn/resample_kernel.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "normalshop/core/error.h"

namespace normalshop {

namespace {

/// How the weights of one row (or column) spread over the pixels around the middle one.
struct Spread {
  int from = 0;  ///< weights
  int to = 0;    ///< pixels
  std::vector<double> shares;

  double operator()(int weight, int pixel) const {
    return shares[static_cast<std::size_t>(weight * to + pixel)];
  }
};

Spread make_spread(int side, double scale) {
  const double half = std::max(scale, 1.0);
  const int middle = side / 2;
  const int radius = static_cast<int>(resampled_reach(middle, scale));
  Spread spread{side, 2 * radius + 1, {}};
  for (int i = 0; i < side; ++i) {
    const double place = (i - middle) * scale;
    std::vector<double> row;
    double sum = 0.0;
    for (int o = -radius; o <= radius; ++o) {
      row.push_back(std::max(0.0, 1.0 - std::abs(o - place) / half));
      sum += row.back();
    }
    for (const double share : row) spread.shares.push_back(share / sum);
  }
  return spread;
}

void check(KernelView kernel, float scale) {
  if (kernel.width() % 2 == 0 || kernel.height() % 2 == 0) {
    throw InvalidInput("convolve: the kernel must have sides of an odd number of pixels");
  }
  if (!(scale >= 0.0F && std::isfinite(scale))) {
    throw InvalidInput("convolve: a kernel's pixel must have a length from 0 on");
  }
  const int longer = std::max(kernel.width(), kernel.height());
  const double side = 2.0 * resampled_reach(longer / 2, static_cast<double>(scale)) + 1.0;
  if (side > longest_resampled_kernel) {
    throw InvalidInput("convolve: with pixels that long the kernel would be more than " +
                       std::to_string(longest_resampled_kernel) +
                       " pixels of the image wide or high");
  }
}

/// The kernel's rows, each as long as the result's.
std::vector<double> spread_rows(KernelView kernel, const Spread& across) {
  std::vector<double> rows;
  for (int y = 0; y < kernel.height(); ++y) {
    for (int o = 0; o < across.to; ++o) {
      double sum = 0.0;
      for (int x = 0; x < kernel.width(); ++x) {
        sum += across(x, o) * static_cast<double>(kernel(x, y));
      }
      rows.push_back(sum);
    }
  }
  return rows;
}

}  // namespace

double resampled_reach(int radius, double scale) {
  return std::ceil(radius * scale + std::max(scale, 1.0)) - 1.0;
}

Image<float> resample_kernel(KernelView kernel, float scale) {
  check(kernel, scale);
  const Spread across = make_spread(kernel.width(), static_cast<double>(scale));
  const Spread down = make_spread(kernel.height(), static_cast<double>(scale));
  const std::vector<double> rows = spread_rows(kernel, across);
  Image<float> result(across.to, down.to);
  for (int p = 0; p < down.to; ++p) {
    for (int o = 0; o < across.to; ++o) {
      double sum = 0.0;
      for (int y = 0; y < kernel.height(); ++y) {
        sum += down(y, p) * rows[static_cast<std::size_t>(y * across.to + o)];
      }
      result(o, p) = static_cast<float>(sum);
    }
  }
  return result;
}

}  // namespace normalshop
