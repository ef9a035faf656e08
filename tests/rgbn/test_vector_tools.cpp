#include <cmath>
#include <functional>
#include <limits>

#include "support/slope_fields.h"
#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "normalshop/core/error.h"
#include "normalshop/core/parallel.h"
#include "normalshop/core/random.h"
#include "normalshop/core/slope.h"
#include "normalshop/rgbn/vector_tools.h"

namespace normalshop::test {
namespace {

SlopeImage uniform_slopes(int width, int height, std::uint64_t seed = 1) {
  SlopeImage image(width, height);
  Random random(seed);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      image(x, y) = {random.uniform(-2.0F, 2.0F), random.uniform(-2.0F, 2.0F)};
    }
  }
  return image;
}

Vec2f painted(const Vec3f& normal, const Vec3f& direction, float strength) {
  SlopeImage image(1, 1, slope_from_normal(normal));
  paint_direction(image, {}, image, image.rect(), direction, strength);
  return image(0, 0);
}

Vec2f rotated(const Vec3f& normal, const Vec3f& axis, float angle) {
  SlopeImage image(1, 1, slope_from_normal(normal));
  rotate_normals(image, {}, image, image.rect(), axis, angle);
  return image(0, 0);
}

TEST(DirectionFromAngles, Axes) {
  EXPECT_LT((direction_from_angles(77.0F, 0.0F) - Vec3f(0, 0, 1)).norm(), 1e-6F);
  EXPECT_LT((direction_from_angles(0.0F, 90.0F) - Vec3f(1, 0, 0)).norm(), 1e-6F);
  EXPECT_LT((direction_from_angles(90.0F, 90.0F) - Vec3f(0, 1, 0)).norm(), 1e-6F);
}

TEST(PaintDirection, GoesItsPartOfTheGreatArc) {
  const Vec3f to = direction_from_angles(40.0F, 65.0F);
  const SlopeImage image = uniform_slopes(40, 30);
  for (const float strength : {0.25F, 0.5F, 0.9F, 1.0F}) {
    SlopeImage out(40, 30);
    paint_direction(image, {}, out, image.rect(), to, strength);
    for (std::size_t i = 0; i < image.size(); ++i) {
      const Vec3f from = normal_from_slope(image.data()[i]);
      const Vec3f n = normal_from_slope(out.data()[i]);
      const double whole = angle_degrees(from, to);
      EXPECT_NEAR(angle_degrees(from, n), static_cast<double>(strength) * whole, 2e-4);
      EXPECT_NEAR(angle_degrees(n, to), (1.0 - static_cast<double>(strength)) * whole, 2e-4);
    }
  }
}

TEST(PaintDirection, StopsAtTheHorizonOnItsArc) {
  const double horizon = std::asin(static_cast<double>(min_cosine)) * 180.0 / 3.14159265358979;
  // From 30 degrees on the right over the top to below the horizon on the left.
  const Vec2f slope =
      painted(direction_from_angles(0.0F, 30.0F), direction_from_angles(180.0F, 120.0F), 1.0F);
  const Vec3f n = normal_from_slope(slope);
  EXPECT_NEAR(angle_degrees(n, {-1, 0, 0}), horizon, 1e-3);
  EXPECT_NEAR(n.y(), 0.0F, 1e-6F);
  // Half of that way is above it.
  const Vec3f half = normal_from_slope(
      painted(direction_from_angles(0.0F, 30.0F), direction_from_angles(180.0F, 120.0F), 0.5F));
  EXPECT_NEAR(angle_degrees(half, direction_from_angles(180.0F, 45.0F)), 0.0, 1e-3);
  // A slanted arc stops on the arc, not below the direction's azimuth.
  const Vec3f from = direction_from_angles(20.0F, 50.0F);
  const Vec3f to = direction_from_angles(110.0F, 130.0F);
  const Vec3f stopped = normal_from_slope(painted(from, to, 1.0F));
  EXPECT_NEAR(stopped.z(), min_cosine, 1e-5F);
  EXPECT_NEAR(from.cross(to).normalized().dot(stopped), 0.0F, 1e-5F);
  EXPECT_LT(angle_degrees(stopped, to), angle_degrees(from, to));
}

TEST(PaintDirection, DirectionsThatChangeNothing) {
  const Vec3f n = direction_from_angles(33.0F, 21.0F);
  EXPECT_EQ(painted(n, -normal_from_slope(slope_from_normal(n)), 0.0F), slope_from_normal(n));
  EXPECT_LT((painted(n, n, 1.0F) - slope_from_normal(n)).norm(), 1e-6F);
  EXPECT_EQ(painted({0, 0, 1}, {0, 0, -1}, 1.0F), Vec2f(0.0F, 0.0F));
}

TEST(RotateNormals, TurnsAboutTheViewingDirection) {
  const SlopeImage image = uniform_slopes(30, 20);
  SlopeImage out(30, 20);
  rotate_normals(image, {}, out, image.rect(), {0, 0, 2}, 90.0F);
  for (std::size_t i = 0; i < image.size(); ++i) {
    const Vec2f s = image.data()[i];
    EXPECT_LT((out.data()[i] - Vec2f(-s.y(), s.x())).norm(), 1e-5F);
  }
}

TEST(RotateNormals, TurnsAboutAnAxisInThePicture) {
  const Vec3f y_axis(0, 1, 0);
  EXPECT_NEAR(rotated({0, 0, 1}, y_axis, 30.0F).x(), -std::tan(30.0 * 3.14159265 / 180.0), 1e-5);
  EXPECT_NEAR(rotated({0, 0, 1}, y_axis, -30.0F).x(), std::tan(30.0 * 3.14159265 / 180.0), 1e-5);
  const SlopeImage image = uniform_slopes(30, 20);
  SlopeImage out(30, 20);
  const Vec3f axis = direction_from_angles(70.0F, 35.0F);
  rotate_normals(image, {}, out, image.rect(), axis, 12.0F);
  int above = 0;
  for (std::size_t i = 0; i < image.size(); ++i) {
    const Vec3f a = normal_from_slope(image.data()[i]);
    const Vec3f b = normal_from_slope(out.data()[i]);
    if (b.z() < 2.0F * min_cosine) continue;
    ++above;
    EXPECT_NEAR(a.dot(axis), b.dot(axis), 2e-6F);
    const Vec3f u = a - a.dot(axis) * axis;
    const Vec3f v = b - b.dot(axis) * axis;
    if (u.norm() > 0.05F) {
      EXPECT_NEAR(angle_degrees(u, v), 12.0, 2e-3);
    }
  }
  EXPECT_GT(above, 500);
}

TEST(RotateNormals, StopsAtTheHorizon) {
  for (const float angle : {95.0F, 135.0F, 180.0F}) {
    const Vec3f n = normal_from_slope(rotated({0, 0, 1}, {0, 1, 0}, angle));
    EXPECT_NEAR(n.z(), min_cosine, 1e-5F);
    EXPECT_GT(n.x(), 0.99F);
    const Vec3f m = normal_from_slope(rotated({0, 0, 1}, {0, 1, 0}, -angle));
    EXPECT_LT(m.x(), -0.99F);
  }
  // Steeper than the horizon already: it doesn't get steeper, and can come back.
  const Vec2f steep(-80.0F, 0.0F);
  SlopeImage image(1, 1, steep);
  rotate_normals(image, {}, image, image.rect(), {0, 1, 0}, 40.0F);
  EXPECT_NEAR(image(0, 0).x(), -80.0F, 1e-2F);
  rotate_normals(image, {}, image, image.rect(), {0, 1, 0}, -45.0F);
  const double expected = 90.0 - std::atan(1.0 / 80.0) * 180.0 / 3.14159265358979 - 45.0;
  EXPECT_NEAR(angle_degrees(normal_from_slope(image(0, 0)), {0, 0, 1}), expected, 1e-3);
}

TEST(Flatten, GivesThePlaneAndKeepsTheRest) {
  const SlopeImage image = uniform_slopes(20, 10);
  MaskImage mask(20, 10, 0.0F);
  mask(3, 3) = 1.0F;
  mask(4, 3) = 0.5F;
  SlopeImage out(20, 10);
  const FlattenOptions options{.slope = {0.25F, -0.5F}};
  flatten(image, mask, out, image.rect(), options);
  EXPECT_EQ(out(3, 3), options.slope);
  EXPECT_LT((out(4, 3) - 0.5F * (image(4, 3) + options.slope)).norm(), 1e-6F);
  out(3, 3) = image(3, 3);
  out(4, 3) = image(4, 3);
  EXPECT_TRUE(same_bits(image, out));
  const SlopeImage base = uniform_slopes(20, 10, 2);
  flatten_to(base, image, {}, out, image.rect());
  EXPECT_TRUE(same_bits(base, out));
  flatten(image, {}, out, image.rect());
  EXPECT_EQ(out(7, 7), Vec2f(0.0F, 0.0F));
}

TEST(BalanceMean, MakesTheMeanZero) {
  SlopeImage image = uniform_slopes(211, 97);
  for (std::size_t i = 0; i < image.size(); ++i) image.data()[i] += Vec2f(0.7F, -0.3F);
  image(5, 5) = {nan, 0.0F};
  MaskImage binary(211, 97, 0.0F);
  MaskImage soft(211, 97);
  for (int y = 0; y < 97; ++y) {
    for (int x = 0; x < 211; ++x) {
      if (x < 100) binary(x, y) = 1.0F;
      soft(x, y) = static_cast<float>(x) / 210.0F;
    }
  }
  for (const MaskView mask : {MaskView(), binary.view(), soft.view()}) {
    SlopeImage out(211, 97);
    balance_mean(image, mask, out, image.rect());
    EXPECT_LT(mean_slope(out, mask).norm(), 1e-6);
    EXPECT_TRUE(std::isnan(out(5, 5).x()));
  }
  SlopeImage out(211, 97);
  balance_mean(image, binary, out, image.rect());
  EXPECT_EQ(out(150, 40), image(150, 40));
  const Vec2d mean = mean_slope(image, binary);
  EXPECT_NEAR(mean.x(), 0.7, 0.05);
  EXPECT_LT((out(50, 40) - (image(50, 40) - mean.cast<float>())).norm(), 1e-6F);
  EXPECT_EQ(mean_slope(image, MaskImage(211, 97, 0.0F)), Vec2d(0.0, 0.0));
}

TEST(NormalizeVectors, ReportsWhatItMends) {
  Image<Vec3f> image(4, 2, Vec3f(0.0F, 0.6F, 0.8F));
  const Vec3f kept = Vec3f(0.3F, -0.2F, 0.9F).normalized();
  image(0, 0) = kept;
  image(1, 0) = {0.0F, 0.0F, 3.0F};
  image(2, 0) = Vec3f::Zero();
  image(3, 0) = {nan, 0.0F, 1.0F};
  image(0, 1) = {0.0F, std::numeric_limits<float>::infinity(), 1.0F};
  image(1, 1) = {1e-30F, 0.0F, 0.0F};
  image(2, 1) = {0.0F, -3e38F, 3e38F};
  const NormalizeReport report = normalize_vectors(image, image, image.rect());
  EXPECT_EQ(report.written, image.rect());
  EXPECT_EQ(report.not_unit, 3U);
  EXPECT_EQ(report.zero, 1U);
  EXPECT_EQ(report.not_finite, 2U);
  EXPECT_EQ(image(0, 0), kept);
  EXPECT_EQ(image(1, 0), Vec3f(0, 0, 1));
  EXPECT_EQ(image(2, 0), Vec3f(0, 0, 0));
  EXPECT_EQ(image(3, 0), Vec3f(0, 0, 0));
  EXPECT_EQ(image(1, 1), Vec3f(1, 0, 0));
  EXPECT_NEAR(image(2, 1).z(), std::sqrt(0.5F), 1e-6F);
  EXPECT_EQ(normalize_vectors(image, image, {9, 9, 12, 12}).not_unit, 0U);
}

TEST(FlipAndSwap, ActOnSlopesAsOnNormals) {
  const SlopeImage image = uniform_slopes(9, 7);
  Image<Vec3f> normals(9, 7);
  for (std::size_t i = 0; i < image.size(); ++i) {
    normals.data()[i] = normal_from_slope(image.data()[i]);
  }
  SlopeImage slopes(9, 7);
  flip_green(image, slopes, image.rect());
  flip_green(normals, normals, image.rect());
  for (std::size_t i = 0; i < image.size(); ++i) {
    EXPECT_EQ(slopes.data()[i], Vec2f(image.data()[i].x(), -image.data()[i].y()));
    EXPECT_EQ(normal_from_slope(slopes.data()[i]), normals.data()[i]);
  }
  swap_red_green(slopes, slopes, image.rect());
  swap_red_green(normals, normals, image.rect());
  for (std::size_t i = 0; i < image.size(); ++i) {
    EXPECT_EQ(slopes.data()[i], Vec2f(-image.data()[i].y(), image.data()[i].x()));
    EXPECT_LT((normal_from_slope(slopes.data()[i]) - normals.data()[i]).norm(), 1e-6F);
  }
}

/// Every slope tool on one image.
template <class Use>
void with_each_tool(const SlopeImage& image, const MaskImage& mask, float strength,
                    const Use& use) {
  using Tool = std::function<Rect(SlopeSpan, Rect)>;
  const Vec3f to = direction_from_angles(10.0F, 50.0F);
  use(Tool(
      [&](SlopeSpan out, Rect r) { return paint_direction(image, mask, out, r, to, strength); }));
  use(Tool([&](SlopeSpan out, Rect r) {
    return rotate_normals(image, mask, out, r, to, 100.0F * strength);
  }));
  use(Tool([&](SlopeSpan out, Rect r) {
    return flatten(image, mask, out, r, {.slope = {0.1F, 0.2F}, .strength = strength});
  }));
  use(Tool([&](SlopeSpan out, Rect r) {
    return flatten_to(image, image, mask, out, r, 0.0F * strength);
  }));
}

TEST(VectorTools, NeutralValuesRegionsAndThreads) {
  SlopeImage image = uniform_slopes(70, 90);
  image(33, 44) = {nan, 1.0F};
  image(2, 2) = {-0.0F, 0.0F};
  MaskImage mask(70, 90);
  Random random(3);
  for (std::size_t i = 0; i < mask.size(); ++i) mask.data()[i] = random.uniform();
  with_each_tool(image, mask, 0.0F, [&](const auto& tool) {
    SlopeImage out(70, 90);
    EXPECT_EQ(tool(out, {-1, -1, 100, 100}), image.rect());
    EXPECT_TRUE(same_bits(image, out));
  });
  const MaskImage nothing(70, 90, 0.0F);
  with_each_tool(image, nothing, 1.0F, [&](const auto& tool) {
    SlopeImage out(70, 90);
    tool(out, image.rect());
    EXPECT_TRUE(same_bits(image, out));
  });
  const Rect region = {11, 13, 50, 77};
  with_each_tool(image, mask, 0.8F, [&](const auto& tool) {
    SlopeImage whole(70, 90);
    tool(whole, image.rect());
    const ThreadLimit limit(1);
    SlopeImage part(70, 90, Vec2f(9.0F, 9.0F));
    EXPECT_EQ(tool(part, region), region);
    for (int y = 0; y < 90; ++y) {
      for (int x = 0; x < 70; ++x) {
        const Vec2f expected = region.contains(x, y) ? whole(x, y) : Vec2f(9.0F, 9.0F);
        ASSERT_EQ(std::memcmp(&part(x, y), &expected, sizeof expected), 0) << x << " " << y;
      }
    }
    EXPECT_TRUE(tool(part, {}).empty());
  });
  SlopeImage many(70, 90);
  balance_mean(image, mask, many, image.rect());
  const ThreadLimit limit(1);
  SlopeImage one(70, 90);
  balance_mean(image, mask, one, image.rect());
  EXPECT_TRUE(same_bits(many, one));
}

TEST(VectorTools, RejectWhatIsNoNumber) {
  SlopeImage image(2, 2, Vec2f::Zero());
  const Rect all = image.rect();
  EXPECT_THROW(paint_direction(image, {}, image, all, Vec3f(0, 0, 0)), InvalidInput);
  EXPECT_THROW(paint_direction(image, {}, image, all, Vec3f(nan, 0, 1)), InvalidInput);
  EXPECT_THROW(paint_direction(image, {}, image, all, Vec3f(0, 0, 1), nan), InvalidInput);
  EXPECT_THROW(paint_direction(image, {}, image, all, {.azimuth = nan}), InvalidInput);
  EXPECT_THROW(rotate_normals(image, {}, image, all, {.tilt = nan}), InvalidInput);
  EXPECT_THROW(rotate_normals(image, {}, image, all, {.angle = 181.0F}), InvalidInput);
  EXPECT_THROW(flatten(image, {}, image, all, {.slope = {nan, 0.0F}}), InvalidInput);
  EXPECT_THROW(flatten(image, {}, image, all, {.strength = 1.5F}), InvalidInput);
  EXPECT_THROW(flatten_to(image, image, {}, image, all, nan), InvalidInput);
}

}  // namespace
}  // namespace normalshop::test
