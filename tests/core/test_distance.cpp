#include <cmath>

#include <gtest/gtest.h>

#include "normalshop/core/distance.h"
#include "normalshop/core/random.h"

namespace normalshop {
namespace {

TEST(Distance, MatchesBruteForce) {
  Random random(5);
  for (const int limit : {1, 3, 9, 40}) {
    Image<std::uint8_t> set(211, 93, 0);
    for (int i = 0; i < 25; ++i) {
      set(static_cast<int>(random.uniform(0, 120)), static_cast<int>(random.uniform(0, 93))) = 1;
    }
    MaskImage distance;
    distance_to(set, limit, distance);
    for (int y = 0; y < set.height(); ++y) {
      for (int x = 0; x < set.width(); ++x) {
        float nearest = static_cast<float>(limit);
        for (int j = 0; j < set.height(); ++j) {
          for (int i = 0; i < set.width(); ++i) {
            if (set(i, j) != 0) nearest = std::min(nearest, std::hypot(float(x - i), float(y - j)));
          }
        }
        ASSERT_NEAR(distance(x, y), nearest, 1e-5F) << x << " " << y << " " << limit;
      }
    }
  }
}

}  // namespace
}  // namespace normalshop
