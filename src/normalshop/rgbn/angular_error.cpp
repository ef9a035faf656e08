#include "normalshop/rgbn/angular_error.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "normalshop/core/parallel.h"
#include "normalshop/core/slope.h"

namespace normalshop {

void angles_between(ImageView<Vec3f> a, ImageView<Vec3f> b, MaskView mask, MaskSpan degrees) {
  parallel_for(static_cast<std::size_t>(a.height()), 32, [&](std::size_t begin, std::size_t end) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      for (int x = 0; x < a.width(); ++x) {
        const bool counts =
            (mask.empty() || mask(x, y) > 0.0F) && !a(x, y).isZero() && !b(x, y).isZero();
        degrees(x, y) = counts ? static_cast<float>(angle_degrees(a(x, y), b(x, y)))
                               : std::numeric_limits<float>::quiet_NaN();
      }
    }
  });
}

AngularError summarize(MaskView degrees) {
  std::vector<float> values;
  double sum = 0.0;
  for (int y = 0; y < degrees.height(); ++y) {
    for (int x = 0; x < degrees.width(); ++x) {
      const float d = degrees(x, y);
      if (std::isnan(d)) continue;
      values.push_back(d);
      sum += d;
    }
  }
  AngularError out;
  out.pixels = values.size();
  if (values.empty()) return out;
  const auto rank = [&](double share) {
    const double place = std::ceil(share * static_cast<double>(values.size()));
    const auto i = static_cast<std::size_t>(std::max(place, 1.0)) - 1;
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(i), values.end());
    return static_cast<double>(values[i]);
  };
  out.mean = sum / static_cast<double>(values.size());
  out.median = rank(0.5);
  out.p99 = rank(0.99);
  out.largest = rank(1.0);
  return out;
}

}  // namespace normalshop
