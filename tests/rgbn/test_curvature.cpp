#include <cmath>
#include <limits>

#include "style_checks.h"
#include "style_fixtures.h"
#include "support/nan.h"
#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "normalshop/core/error.h"
#include "normalshop/core/parallel.h"
#include "normalshop/rgbn/curvature.h"
#include "normalshop/rgbn/rgbn_normals.h"

namespace normalshop::test {
namespace {

Image<Curvature> curvature_of(const Image<Vec3f>& normals, const CurvatureOptions& options = {}) {
  Image<Curvature> out(normals.width(), normals.height());
  curvature(normals, out, normals.rect(), options);
  return out;
}

/// Curvature of the height z(x, y) with these derivatives, by the textbook's fundamental forms;
/// positive where convex towards the viewer.
struct Truth {
  double mean, gaussian;
  Truth(double p, double q, double r, double s, double t) {
    const double w2 = 1.0 + p * p + q * q;
    mean = -((1.0 + q * q) * r - 2.0 * p * q * s + (1.0 + p * p) * t) / (2.0 * w2 * std::sqrt(w2));
    gaussian = (r * t - s * s) / (w2 * w2);
  }
};

TEST(Curvature, OfASphere) {
  for (const float sigma : {0.0F, 1.0F, 3.0F}) {
    const auto k = curvature_of(ball(241, 100.0), {.sigma = sigma});
    for (int y = 0; y < 241; y += 3) {
      for (int x = 0; x < 241; x += 3) {
        if (std::hypot(x - 120, y - 120) > 80.0) continue;
        EXPECT_NEAR(k(x, y).mean(), 0.01F, 1e-4F) << x << " " << y << " sigma " << sigma;
        EXPECT_NEAR(k(x, y).gaussian(), 1e-4F, 2e-6F);
      }
    }
  }
}

TEST(Curvature, OfACylinderWithItsDirections) {
  // The axis runs up and to the right by 30 degrees and leans 20 degrees towards the viewer.
  const double turn = 30.0 * 3.14159265358979 / 180.0;
  const double lean = 20.0 * 3.14159265358979 / 180.0;
  const Vec3d axis(std::cos(turn) * std::cos(lean), std::sin(turn) * std::cos(lean),
                   std::sin(lean));
  const Vec3d side = Vec3d(-std::sin(turn), std::cos(turn), 0.0);
  const Vec3d front = axis.cross(side);
  const double radius = 70.0;
  const auto normals = picture_of(161, 161, [&](double x, double y) {
    const double across = Vec3d(x, y, 0.0).dot(side) / radius;
    if (std::abs(across) >= 1.0) return Vec3f(Vec3f::Zero());
    return Vec3f((across * side + std::sqrt(1.0 - across * across) * front).cast<float>());
  });
  const auto k = curvature_of(normals);
  for (int y = 6; y < 155; y += 4) {
    for (int x = 6; x < 155; x += 4) {
      const double across = Vec3d(x - 80.0, 80.0 - y, 0.0).dot(side) / radius;
      if (std::abs(across) > 0.75) continue;
      const Curvature& c = k(x, y);
      EXPECT_NEAR(c.mean(), 1.0 / (2.0 * radius), 0.01 / (2.0 * radius));
      EXPECT_NEAR(c.k1, 1.0 / radius, 0.01 / radius);
      EXPECT_NEAR(c.k2, 0.0, 0.01 / radius);
      // The straight direction is the axis, the bent one perpendicular to it on the surface.
      const Vec2f straight = axis.head<2>().normalized().cast<float>();
      EXPECT_GT(std::abs(c.e2.dot(straight)), 0.9998F);
      const Vec3d n = across * side + std::sqrt(1.0 - across * across) * front;
      const Vec2f bent = axis.cross(n).head<2>().normalized().cast<float>();
      EXPECT_GT(std::abs(c.e1.dot(bent)), 0.9998F);
    }
  }
}

TEST(Curvature, OfATiltedSaddle) {
  // z = x^2 / 300 - y^2 / 400 + x y / 500 + x / 2
  const auto truth = [](double x, double y) {
    return Truth(x / 150.0 + y / 500.0 + 0.5, -y / 200.0 + x / 500.0, 1.0 / 150.0, 1.0 / 500.0,
                 -1.0 / 200.0);
  };
  const auto normals = picture_of(121, 121, [&](double x, double y) {
    return tilted(x / 150.0 + y / 500.0 + 0.5, -y / 200.0 + x / 500.0);
  });
  MaskImage mean(121, 121);
  MaskImage gaussian(121, 121);
  mean_curvature(normals, mean, mean.rect());
  gaussian_curvature(normals, gaussian, mean.rect());
  const auto k = curvature_of(normals);
  for (int y = 8; y < 113; y += 3) {
    for (int x = 8; x < 113; x += 3) {
      const Truth t = truth(x - 60, 60 - y);
      const double scale = std::sqrt(t.mean * t.mean - t.gaussian);  // of the curvatures
      EXPECT_NEAR(mean(x, y), t.mean, 0.01 * scale);
      EXPECT_NEAR(gaussian(x, y), t.gaussian, 0.01 * std::abs(t.gaussian));
      EXPECT_NEAR(k(x, y).k1, t.mean + scale, 0.01 * scale);
      EXPECT_NEAR(k(x, y).k2, t.mean - scale, 0.01 * scale);
      EXPECT_GT(k(x, y).k1, 0.0F);  // convex one way
      EXPECT_LT(k(x, y).k2, 0.0F);  // concave the other
    }
  }
}

TEST(Curvature, OfABowlIsNegativeAndOfAPlaneZero) {
  const auto bowl = picture_of(41, 41, [](double x, double y) { return tilted(x / 50, y / 50); });
  EXPECT_NEAR(curvature_of(bowl)(20, 20).mean(), -0.02F, 2e-4F);
  const auto plane = picture_of(41, 41, [](double, double) { return tilted(0.7, -0.4); });
  const auto flat = curvature_of(plane);
  for (int y = 0; y < 41; ++y) {
    for (int x = 0; x < 41; ++x) {
      EXPECT_EQ(flat(x, y).k1, 0.0F);
      EXPECT_EQ(flat(x, y).k2, 0.0F);
    }
  }
}

TEST(Curvature, DoesNotSeeAcrossTheGuard) {
  // Two bowed halves that meet in a crease of more than 60 degrees.
  const auto normals = picture_of(80, 20, [](double x, double) {
    return x < 0.0 ? tilted(0.8 + x / 200.0, 0.0) : tilted(-0.8 + x / 200.0, 0.0);
  });
  const auto guarded = curvature_of(normals, {.sigma = 0.0F, .guard = 60.0F});
  const auto joined = curvature_of(normals, {.sigma = 0.0F, .guard = 180.0F});
  const Truth beside(0.8, 0.0, 1.0 / 200.0, 0.0, 0.0);
  for (const int x : {38, 39, 40, 41}) {
    EXPECT_NEAR(guarded(x, 10).mean(), beside.mean, 0.03 * std::abs(beside.mean));
  }
  EXPECT_GT(joined(39, 10).mean(), 0.2F);
  EXPECT_GT(joined(40, 10).mean(), 0.2F);
}

TEST(Curvature, StaysRightBesideGaps) {
  Image<Vec3f> normals = ball(241, 100.0);
  for (int y = 0; y < 241; ++y) {
    for (int x = 130; x < 241; ++x) normals(x, y) = Vec3f::Zero();
  }
  const auto k = curvature_of(normals, {.sigma = 0.0F});
  EXPECT_NEAR(k(129, 120).mean(), 0.01F, 1e-4F);
  EXPECT_EQ(k(131, 120).mean(), 0.0F);
}

TEST(Curvature, RegionsThreadsEdgesAndGaps) {
  const auto draw = [](ImageView<Vec3f> normals, MaskSpan target, Rect region) {
    return mean_curvature(normals, target, region, {.sigma = 1.5F});
  };
  expect_a_style(9.0F, std::optional(0.0F), draw);
}

TEST(Curvature, HasUnitDirectionsWhateverTheNormals) {
  const auto k = curvature_of(damaged(120, 90));
  for (int y = 0; y < 90; ++y) {
    for (int x = 0; x < 120; ++x) {
      ASSERT_TRUE(std::isfinite(k(x, y).k1) && std::isfinite(k(x, y).k2));
      ASSERT_GE(k(x, y).k1, k(x, y).k2);
      ASSERT_NEAR(k(x, y).e1.norm(), 1.0F, 1e-5F);
      ASSERT_NEAR(k(x, y).e2.norm(), 1.0F, 1e-5F);
    }
  }
}

TEST(Curvature, RejectsOptionsOutOfRange) {
  const Image<Vec3f> normals(4, 4, Vec3f(0.0F, 0.0F, 1.0F));
  MaskImage out(4, 4);
  EXPECT_THROW(mean_curvature(normals, out, out.rect(), {.sigma = nan}), InvalidInput);
  EXPECT_THROW(mean_curvature(normals, out, out.rect(), {.sigma = -1.0F}), InvalidInput);
  try {
    mean_curvature(normals, out, out.rect(), {.guard = nan});
    FAIL();
  } catch (const InvalidInput& e) {
    EXPECT_STREQ(e.what(), "curvature: guard must be a number from 0 to 180");
  }
}

TEST(RgbnNormals, AreZeroWhereNothingIsValid) {
  SlopeImage slopes(3, 1, Vec2f(1.0F, -2.0F));
  slopes(1, 0).x() = std::numeric_limits<float>::quiet_NaN();
  MaskImage validity(3, 1, 1.0F);
  validity(2, 0) = 0.0F;
  Image<Vec3f> out(3, 1, Vec3f::Ones());
  EXPECT_EQ(normals_of({slopes, {}, validity}, out, {0, 0, 9, 9}), out.rect());
  EXPECT_LT((out(0, 0) - Vec3f(-1.0F, 2.0F, 1.0F).normalized()).norm(), 1e-6F);
  EXPECT_EQ(out(1, 0), Vec3f(Vec3f::Zero()));
  EXPECT_EQ(out(2, 0), Vec3f(Vec3f::Zero()));
}

}  // namespace
}  // namespace normalshop::test
