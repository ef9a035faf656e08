#include <cmath>
#include <numbers>
#include <vector>

#include "support/slope_fields.h"
#include <gtest/gtest.h>

#include "normalshop/core/error.h"
#include "normalshop/core/parallel.h"
#include "normalshop/core/random.h"
#include "normalshop/core/slope.h"
#include "normalshop/rgbn/selection.h"

namespace normalshop::test {
namespace {

using std::numbers::pi;

MaskImage lasso(const std::vector<Vec2f>& points, int width = 100, int height = 80) {
  MaskImage mask(width, height);
  select_polygon(points, mask, mask.rect());
  return mask;
}

TEST(SelectLabels, TakesTheChosenOnes) {
  Image<std::uint32_t> labels(5, 1);
  const std::uint32_t row[5] = {0, 1, 2, 7, 1};
  std::copy_n(row, 5, labels.data());
  MaskImage mask(5, 1, 9.0F);
  const std::vector<std::uint32_t> chosen = {7, 1};
  EXPECT_EQ(select_labels(labels, chosen, mask, {1, 0, 9, 9}), (Rect{1, 0, 5, 1}));
  const float expected[5] = {9.0F, 1.0F, 0.0F, 1.0F, 1.0F};
  for (int x = 0; x < 5; ++x) EXPECT_EQ(mask(x, 0), expected[x]);
}

/// Slopes of a hemisphere of this radius around the middle; not finite beyond it.
SlopeImage hemisphere(int size, double radius) {
  SlopeImage slopes(size, size, Vec2f::Constant(nan));
  const double middle = 0.5 * (size - 1);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const double u = x - middle;
      const double v = middle - y;
      const double square = radius * radius - u * u - v * v;
      if (square > 0.0) slopes(x, y) = Vec2d(-u, -v).cast<float>() / std::sqrt(square);
    }
  }
  return slopes;
}

TEST(SelectAlike, TakesACapOfAHemisphere) {
  const SlopeImage slopes = hemisphere(201, 95.0);
  MaskImage mask(201, 201);
  for (const float angle : {5.0F, 20.0F, 45.0F, 80.0F}) {
    const Rect rect = select_alike({slopes, {}, {}}, {100, 100}, mask, {.angle_tolerance = angle});
    const double radius = 95.0 * std::sin(static_cast<double>(angle) * pi / 180.0);
    EXPECT_NEAR(area(mask), pi * radius * radius, 0.8 * radius) << angle;
    EXPECT_EQ(rect.x1 - rect.x0, 2 * static_cast<int>(radius) + 1) << angle;
    EXPECT_EQ(rect.width(), rect.height());
  }
  select_alike({slopes, {}, {}}, {100, 100}, mask, {.angle_tolerance = 180.0F});
  EXPECT_NEAR(area(mask), pi * 95.0 * 95.0, 50.0);
}

TEST(SelectAlike, ContiguousStopsWhereColorsDiffer) {
  const SlopeImage slopes(40, 30, Vec2f::Zero());
  ColorImage color(40, 30, Vec3f::Constant(0.5F));
  for (int y = 0; y < 30; ++y) color(20, y) = Vec3f(0.5F, 0.5F, 0.8F);  // a wall
  color(5, 5) = Vec3f(0.45F, 0.5F, 0.5F);
  const RgbnView image{slopes, color, {}};
  MaskImage mask(40, 30);
  EXPECT_EQ(select_alike(image, {3, 3}, mask), (Rect{0, 0, 20, 30}));
  EXPECT_EQ(area(mask), 20.0 * 30.0);
  select_alike(image, {3, 3}, mask, {.contiguous = false});
  EXPECT_EQ(area(mask), 39.0 * 30.0);
  select_alike(image, {3, 3}, mask, {.color_tolerance = 0.04F});
  EXPECT_EQ(area(mask), 20.0 * 30.0 - 1.0);
  EXPECT_EQ(mask(5, 5), 0.0F);
  EXPECT_EQ(select_alike(image, {20, 7}, mask), (Rect{20, 0, 21, 30}));
  select_alike(image, {0, 0}, mask, {.color_tolerance = 0.3001F});
  EXPECT_EQ(area(mask), 40.0 * 30.0);
}

TEST(SelectAlike, FollowsASpiral) {
  // Corridors that turn: a flood by rows has to come back.
  constexpr int size = 33;
  SlopeImage slopes(size, size, Vec2f::Zero());
  int x = 0;
  int y = 0;
  int dx = 1;
  int dy = 0;
  int left = 0;
  MaskImage expected(size, size, 0.0F);
  for (int leg = size - 1; leg > 0; leg -= left++ % 2 == 1 ? 2 : 0) {
    for (int i = 0; i < leg; ++i) {
      expected(x, y) = 1.0F;
      x += dx;
      y += dy;
    }
    std::swap(dx, dy);
    dx = -dx;
  }
  expected(x, y) = 1.0F;
  for (int j = 0; j < size; ++j) {
    for (int i = 0; i < size; ++i) {
      if (expected(i, j) == 0.0F) slopes(i, j) = {3.0F, 0.0F};
    }
  }
  MaskImage mask(size, size);
  select_alike({slopes, {}, {}}, {0, 0}, mask);
  ASSERT_LT(area(expected), 0.7 * size * size);
  for (std::size_t i = 0; i < mask.size(); ++i) ASSERT_EQ(mask.data()[i], expected.data()[i]) << i;
}

TEST(SelectAlike, SeedsThatSelectNothing) {
  SlopeImage slopes(6, 5, Vec2f::Zero());
  slopes(1, 1).x() = nan;
  MaskImage validity(6, 5, 1.0F);
  validity(4, 4) = 0.0F;
  MaskImage mask(6, 5, 7.0F);
  const RgbnView image{slopes, {}, validity};
  for (const Vec2i& seed : {Vec2i(1, 1), Vec2i(4, 4), Vec2i(-1, 0), Vec2i(6, 2), Vec2i(0, 5)}) {
    mask.fill(7.0F);
    EXPECT_TRUE(select_alike(image, seed, mask).empty());
    EXPECT_EQ(area(mask), 0.0);
  }
  select_alike(image, {0, 0}, mask, {.angle_tolerance = 0.0F});
  EXPECT_EQ(area(mask), 28.0);
  EXPECT_THROW(select_alike(image, {0, 0}, mask, {.color_tolerance = nan}), InvalidInput);
  EXPECT_THROW(select_alike(image, {0, 0}, mask, {.angle_tolerance = 181.0F}), InvalidInput);
}

TEST(SelectPolygon, ARectangleIsExact) {
  const MaskImage mask = lasso({{9.5F, 19.5F}, {30.25F, 19.5F}, {30.25F, 40.0F}, {9.5F, 40.0F}});
  EXPECT_EQ(mask(9, 25), 0.0F);
  EXPECT_EQ(mask(10, 25), 1.0F);
  EXPECT_EQ(mask(30, 25), 0.75F);
  EXPECT_EQ(mask(20, 40), 0.5F);
  EXPECT_EQ(mask(30, 40), 0.375F);
  EXPECT_NEAR(area(mask), 20.75 * 20.5, 1e-4);
}

TEST(SelectPolygon, AreasOfTrianglesAndCircles) {
  const Vec2f a(10.3F, 5.1F);
  const Vec2f b(90.2F, 33.7F);
  const Vec2f c(33.9F, 70.4F);
  const double truth = 0.5 * std::abs(static_cast<double>((b.x() - a.x()) * (c.y() - a.y()) -
                                                          (c.x() - a.x()) * (b.y() - a.y())));
  EXPECT_NEAR(area(lasso({a, b, c})), truth, 2e-4 * truth);
  EXPECT_NEAR(area(lasso({c, b, a})), truth, 2e-4 * truth);  // either way round
  std::vector<Vec2f> circle;
  for (int i = 0; i < 500; ++i) {
    const double t = 2.0 * pi * i / 500.0;
    circle.emplace_back(static_cast<float>(50.2 + 30.0 * std::cos(t)),
                        static_cast<float>(40.7 + 30.0 * std::sin(t)));
  }
  const MaskImage mask = lasso(circle);
  EXPECT_NEAR(area(mask), pi * 900.0, 0.5);
  // Against 64 x 64 points a pixel.
  double worst = 0.0;
  for (int y = 5; y < 20; ++y) {
    for (int x = 30; x < 70; ++x) {
      int inside = 0;
      for (int i = 0; i < 64 * 64; ++i) {
        const double u = x + (i % 64 + 0.5) / 64.0 - 0.5;
        const double v = y + (i / 64 + 0.5) / 64.0 - 0.5;
        if (std::hypot(u - 50.2, v - 40.7) < 30.0) ++inside;
      }
      worst = std::max(worst, std::abs(static_cast<double>(mask(x, y)) - inside / 4096.0));
    }
  }
  EXPECT_LT(worst, 1.0 / 32.0);
}

TEST(SelectPolygon, InsideIsWhereTheWindingNumberIsNotZero) {
  // A five-pointed star in one stroke: its middle is wound twice and belongs to it.
  std::vector<Vec2f> star;
  for (int i = 0; i < 5; ++i) {
    const double t = 2.0 * pi * (2 * i) / 5.0 - 0.5 * pi;
    star.emplace_back(static_cast<float>(50.0 + 35.0 * std::cos(t)),
                      static_cast<float>(40.0 + 35.0 * std::sin(t)));
  }
  const MaskImage mask = lasso(star);
  EXPECT_EQ(mask(50, 40), 1.0F);
  const double inner = 35.0 * std::cos(2.0 * pi / 5.0) / std::cos(pi / 5.0);
  EXPECT_NEAR(area(mask), 5.0 * 35.0 * inner * std::sin(pi / 5.0), 0.5);
  // A figure of eight: both loops, one of each direction.
  const MaskImage eight = lasso({{10.0F, 10.0F}, {60.0F, 60.0F}, {60.0F, 10.0F}, {10.0F, 60.0F}});
  EXPECT_EQ(eight(14, 35), 1.0F);
  EXPECT_EQ(eight(56, 35), 1.0F);
  EXPECT_EQ(eight(35, 12), 0.0F);
  EXPECT_NEAR(area(eight), 1250.0, 2.0);
}

TEST(SelectPolygon, RegionThreadsAndBorders) {
  const std::vector<Vec2f> points = {
      {-50.0F, 11.3F}, {140.0F, -30.0F}, {80.3F, 44.4F}, {120.0F, 200.0F}, {20.0F, 30.0F}};
  const MaskImage whole = lasso(points);
  EXPECT_GT(area(whole), 500.0);
  const ThreadLimit limit(1);
  MaskImage part(100, 80, 9.0F);
  const Rect region = {17, 21, 71, 50};
  EXPECT_EQ(select_polygon(points, part, region), region);
  for (int y = 0; y < 80; ++y) {
    for (int x = 0; x < 100; ++x) {
      ASSERT_EQ(part(x, y), region.contains(x, y) ? whole(x, y) : 9.0F);
    }
  }
  EXPECT_EQ(area(lasso({})), 0.0);
  EXPECT_EQ(area(lasso({{3.0F, 3.0F}, {50.0F, 60.0F}})), 0.0);
  EXPECT_EQ(area(lasso({{-1e30F, -1e30F}, {1e30F, -1e30F}, {1e30F, 1e30F}, {-1e30F, 1e30F}})),
            8000.0);
  EXPECT_THROW(lasso({{0.0F, 0.0F}, {nan, 5.0F}, {5.0F, 0.0F}}), InvalidInput);
}

}  // namespace
}  // namespace normalshop::test
