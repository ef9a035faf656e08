#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "normalshop/core/error.h"
#include "normalshop/core/parallel.h"
#include "normalshop/core/slope.h"
#include "normalshop/rgbn/warp_brush.h"
#include "normalshop/rgbn/warp_lattice.h"

namespace normalshop::test {
namespace {

using std::numbers::pi;

/// A lattice after some brushes, its cells not of whole pixels.
WarpLattice brushed(float spacing = 5.0F) {
  WarpLattice lattice({3, -4, 200, 161}, spacing);
  push(lattice, {50.0F, 60.0F}, {120.0F, 90.0F}, {.radius = 40.0F, .strength = 0.6F});
  twirl(lattice, {130.0F, 70.0F}, {.radius = 60.0F, .strength = 0.7F});
  pinch(lattice, {80.0F, 100.0F}, {.radius = 35.0F, .strength = -0.8F});
  grab(lattice, {60.0F, 40.0F}, {75.0F, 60.0F}, {.radius = 50.0F});
  return lattice;
}

Eigen::Matrix2d by_differences(const WarpLattice& lattice, const Vec2d& p) {
  constexpr double h = 0.02;
  Eigen::Matrix2d result;
  for (int k = 0; k < 2; ++k) {
    const Vec2d step = h * Vec2d::Unit(k);
    const auto at = [&](double times) { return lattice.at(p + times * step).position; };
    result.col(k) = (8.0 * (at(1) - at(-1)) - (at(2) - at(-2))) / (12.0 * h);
  }
  return result;
}

TEST(WarpLattice, StartsAsTheIdentity) {
  const WarpLattice lattice({3, -4, 200, 161}, 5.0F);
  for (const Vec2d& p : {Vec2d(3, -4), Vec2d(17.3, 99.9), Vec2d(199, 160), Vec2d(-50, 400)}) {
    EXPECT_EQ(lattice.at(p).position, p);
    EXPECT_EQ(lattice.at(p).jacobian, Eigen::Matrix2d(Eigen::Matrix2d::Identity()));
  }
  EXPECT_EQ(least_area(lattice).determinant, 1.0);
}

TEST(WarpLattice, TheJacobianIsTheDerivativeOfThePosition) {
  const WarpLattice lattice = brushed();
  double worst = 0.0;
  double bends = 0.0;
  for (double y = -4.0; y < 161.0; y += 1.37) {
    for (double x = 3.0; x < 200.0; x += 1.37) {
      const Vec2d cell = (Vec2d(x, y) - Vec2d(3, -4)).cwiseQuotient(lattice.spacing());
      const Vec2d t = cell - Vec2d(std::floor(cell.x()), std::floor(cell.y()));
      if (t.minCoeff() < 0.02 || t.maxCoeff() > 0.98) continue;  // differences across cells
      const Eigen::Matrix2d truth = by_differences(lattice, {x, y});
      worst = std::max(worst, (lattice.at({x, y}).jacobian - truth).cwiseAbs().maxCoeff());
      bends = std::max(bends, (truth - Eigen::Matrix2d::Identity()).cwiseAbs().maxCoeff());
    }
  }
  EXPECT_LT(worst, 1e-9);
  EXPECT_GT(bends, 0.5);
}

TEST(WarpLattice, TheJacobianIsContinuousAcrossCells) {
  const WarpLattice lattice = brushed();
  for (int column = 1; column + 1 < lattice.columns(); ++column) {
    for (const double y : {33.3, 71.9, 90.0}) {
      const Vec2d p(lattice.place(column, 0).x(), y);
      const Vec2d step(1e-9, 0.0);
      const Eigen::Matrix2d jump = lattice.at(p + step).jacobian - lattice.at(p - step).jacobian;
      ASSERT_LT(jump.cwiseAbs().maxCoeff(), 1e-7) << column;
    }
  }
}

TEST(WarpLattice, ARunGivesThePointsOneByOne) {
  const WarpLattice lattice = brushed();
  std::vector<WarpPoint> run(230);
  for (const int y : {-20, 40, 77, 160}) {
    map_of(lattice)(-10, y, run);
    for (std::size_t i = 0; i < run.size(); ++i) {
      const WarpPoint one = lattice.at(Vec2d(static_cast<double>(i) - 10.0, y));
      ASSERT_EQ(run[i].position, one.position) << i;
      ASSERT_EQ(run[i].jacobian, one.jacobian) << i;
    }
  }
}

/// How much of the warped gradient turns around the cells' outlines: Gauss quadrature of the
/// analytic gradient through the lattice, no differences. `transposed`: as it is right.
double lattice_curl_share(const WarpLattice& lattice, bool transposed) {
  const std::array<double, 5> nodes = {-0.9061798459386640, -0.5384693101056831, 0.0,
                                       0.5384693101056831, 0.9061798459386640};
  const std::array<double, 5> weights = {0.2369268850561891, 0.4786286704993665, 0.5688888888888889,
                                         0.4786286704993665, 0.2369268850561891};
  const auto gradient = [&](const Vec2d& p) {
    const WarpPoint w = lattice.at(p);
    const double a = 0.03 * w.position.x() + 0.02 * w.position.y();
    const double b = 0.025 * w.position.x() - 0.04 * w.position.y();
    const Vec2d g(0.09 * std::cos(a) - 0.05 * std::sin(b), 0.06 * std::cos(a) + 0.08 * std::sin(b));
    return transposed ? Vec2d(w.jacobian.transpose() * g) : Vec2d(w.jacobian * g);
  };
  double around = 0.0;
  double along = 0.0;
  const auto edge = [&](const Vec2d& from, const Vec2d& to, double& circulation, double& total) {
    // Pieces, so that the quadrature's error is below what is measured.
    for (int piece = 0; piece < 4; ++piece) {
      for (std::size_t k = 0; k < nodes.size(); ++k) {
        const double t = (piece + 0.5 + 0.5 * nodes[k]) / 4.0;
        const Vec2d g = gradient(from + t * (to - from));
        circulation += 0.125 * weights[k] * g.dot(to - from);
        total += 0.125 * weights[k] * g.norm() * (to - from).norm();
      }
    }
  };
  for (int row = 0; row + 1 < lattice.rows(); ++row) {
    for (int column = 0; column + 1 < lattice.columns(); ++column) {
      const Vec2d a = lattice.place(column, row);
      const Vec2d b = lattice.place(column + 1, row);
      const Vec2d c = lattice.place(column + 1, row + 1);
      const Vec2d d = lattice.place(column, row + 1);
      double circulation = 0.0;
      double total = 0.0;
      edge(a, b, circulation, total);
      edge(b, c, circulation, total);
      edge(c, d, circulation, total);
      edge(d, a, circulation, total);
      around += circulation * circulation;
      along += total * total;
    }
  }
  return std::sqrt(around / along);
}

TEST(WarpLattice, WarpedGradientsStayFreeOfCurl) {
  const WarpLattice lattice = brushed();
  EXPECT_LT(lattice_curl_share(lattice, true), 1e-6);
  EXPECT_GT(lattice_curl_share(lattice, false), 1e-3);  // what a wrong transpose would give
}

// Oracle: slopes of z(W(x)) by differences of the height through the lattice.
TEST(WarpLattice, WarpsAnImageLikeItsHeight) {
  const WarpLattice lattice = brushed();
  const auto z = [](const Vec2d& p) {
    return 3.0 * std::sin(0.11 * p.x() + 0.05 * p.y()) + 2.0 * std::cos(0.07 * p.x() - 0.1 * p.y());
  };
  const auto slopes = [](const auto& height, double x, double y) {
    constexpr double h = 1e-3;
    return Vec2f(
        static_cast<float>((height(Vec2d(x + h, y)) - height(Vec2d(x - h, y))) / (2.0 * h)),
        static_cast<float>((height(Vec2d(x, y - h)) - height(Vec2d(x, y + h))) / (2.0 * h)));
  };
  SlopeImage source(200, 160);
  for (int y = 0; y < 160; ++y) {
    for (int x = 0; x < 200; ++x) source(x, y) = slopes(z, x, y);
  }
  SlopeImage out(200, 160);
  warp({source, {}, {}}, {out, {}}, out.rect(), map_of(lattice), {});
  const auto warped = [&](const Vec2d& p) { return z(lattice.at(p).position); };
  double worst = 0.0;
  double sum = 0.0;
  for (int y = 5; y < 155; ++y) {
    for (int x = 8; x < 195; ++x) {
      const Vec2f truth = slopes(warped, x, y);
      const double error = angle_degrees(normal_from_slope(truth), normal_from_slope(out(x, y)));
      worst = std::max(worst, error);
      sum += error;
    }
  }
  EXPECT_LT(worst, 0.6);  // where it is reduced, averaging flattens a little
  EXPECT_LT(sum / (150.0 * 187.0), 0.02);
  warp({source, {}, {}}, {out, {}}, out.rect(), map_of(lattice),
       {.reduction = WarpReduction::Sample});
  float miss = 0.0F;
  float low = 0.0F;
  float high = 0.0F;
  for (int y = 5; y < 155; ++y) {
    for (int x = 8; x < 195; ++x) {
      const Vec2f truth = slopes(warped, x, y);
      miss = std::max(miss, (out(x, y) - truth).cwiseAbs().maxCoeff());
      low = std::min(low, truth.minCoeff());
      high = std::max(high, truth.maxCoeff());
    }
  }
  EXPECT_LT(miss, 1e-4F * (high - low));
}

TEST(WarpLattice, InterpolatesToFourthOrder) {
  const auto error = [](float spacing) {
    WarpLattice lattice({0, 0, 200, 200}, spacing);
    const auto truth = [](const Vec2d& p) {
      const double a = 2.0 * pi / 100.0;
      WarpPoint w;
      w.position = p + 5.0 * Vec2d(std::sin(a * p.x()) * std::cos(a * p.y()),
                                   std::cos(a * p.x() + a * p.y()));
      const double s = -5.0 * a * std::sin(a * p.x() + a * p.y());
      w.jacobian << 1.0 + 5.0 * a * std::cos(a * p.x()) * std::cos(a * p.y()),
          -5.0 * a * std::sin(a * p.x()) * std::sin(a * p.y()), s, 1.0 + s;
      return w;
    };
    compose(lattice, lattice.all_nodes(), truth);
    double worst = 0.0;
    for (double y = 30.0; y < 170.0; y += 0.7) {
      for (double x = 30.0; x < 170.0; x += 0.7) {
        worst = std::max(
            worst, (lattice.at({x, y}).position - truth({x, y}).position).cwiseAbs().maxCoeff());
      }
    }
    return worst;
  };
  const double coarse = error(10.0F);
  const double fine = error(5.0F);
  EXPECT_LT(fine, 4e-4);           // pixels
  EXPECT_GT(coarse / fine, 12.0);  // 16 for the fourth order
}

TEST(WarpLattice, FindsTheLeastArea) {
  const WarpLattice lattice = brushed();
  const LeastArea least = least_area(lattice);
  double brute = 1e9;
  for (double y = -4.0; y < 161.0; y += 0.25) {
    for (double x = 3.0; x < 200.0; x += 0.25) {
      brute = std::min(brute, lattice.at({x, y}).jacobian.determinant());
    }
  }
  EXPECT_LT(least.determinant, brute + 1e-4);
  EXPECT_GT(least.determinant, brute - 2e-3);  // what lies between the samples
  EXPECT_NEAR(lattice.at(least.place).jacobian.determinant(), least.determinant, 1e-9);
}

// A fold inside one cell, all of whose nodes have positive determinants.
TEST(WarpLattice, FindsAFoldBetweenNodes) {
  WarpLattice lattice({0, 0, 80, 80}, 8.0F);
  lattice.edit({4, 4, 6, 6}, [](int column, int) {
    WarpLattice::Node node;
    node.offset = {column == 4 ? 3.5 : -3.5, 0.0};
    return node;
  });
  for (int row = 0; row < lattice.rows(); ++row) {
    for (int column = 0; column < lattice.columns(); ++column) {
      EXPECT_GT(lattice.at(lattice.place(column, row)).jacobian.determinant(), 0.9);
    }
  }
  const LeastArea least = least_area(lattice);
  EXPECT_LT(least.determinant, -0.2);
  EXPECT_NEAR(least.place.x(), 36.0, 0.3);
  EXPECT_GE(least.place.y(), 30.0);
  EXPECT_LE(least.place.y(), 42.0);
  EXPECT_EQ(least_area(lattice, {7, 0, 11, 11}).determinant, 1.0);  // not there
}

TEST(WarpLattice, ARepeatingLatticeRepeats) {
  WarpLattice lattice({0, 0, 90, 70}, 4.0F, LatticeEdge::Repeat);
  twirl(lattice, {3.0F, 68.0F}, {.radius = 30.0F, .strength = 0.5F});
  grab(lattice, {85.0F, 30.0F}, {97.0F, 41.0F}, {.radius = 30.0F});
  double moves = 0.0;
  for (const Vec2d& p : {Vec2d(2.0, 66.0), Vec2d(89.7, 0.3), Vec2d(0.0, 0.0), Vec2d(5.0, 35.0)}) {
    const WarpPoint here = lattice.at(p);
    const WarpPoint there = lattice.at(p + Vec2d(90.0, -140.0));
    EXPECT_LT((here.position + Vec2d(90.0, -140.0) - there.position).norm(), 1e-9);
    EXPECT_LT((here.jacobian - there.jacobian).norm(), 1e-9);
    moves = std::max(moves, (here.position - p).norm());
  }
  EXPECT_GT(moves, 2.0);
}

/// A picture of waves that repeats every 90 x 70 pixels, and its slopes, y up.
Vec2f tile_slopes(const Vec2d& p, const Eigen::Matrix2d& jacobian) {
  const double a = 2.0 * pi / 45.0;
  const double b = 2.0 * pi / 35.0;
  const Vec2d gradient(2.0 * a * std::cos(a * p.x()) * std::cos(b * p.y()),
                       -2.0 * b * std::sin(a * p.x()) * std::sin(b * p.y()));
  const Vec2d g = jacobian.transpose() * gradient;
  return {static_cast<float>(g.x()), static_cast<float>(-g.y())};
}

TEST(WarpLattice, ARepeatingWarpKeepsATileTileable) {
  WarpLattice lattice({0, 0, 90, 70}, 4.0F, LatticeEdge::Repeat);
  twirl(lattice, {3.0F, 68.0F}, {.radius = 30.0F, .strength = 0.3F});
  push(lattice, {70.0F, 30.0F}, {110.0F, 40.0F}, {.radius = 25.0F, .strength = 0.5F});
  SlopeImage source(90, 70);
  for (int y = 0; y < 70; ++y) {
    for (int x = 0; x < 90; ++x) source(x, y) = tile_slopes({x, y}, Eigen::Matrix2d::Identity());
  }
  SlopeImage out(90, 70);
  warp({source, {}, {}}, {out, {}}, out.rect(), map_of(lattice), {.border = Border::Wrap});
  // The analytic answer continues over the seam; so does the picture if it agrees along it.
  for (int y = 0; y < 70; ++y) {
    for (int x = 0; x < 90; ++x) {
      const WarpPoint beyond = lattice.at(Vec2d(x - 90.0, y + 70.0));
      const double error =
          angle_degrees(normal_from_slope(out(x, y)),
                        normal_from_slope(tile_slopes(beyond.position, beyond.jacobian)));
      ASSERT_LT(error, 1.0) << x << ' ' << y;
    }
  }
  // Two copies side by side, warped by the pattern as a whole, are two copies of the result.
  SlopeImage twice(180, 70);
  warp({source, {}, {}}, {twice, {}}, twice.rect(), map_of(lattice), {.border = Border::Wrap});
  for (int y = 0; y < 70; ++y) {
    for (int x = 0; x < 90; ++x) ASSERT_LT((twice(x + 90, y) - out(x, y)).norm(), 1e-5F);
  }
}

TEST(WarpLattice, TheNumberOfThreadsChangesNothing) {
  const WarpLattice many = brushed();
  const LeastArea worst = least_area(many);
  const ThreadLimit limit(1);
  const WarpLattice one = brushed();
  EXPECT_EQ(least_area(one).place, worst.place);
  EXPECT_EQ(least_area(one).determinant, worst.determinant);
  for (int row = 0; row < one.rows(); ++row) {
    for (int column = 0; column < one.columns(); ++column) {
      const WarpLattice::Node& a = many.node(column, row);
      const WarpLattice::Node& b = one.node(column, row);
      ASSERT_TRUE(a.offset == b.offset && a.dx == b.dx && a.dy == b.dy && a.dxdy == b.dxdy);
    }
  }
}

TEST(WarpLattice, RejectsWhatIsNoLattice) {
  EXPECT_THROW(WarpLattice({5, 5, 5, 9}, 4.0F), InvalidInput);
  EXPECT_THROW(WarpLattice({0, 0, 9, 9}, 0.5F), InvalidInput);
  EXPECT_THROW(WarpLattice({0, 0, 9, 9}, std::numeric_limits<float>::quiet_NaN()), InvalidInput);
  EXPECT_THROW(WarpLattice({0, 0, 1000000, 1000000}, 1.0F), InvalidInput);
  const WarpLattice pixel({0, 0, 1, 1}, 4.0F, LatticeEdge::Repeat);
  EXPECT_EQ(pixel.at({0.3, 7.5}).position, Vec2d(0.3, 7.5));
}

}  // namespace
}  // namespace normalshop::test
