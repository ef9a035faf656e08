#include <cmath>
#include <vector>

#include "support/sanitized.h"
#include "support/slope_fields.h"
#include <Eigen/QR>
#include <gtest/gtest.h>

#include "normalshop/core/error.h"
#include "normalshop/core/parallel.h"
#include "normalshop/rgbn/curl.h"
#include "normalshop/rgbn/project.h"

namespace normalshop::test {
namespace {

/// MATLAB's peaks with its slopes, x and y from -3 to 3; y up.
struct Peaks {
  static constexpr int size = 256;
  static constexpr double unit = 6.0 / (size - 1);
  static constexpr double scale = 3.3;

  static double height(double x, double y) {
    return scale * (3.0 * (1 - x) * (1 - x) * std::exp(-x * x - (y + 1) * (y + 1)) -
                    10.0 * (x / 5 - x * x * x - std::pow(y, 5)) * std::exp(-x * x - y * y) -
                    std::exp(-(x + 1) * (x + 1) - y * y) / 3.0);
  }
  static Vec2d slope(double x, double y) {
    const double a = std::exp(-x * x - (y + 1) * (y + 1));
    const double b = std::exp(-x * x - y * y);
    const double c = std::exp(-(x + 1) * (x + 1) - y * y);
    const double polynomial = x / 5 - x * x * x - std::pow(y, 5);
    const double dx = -6.0 * (1 - x) * a - 6.0 * (1 - x) * (1 - x) * x * a -
                      10.0 * (0.2 - 3 * x * x) * b + 20.0 * x * polynomial * b +
                      2.0 * (x + 1) * c / 3.0;
    const double dy = -6.0 * (1 - x) * (1 - x) * (y + 1) * a + 50.0 * std::pow(y, 4) * b +
                      20.0 * y * polynomial * b + 2.0 * y * c / 3.0;
    return scale * unit * Vec2d(dx, dy);
  }
  static Vec2d at(int x, int y) { return {-3.0 + unit * x, 3.0 - unit * y}; }
  static SlopeImage slopes() {
    SlopeImage image(size, size);
    for (int y = 0; y < size; ++y) {
      for (int x = 0; x < size; ++x) {
        image(x, y) = slope(at(x, y).x(), at(x, y).y()).cast<float>();
      }
    }
    return image;
  }
  /// Mean absolute error of a height, its mean set right.
  static double error(const MaskImage& height) {
    double offset = 0.0;
    double sum = 0.0;
    const auto difference = [&](int x, int y) {
      const Vec2d p = at(x, y);
      return static_cast<double>(height(x, y)) - Peaks::height(p.x(), p.y());
    };
    for (int y = 0; y < size; ++y) {
      for (int x = 0; x < size; ++x) offset += difference(x, y) / (size * size);
    }
    for (int y = 0; y < size; ++y) {
      for (int x = 0; x < size; ++x) sum += std::abs(difference(x, y) - offset);
    }
    return sum / (size * size);
  }
};

TEST(Project, IntegratesPeaksToTheirHeight) {
  const SlopeImage image = Peaks::slopes();
  MaskImage height(Peaks::size, Peaks::size);
  const Projection done = integrate_height(image, {}, height, height.rect());
  EXPECT_EQ(done.written, image.rect());
  EXPECT_LT(Peaks::error(height), 1e-3);
  EXPECT_LT(done.removed_share, 1e-5);
  // As if it repeated it comes out worse: its borders do not fit.
  integrate_height(image, {}, height, height.rect(), {.border = Border::Wrap});
  EXPECT_GT(Peaks::error(height), 0.05);
}

TEST(Project, LeavesSlopesOfAHeightAsTheyAre) {
  const SlopeImage image = slopes_of(200, 200, hills);
  for (const MaskImage& mask : {MaskImage(), disc(200), snakes(200)}) {
    MaskImage height(200, 200);
    SlopeImage out(200, 200);
    const Projection done =
        project_to_integrable(image, mask, {.slopes = out, .height = height}, out.rect());
    EXPECT_LT(largest_difference(image, out, mask), 2e-6);
    EXPECT_LT(done.removed_share, 1e-12);
  }
}

TEST(Project, WhatItReturnsHasNoCurlAndStays) {
  const SlopeImage image = noise_image(150, 131);
  for (const bool holes : {false, true}) {
    MaskImage mask(150, 131, 1.0F);
    for (int y = 0; holes && y < 131; ++y) {
      for (int x = 0; x < 150; ++x) mask(x, y) = noise(x / 3, y / 3, 5) < 0.5F ? 1.0F : 0.0F;
    }
    const SlopeImage once = projected(image, mask);
    SlopeImage twice(150, 131);
    const Projection again = project_to_integrable(once, mask, {.slopes = twice}, twice.rect());
    EXPECT_LT(again.removed_share, 1e-12);
    EXPECT_LT(largest_difference(once, twice, mask), 2e-6);
    MaskImage curls(150, 131);
    curl(once, mask, curls, curls.rect());
    for (int y = 0; y < 131; ++y) {
      for (int x = 0; x < 150; ++x) {
        if (!std::isnan(curls(x, y))) {
          EXPECT_NEAR(curls(x, y), 0.0F, 1e-6F);
        }
      }
    }
  }
}

// A rotating part made of one vortex on each square of four pixels has no height in it at all.
TEST(Project, RemovesExactlyTheRotatingPart) {
  constexpr int width = 120;
  constexpr int height = 90;
  const SlopeImage surface = slopes_of(width, height, hills);
  SlopeImage both = surface;
  for (int y = 0; y + 1 < height; ++y) {
    for (int x = 0; x + 1 < width; ++x) {
      const float spin = noise(x, y, 8);
      both(x, y) += Vec2f(-spin, -spin);
      both(x + 1, y) += Vec2f(-spin, spin);
      both(x, y + 1) += Vec2f(spin, -spin);
      both(x + 1, y + 1) += Vec2f(spin, spin);
    }
  }
  EXPECT_GT(curl_share(both, {}), 0.5);
  EXPECT_LT(largest_difference(surface, projected(both, {})), 5e-6);
}

TEST(Project, WhatItRemovesIsOrthogonalToSlopesOfHeights) {
  const SlopeImage image = noise_image(200, 200);
  const MaskImage mask = snakes(200);
  const SlopeImage out = projected(image, mask);
  for (std::uint32_t seed = 20; seed < 24; ++seed) {
    const SlopeImage other = slopes_of(200, 200, [&](int x, int y) {
      return static_cast<double>(noise(x, y, seed)) + 0.3 * std::sin(0.02 * x * (seed - 19U));
    });
    double product = 0.0;
    double sizes = 0.0;
    for (int y = 0; y < 200; ++y) {
      for (int x = 0; x < 200; ++x) {
        if (mask(x, y) == 0.0F) continue;
        const Vec2d removed = (image(x, y) - out(x, y)).cast<double>();
        product += removed.dot(other(x, y).cast<double>());
        sizes += removed.norm() * static_cast<double>(other(x, y).norm());
      }
    }
    EXPECT_LT(std::abs(product), 1e-7 * sizes);
  }
}

/// The least squares written down as one dense matrix: unknown heights of corners, two rows a
/// pixel.
SlopeImage dense_projection(const SlopeImage& image, const MaskImage& weights, bool wraps,
                            bool zero) {
  const int w = image.width();
  const int h = image.height();
  const int across = wraps ? w : w + 1;
  const int down = wraps ? h : h + 1;
  const auto weight = [&](int x, int y) {
    if (wraps) return weights((x + w) % w, (y + h) % h);
    return x >= 0 && y >= 0 && x < w && y < h ? weights(x, y) : 0.0F;
  };
  const bool tilts = wraps && !zero;
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(2 * w * h, across * down + 2);
  Eigen::VectorXd b = Eigen::VectorXd::Zero(2 * w * h);
  for (int y = 0; y < h; ++y) {
    for (int x = 0; x < w; ++x) {
      const int row = 2 * (y * w + x);
      const auto corner = [&](int dx, int dy, double along_x, double along_y) {
        const int cx = (x + dx) % across;
        const int cy = (y + dy) % down;
        const bool end = weight(cx - 1, cy - 1) == 0.0F || weight(cx, cy - 1) == 0.0F ||
                         weight(cx - 1, cy) == 0.0F || weight(cx, cy) == 0.0F;
        if (zero && end) return;
        a(row, cy * across + cx) += along_x;
        a(row + 1, cy * across + cx) += along_y;
      };
      corner(0, 0, -0.5, 0.5);
      corner(1, 0, 0.5, 0.5);
      corner(0, 1, -0.5, -0.5);
      corner(1, 1, 0.5, -0.5);
      if (tilts) a(row, across * down) = a(row + 1, across * down + 1) = 1.0;
      b[row] = static_cast<double>(image(x, y).x());
      b[row + 1] = static_cast<double>(image(x, y).y());
    }
  }
  Eigen::VectorXd scale(2 * w * h);
  for (int i = 0; i < 2 * w * h; ++i) {
    scale[i] = std::sqrt(static_cast<double>(weights(i / 2 % w, i / 2 / w)));
  }
  const Eigen::MatrixXd scaled = scale.asDiagonal() * a;
  const Eigen::VectorXd right = scale.asDiagonal() * b;
  const Eigen::VectorXd slopes =
      a * Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd>(scaled).solve(right);
  SlopeImage out(w, h);
  for (int y = 0; y < h; ++y) {
    for (int x = 0; x < w; ++x) {
      const int row = 2 * (y * w + x);
      out(x, y) = Vec2d(slopes[row], slopes[row + 1]).cast<float>();
    }
  }
  return out;
}

struct DenseCase {
  int width;
  int height;
  float holes;  ///< share of pixels
  bool weighted;
};

class AgainstDense : public testing::TestWithParam<DenseCase> {};

TEST_P(AgainstDense, IsTheLeastSquaresSolution) {
  const DenseCase& c = GetParam();
  const SlopeImage image = noise_image(c.width, c.height, 31);
  MaskImage weights(c.width, c.height);
  for (int y = 0; y < c.height; ++y) {
    for (int x = 0; x < c.width; ++x) {
      const bool hole = noise(x, y, 4) < 2.0F * c.holes - 1.0F;
      weights(x, y) = hole ? 0.0F : (c.weighted ? 0.55F + 0.45F * noise(x, y, 6) : 1.0F);
    }
  }
  for (const Border border : {Border::Clamp, Border::Wrap}) {
    for (const HeightEnds ends : {HeightEnds::Free, HeightEnds::Zero}) {
      if (ends == HeightEnds::Zero && border == Border::Wrap && c.holes == 0.0F) continue;
      const SlopeImage out = projected(image, weights, {.border = border, .ends = ends});
      const SlopeImage expected =
          dense_projection(image, weights, border == Border::Wrap, ends == HeightEnds::Zero);
      EXPECT_LT(largest_difference(out, expected, weights), 5e-6)
          << name_of(border) << " " << name_of(ends);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Shapes, AgainstDense,
    testing::Values(DenseCase{12, 10, 0.0F, false}, DenseCase{9, 11, 0.0F, false},
                    DenseCase{13, 10, 0.2F, false}, DenseCase{16, 16, 0.35F, false},
                    DenseCase{11, 9, 0.2F, true}, DenseCase{17, 2, 0.1F, false},
                    DenseCase{1, 14, 0.1F, true}, DenseCase{3, 3, 0.0F, false}));

TEST(Project, HeightsOfNeighboursDifferByTheirMeanSlope) {
  const MaskImage mask = disc(120);
  SlopeImage slopes(120, 120);
  MaskImage height(120, 120);
  project_to_integrable(noise_image(120, 120), mask, {.slopes = slopes, .height = height},
                        slopes.rect());
  double sum = 0.0;
  for (int y = 0; y + 1 < 120; ++y) {
    for (int x = 0; x + 1 < 120; ++x) {
      if (mask(x, y) == 0.0F) {
        EXPECT_TRUE(std::isnan(height(x, y)));
        continue;
      }
      sum += static_cast<double>(height(x, y));
      if (mask(x + 1, y) > 0.0F) {
        EXPECT_NEAR(height(x + 1, y) - height(x, y),
                    0.5F * (slopes(x, y).x() + slopes(x + 1, y).x()), 5e-6F);
      }
      if (mask(x, y + 1) > 0.0F) {
        EXPECT_NEAR(height(x, y + 1) - height(x, y),
                    -0.5F * (slopes(x, y).y() + slopes(x, y + 1).y()), 5e-6F);
      }
    }
  }
  EXPECT_NEAR(sum / (120.0 * 120.0), 0.0, 1e-6);
}

// Noise on domains that refine: the multigrid keeps its pace.
TEST(Project, IterationsDoNotGrowWithSize) {
  NORMALSHOP_SKIP_FIGURES();
  for (const auto shape : {disc, snakes}) {
    std::vector<int> iterations;
    for (const int size : {256, 512, 1024}) {
      const SlopeImage image = noise_image(size, size);
      MaskImage height(size, size);
      iterations.push_back(integrate_height(image, shape(size), height, height.rect()).iterations);
    }
    EXPECT_LE(iterations[0], 8);
    EXPECT_LE(iterations[1], iterations[0] + 1);
    EXPECT_LE(iterations[2], iterations[0] + 1);
  }
}

// Stairs around a hole: no curl anywhere, but once around climbs (thesis 2.4.1).
// Around the corner of a tile, too.
TEST(Project, TheNumberOfThreadsChangesNothing) {
  const SlopeImage image = noise_image(301, 203);
  for (const Border border : {Border::Clamp, Border::Wrap}) {
    for (const float fade : {0.0F, 8.0F}) {
      const ProjectOptions options = {.border = border, .fade = fade};
      MaskImage mask(301, 203, 1.0F);
      for (int y = 80; y < 110; ++y) {
        for (int x = 30; x < 200; ++x) mask(x, y) = 0.0F;
      }
      const SlopeImage many = projected(image, mask, options);
      SlopeImage one = image;
      const ThreadLimit limit(1);
      project_to_integrable(one, mask, {.slopes = one}, one.rect(), options);  // in place, too
      EXPECT_TRUE(same(many, one));
    }
  }
}

TEST(Project, LimitingCases) {
  const SlopeImage image = noise_image(20, 20);
  const MaskImage none(20, 20, 0.0F);
  for (const Border border : {Border::Clamp, Border::Mirror, Border::Wrap}) {
    SlopeImage out(20, 20);
    MaskImage height(20, 20, 1.0F);
    const Projection done = project_to_integrable(image, none, {.slopes = out, .height = height},
                                                  out.rect(), {.border = border});
    EXPECT_TRUE(same(image, out));
    EXPECT_TRUE(std::isnan(height(3, 3)));
    EXPECT_EQ(done.removed_share, 0.0);
    EXPECT_EQ(done.iterations, 0);

    const SlopeImage flat(20, 20, Vec2f::Zero());
    EXPECT_TRUE(same(flat, projected(flat, {}, {.border = border})));

    SlopeImage pixel(1, 1, Vec2f(1.0F, -2.0F));
    MaskImage level(1, 1);
    project_to_integrable(pixel, {}, {.slopes = pixel, .height = level}, pixel.rect(),
                          {.border = border});
    EXPECT_NEAR(pixel(0, 0).x(), 1.0F, 1e-6F);
    EXPECT_NEAR(pixel(0, 0).y(), -2.0F, 1e-6F);
    EXPECT_NEAR(level(0, 0), 0.0F, 1e-6F);
  }
  SlopeImage out(20, 20);
  EXPECT_TRUE(project_to_integrable(image, {}, {.slopes = out}, {4, 4, 4, 9}).written.empty());
}

TEST(Project, RejectsOptionsOutOfRange) {
  SlopeImage image(8, 8, Vec2f::Zero());
  for (const float bad : {nan, -1.0F, 1e5F}) {
    EXPECT_THROW(project_to_integrable(image, {}, {.slopes = image}, image.rect(), {.fade = bad}),
                 InvalidInput);
    EXPECT_THROW(
        project_to_integrable(image, {}, {.slopes = image}, image.rect(), {.tolerance = bad}),
        InvalidInput);
  }
}

TEST(Project, CancellingWritesNothing) {
  const SlopeImage image = noise_image(200, 200);
  SlopeImage out(200, 200, Vec2f::Constant(9.0F));
  Progress progress;
  int calls = 0;
  progress.report = [&](double fraction, std::string_view) {
    EXPECT_GE(fraction, 0.0);
    EXPECT_LE(fraction, 1.0);
    return ++calls < 3;
  };
  EXPECT_THROW(project_to_integrable(image, {}, {.slopes = out}, out.rect(), {}, progress),
               Cancelled);
  EXPECT_EQ(calls, 3);
  EXPECT_TRUE(same(out, SlopeImage(200, 200, Vec2f::Constant(9.0F))));
}

}  // namespace
}  // namespace normalshop::test
