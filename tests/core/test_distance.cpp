#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "normalshop/core/distance.h"
#include "normalshop/core/random.h"

namespace normalshop {
namespace {

TEST(Distance, MatchesBruteForce) {
  Random random(5);
  for (const int limit : {1, 3, 9, 40}) {
    Image<std::uint8_t> set(211, 93, 0);
    std::vector<Vec2i> places;
    for (int i = 0; i < 25; ++i) {
      places.emplace_back(static_cast<int>(random.uniform(0, 120)),
                          static_cast<int>(random.uniform(0, 93)));
      set(places.back().x(), places.back().y()) = 1;
    }
    MaskImage distance;
    distance_to(set, limit, distance);
    for (int y = 0; y < set.height(); ++y) {
      for (int x = 0; x < set.width(); ++x) {
        float nearest = static_cast<float>(limit);
        for (const Vec2i& p : places) {
          nearest = std::min(nearest, std::hypot(float(x - p.x()), float(y - p.y())));
        }
        ASSERT_NEAR(distance(x, y), nearest, 1e-5F) << x << " " << y << " " << limit;
      }
    }
  }
}

}  // namespace
}  // namespace normalshop
