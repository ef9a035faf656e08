#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "normalshop/chart/depth_steps.h"
#include "normalshop/core/parallel.h"
#include "normalshop/core/random.h"

namespace normalshop {
namespace {

/// Triangles of a few pixels at depths that mostly agree, some of them seen from behind.
EditingChart random_chart(int width, int height) {
  EditingChart chart;
  chart.grid.pixel = 0.5F;
  chart.grid.window = {0, 0, width, height};
  chart.ids.triangle.resize(width, height);
  chart.ids.depth.resize(width, height);
  chart.base_normal.resize(width, height);
  Random random(11);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const bool seen = random.uniform() > 0.15F;
      chart.ids.triangle(x, y) =
          seen ? static_cast<std::uint32_t>(4.0F * random.uniform()) : no_triangle;
      chart.ids.depth(x, y) =
          seen ? 2.0F * random.uniform() : -std::numeric_limits<float>::infinity();
      const Vec3f n(random.uniform(-1.0F, 1.0F), random.uniform(-1.0F, 1.0F),
                    random.uniform(-0.1F, 1.0F));
      chart.base_normal(x, y) = seen ? Vec3f(n.normalized()) : Vec3f(0.0F, 0.0F, 0.0F);
    }
  }
  return chart;
}

/// The definition, pixel by pixel.
bool is_step(const EditingChart& chart, int x0, int y0, int x1, int y1) {
  if (chart.ids.triangle(x0, y0) == chart.ids.triangle(x1, y1)) return false;
  if (chart.ids.triangle(x0, y0) == no_triangle || chart.ids.triangle(x1, y1) == no_triangle) {
    return false;
  }
  const Vec3f& n0 = chart.base_normal(x0, y0);
  const Vec3f& n1 = chart.base_normal(x1, y1);
  if ((n0.z() > 0.0F) != (n1.z() > 0.0F)) return true;
  const auto rise = [&](const Vec3f& n) {
    return (y0 == y1 ? -n.x() : n.y()) / std::max(n.z(), 0.17F);
  };
  const float expected = 0.5F * (rise(n0) + rise(n1));
  const float found = (chart.ids.depth(x1, y1) - chart.ids.depth(x0, y0)) / chart.grid.pixel;
  return std::abs(found - expected) > 2.0F + std::abs(expected);
}

Image<std::uint8_t> by_definition(const EditingChart& chart) {
  const Rect all = chart.ids.triangle.rect();
  Image<std::uint8_t> steps(all.width(), all.height(), 0);
  for (int y = 0; y < all.height(); ++y) {
    for (int x = 0; x < all.width(); ++x) {
      for (const auto& [dx, dy] : {std::pair{1, 0}, {0, 1}}) {
        if (!all.contains(x + dx, y + dy) || !is_step(chart, x, y, x + dx, y + dy)) continue;
        steps(x, y) = steps(x + dx, y + dy) = 1;
      }
    }
  }
  return steps;
}

TEST(DepthSteps, are_those_of_the_definition_at_any_size) {
  for (const auto& [width, height] :
       {std::pair{1, 1}, {2, 1}, {1, 9}, {7, 5}, {15, 4}, {16, 3}, {17, 3}, {33, 2}, {131, 150}}) {
    const EditingChart chart = random_chart(width, height);
    const Image<std::uint8_t> expected = by_definition(chart);
    Image<std::uint8_t> steps;
    find_depth_steps(chart, steps);
    ASSERT_EQ(steps.rect(), expected.rect());
    EXPECT_TRUE(std::equal(steps.data(), steps.data() + steps.size(), expected.data()))
        << width << " x " << height;
  }
}

TEST(DepthSteps, do_not_depend_on_threads) {
  const EditingChart chart = random_chart(200, 300);
  Image<std::uint8_t> many;
  find_depth_steps(chart, many);
  const ThreadLimit one(1);
  Image<std::uint8_t> alone;
  find_depth_steps(chart, alone);
  EXPECT_TRUE(std::equal(many.data(), many.data() + many.size(), alone.data()));
}

}  // namespace
}  // namespace normalshop
