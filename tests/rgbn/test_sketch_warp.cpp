#include <cmath>

#include "support/nan.h"
#include <gtest/gtest.h>

#include "normalshop/core/error.h"
#include "normalshop/core/parallel.h"
#include "normalshop/rgbn/curl.h"
#include "normalshop/rgbn/detail/hermite_rbf.h"
#include "normalshop/rgbn/detail/stroke_samples.h"
#include "normalshop/rgbn/sketch_warp.h"

namespace normalshop::test {
namespace {

constexpr float two_pi = 6.283185307179586F;

Stroke ellipse(const Vec2f& center, float a, float b, int count, float start = 0.0F,
               bool clockwise = false) {
  Stroke stroke;
  for (int i = 0; i < count; ++i) {
    const float t = start + two_pi * static_cast<float>(i) / static_cast<float>(count);
    const float y = clockwise ? -b * std::sin(t) : b * std::sin(t);
    stroke.push_back({center + Vec2f(a * std::cos(t), y)});
  }
  return stroke;
}

Stroke line(const Vec2f& from, const Vec2f& to) { return {{from}, {to}}; }

Stroke arch(const Vec2f& from, float width, float rise) {
  Stroke stroke;
  for (int i = 0; i <= 40; ++i) {
    const float t = static_cast<float>(i) / 40.0F;
    stroke.push_back({from + Vec2f(width * t, -rise * std::sin(0.5F * two_pi * t))});
  }
  return stroke;
}

const Stroke boundary = ellipse({150.0F, 130.0F}, 130.0F, 110.0F, 64);

std::vector<SketchPair> a_smile() {
  return {{line({90.0F, 130.0F}, {210.0F, 130.0F}), arch({95.0F, 140.0F}, 110.0F, 25.0F)},
          {line({120.0F, 180.0F}, {180.0F, 180.0F}), line({115.0F, 185.0F}, {190.0F, 178.0F})}};
}

/// Worst distance from W(target stroke) to the source stroke at equal parts of their lengths.
double worst_miss(const WarpLattice& lattice, const SketchPair& pair, int parts) {
  const PolylineByLength source(pair.source, pair.closed);
  const PolylineByLength target(pair.target, pair.closed);
  double worst = 0.0;
  for (int i = 0; i <= parts; ++i) {
    const double t = static_cast<double>(i) / parts;
    worst = std::max(worst, (lattice.at(target.at(t)).position - source.at(t)).norm());
  }
  return worst;
}

std::string message_of(const Stroke& border, const std::vector<SketchPair>& pairs,
                       const SketchWarpOptions& options = {}) {
  try {
    sketch_warp(border, pairs, options);
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

TEST(HermiteRbf, MeetsValuesAndGradients) {
  std::vector<Vec2d> points;
  for (int i = 0; i < 40; ++i)
    points.emplace_back(300.0 + 17.0 * (i % 7) + 0.3 * i, 11.0 * (i / 7));
  constexpr std::size_t hermite = 15;
  const HermiteRbf rbf(points, hermite);
  Eigen::MatrixX2d values(40, 2);
  Eigen::MatrixX2d gradients(30, 2);
  for (int i = 0; i < 40; ++i) values.row(i) << std::sin(0.7 * i), std::cos(1.3 * i);
  for (int i = 0; i < 30; ++i) gradients.row(i) << 0.1 * std::sin(2.1 * i), 0.1 * std::cos(i);
  const HermiteRbfField field = rbf.solve(values, gradients);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto at = field.at(points[i]);
    const auto row = static_cast<Eigen::Index>(i);
    EXPECT_LT((at.value - values.row(row).transpose()).norm(), 1e-9) << i;
    if (i >= hermite) continue;
    EXPECT_LT((at.jacobian - gradients.middleRows<2>(2 * row).transpose()).norm(), 1e-9) << i;
  }
  // The Jacobian is the derivative, also away from the points.
  for (const Vec2d& p : {Vec2d(317.3, 21.1), Vec2d(250.0, 90.0), Vec2d(371.0, 3.0)}) {
    Eigen::Matrix2d differences;
    for (int k = 0; k < 2; ++k) {
      const Vec2d h = 1e-4 * Vec2d::Unit(k);
      differences.col(k) = (field.at(p + h).value - field.at(p - h).value) / 2e-4;
    }
    EXPECT_LT((field.at(p).jacobian - differences).norm(), 1e-6);
  }
}

TEST(HermiteRbf, ReproducesLinearFunctions) {
  std::vector<Vec2d> points = {{0, 0}, {50, 3}, {20, 40}, {90, 70}, {10, 80}, {60, 20}};
  const HermiteRbf rbf(points, 2);
  Eigen::Matrix2d a;
  a << 0.3, -0.7, 1.2, 0.1;
  Eigen::MatrixX2d values(6, 2);
  Eigen::MatrixX2d gradients(4, 2);
  for (int i = 0; i < 6; ++i) {
    values.row(i) = (a * points[static_cast<std::size_t>(i)] + Vec2d(5, -2)).transpose();
  }
  gradients << a.transpose(), a.transpose();
  const HermiteRbfField field = rbf.solve(values, gradients);
  EXPECT_LT((field.at({33.0, -40.0}).value - (a * Vec2d(33, -40) + Vec2d(5, -2))).norm(), 1e-10);
  EXPECT_LT((field.at({33.0, -40.0}).jacobian - a).norm(), 1e-10);
}

TEST(SketchWarp, MapsTheStrokesOntoEachOther) {
  const std::vector<SketchPair> pairs = a_smile();
  const SketchWarp warp = sketch_warp(boundary, pairs);
  EXPECT_LT(warp.miss, 1e-3);
  EXPECT_GT(warp.least.determinant, 0.01);
  for (const SketchPair& pair : pairs) {
    const double length = std::max(PolylineByLength(pair.source, false).length(),
                                   PolylineByLength(pair.target, false).length());
    EXPECT_LT(worst_miss(warp.lattice, pair, static_cast<int>(std::ceil(length / 8.0))), 1e-3);
    EXPECT_LT(worst_miss(warp.lattice, pair, 501), 0.25);  // between the fitted points, too
  }
}

TEST(SketchWarp, IsTheIdentityOutsideAndJoinsItSmoothly) {
  const SketchWarp warp = sketch_warp(boundary, a_smile());
  const PolylineByLength border(boundary, true);
  for (int y = -20; y < 300; ++y) {
    for (int x = -20; x < 320; ++x) {
      if (border.has_inside(Vec2d(x, y))) continue;
      ASSERT_EQ(warp.lattice.at(Vec2d(x, y)).position, Vec2d(x, y));
    }
  }
  double jump = 0.0;
  double beside = 0.0;
  double beyond = 0.0;
  for (int i = 0; i < 1000; ++i) {
    const Vec2d p = border.at(i / 1000.0);
    const Vec2d inwards = (Vec2d(150.0, 130.0) - p).normalized();
    const Eigen::Matrix2d inside = warp.lattice.at(p + 0.01 * inwards).jacobian;
    jump = std::max(jump, (inside - Eigen::Matrix2d::Identity()).cwiseAbs().maxCoeff());
    // No hidden crease in the cells beside it: DW changes slowly from pixel to pixel.
    for (double d = 0.0; d < 30.0; d += 1.0) {
      const Eigen::Matrix2d a = warp.lattice.at(p + d * inwards).jacobian;
      const Eigen::Matrix2d b = warp.lattice.at(p + (d + 1.0) * inwards).jacobian;
      double& bend = d < 12.0 ? beside : beyond;
      bend = std::max(bend, (a - b).cwiseAbs().maxCoeff());
    }
  }
  EXPECT_LT(jump, 1e-3);
  EXPECT_LT(std::max(beside, beyond), 0.06);
  // Where the collar ends W - identity is k d^2 / 2 at the depth d, the first free node lies at
  // d = t h, 0 <= t <= 1, of a cell h wide, and the node before it has 0 and slope 0. The cubic
  // between them has the second derivatives 3 k t^2 - 2 k t and 4 k t - 3 k t^2 at its ends, at
  // most 4/3 k. (With the interpolation starting at the boundary d is up to 2 h: 8 k.)
  EXPECT_LT(beside, 4.0 / 3.0 * beyond);
}

// The picture itself: bits outside, and inside the slopes of the height through the warp.
TEST(SketchWarp, WarpsAPictureLikeItsHeight) {
  const SketchWarp warp_of_strokes = sketch_warp(boundary, a_smile());
  const WarpLattice& lattice = warp_of_strokes.lattice;
  const auto z = [](const Vec2d& p) {
    return 3.0 * std::sin(0.09 * p.x() + 0.05 * p.y()) +
           4.0 * std::cos(0.04 * p.x() - 0.07 * p.y());
  };
  const auto slopes = [](const auto& height, double x, double y) {
    constexpr double h = 1e-3;
    return Vec2d((height(Vec2d(x + h, y)) - height(Vec2d(x - h, y))) / (2.0 * h),
                 (height(Vec2d(x, y - h)) - height(Vec2d(x, y + h))) / (2.0 * h));
  };
  SlopeImage source(300, 260);
  for (int y = 0; y < 260; ++y) {
    for (int x = 0; x < 300; ++x) source(x, y) = slopes(z, x, y).cast<float>();
  }
  SlopeImage out(300, 260);
  warp({source, {}, {}}, {out, {}}, out.rect(), map_of(lattice),
       {.reduction = WarpReduction::Sample});
  const PolylineByLength border(boundary, true);
  double worst = 0.0;
  double low = 0.0;
  double high = 0.0;
  for (int y = 0; y < 260; ++y) {
    for (int x = 0; x < 300; ++x) {
      if (!border.has_inside(Vec2d(x, y))) {
        ASSERT_EQ(out(x, y), source(x, y)) << x << ' ' << y;
        continue;
      }
      const auto warped = [&](const Vec2d& p) { return z(lattice.at(p).position); };
      const Vec2d truth = slopes(warped, x, y);
      worst = std::max(worst, (out(x, y).cast<double>() - truth).cwiseAbs().maxCoeff());
      low = std::min(low, truth.minCoeff());
      high = std::max(high, truth.maxCoeff());
    }
  }
  EXPECT_LT(worst, 1e-4 * (high - low));
  EXPECT_LT(curl_share(out, {}), 1e-6);
}

// The interpolation's gradient constraints need room: a boundary around a few cells only.
TEST(SketchWarp, SmallBoundaries) {
  for (const float radius : {7.0F, 8.0F, 10.0F, 15.0F}) {
    const Stroke small = ellipse({50.0F, 50.0F}, radius, radius, 40);
    const std::vector<SketchPair> pin = {{{{Vec2f(50.2F, 50.0F)}}, {{Vec2f(50.0F, 50.0F)}}}};
    const SketchWarp warp = sketch_warp(small, pin);
    EXPECT_LT((warp.lattice.at({50.0, 50.0}).position - Vec2d(50.2, 50.0)).norm(), 0.05) << radius;
    EXPECT_GT(warp.least.determinant, 0.5) << radius;
  }
  const std::vector<SketchPair> pin = {{{{Vec2f(50.2F, 50.0F)}}, {{Vec2f(50.0F, 50.0F)}}}};
  EXPECT_NE(message_of(ellipse({50.0F, 50.0F}, 5.0F, 5.0F, 40), pin).find("too close"),
            std::string::npos);
}

TEST(SketchWarp, TheInterpolationItselfJoinsTheIdentity) {
  // The system without the lattice: W = identity and DW = I on the boundary, between its points
  // too.
  const PolylineByLength border(boundary, true);
  std::vector<Vec2d> points;
  for (int i = 0; i < 96; ++i) points.push_back(border.at(i / 96.0));
  const std::size_t fixed = points.size();
  points.emplace_back(150.0, 130.0);
  Eigen::MatrixX2d values = Eigen::MatrixX2d::Zero(97, 2);
  values.row(96) << 20.0, -10.0;
  const HermiteRbfField field = HermiteRbf(points, fixed).solve(values, {});
  for (int i = 0; i < 96 * 4; ++i) {
    const auto at = field.at(border.at(i / (96.0 * 4.0)));
    EXPECT_LT(at.value.norm(), 2e-3);
    EXPECT_LT(at.jacobian.cwiseAbs().maxCoeff(), 1e-3);
  }
}

TEST(SketchWarp, MatchesOutlinesByShape) {
  // The target starts elsewhere and runs the other way.
  const SketchPair pair{ellipse({150.0F, 130.0F}, 60.0F, 30.0F, 80),
                        ellipse({155.0F, 125.0F}, 70.0F, 40.0F, 91, 2.0F, true), true};
  const SketchWarp warp = sketch_warp(boundary, std::vector{pair});
  EXPECT_LT(warp.miss, 1e-3);
  EXPECT_EQ(warp.steps, 1);
  // Right stays right.
  const Vec2d right = warp.lattice.at({225.0, 125.0}).position;
  EXPECT_NEAR(right.x(), 210.0, 0.5);
  EXPECT_NEAR(right.y(), 130.0, 2.0);
  const PolylineByLength source(pair.source, true);
  for (int i = 0; i < 100; ++i) {  // the outline comes from the outline
    const Vec2d p = warp.lattice.at(PolylineByLength(pair.target, true).at(i / 100.0)).position;
    const Vec2d unit = (p - Vec2d(150.0, 130.0)).cwiseQuotient(Vec2d(60.0, 30.0));
    EXPECT_NEAR(unit.norm(), 1.0, 0.01);
  }
}

TEST(SketchWarp, PinsPoints) {
  const std::vector<SketchPair> pairs = {{{{Vec2f(150.0F, 130.0F)}}, {{Vec2f(160.0F, 120.0F)}}},
                                         {{{Vec2f(100.0F, 100.0F)}}, {{Vec2f(100.0F, 100.0F)}}}};
  const SketchWarp warp = sketch_warp(boundary, pairs);
  EXPECT_LT((warp.lattice.at({160.0, 120.0}).position - Vec2d(150.0, 130.0)).norm(), 1e-3);
  EXPECT_LT((warp.lattice.at({100.0, 100.0}).position - Vec2d(100.0, 100.0)).norm(), 1e-3);
}

TEST(SketchWarp, StrokesThatStayLeaveTheIdentity) {
  const std::vector<SketchPair> pairs = {{a_smile()[0].source, a_smile()[0].source}};
  for (const auto& warp : {sketch_warp(boundary, {}), sketch_warp(boundary, pairs)}) {
    for (int row = 0; row < warp.lattice.rows(); ++row) {
      for (int column = 0; column < warp.lattice.columns(); ++column) {
        ASSERT_EQ(warp.lattice.node(column, row).offset, Vec2d(0.0, 0.0));
        ASSERT_EQ(warp.lattice.node(column, row).dx, Vec2d(0.0, 0.0));
      }
    }
  }
}

TEST(SketchWarp, CutsALargeMotionIntoSteps) {
  // One solve folds here; steps do not.
  const std::vector<SketchPair> pairs = {
      {line({90.0F, 110.0F}, {90.0F, 150.0F}), line({175.0F, 110.0F}, {175.0F, 150.0F})}};
  const SketchWarp warp = sketch_warp(boundary, pairs);
  EXPECT_GT(warp.steps, 1);
  EXPECT_GE(warp.least.determinant, 0.01);
  EXPECT_LT(warp.miss, 1e-3);
  EXPECT_EQ(least_area(warp.lattice).determinant, warp.least.determinant);
}

TEST(SketchWarp, RefusesWhatFoldsNevertheless) {
  // Two strokes change places.
  const std::vector<SketchPair> pairs = {
      {line({120.0F, 100.0F}, {120.0F, 160.0F}), line({180.0F, 100.0F}, {180.0F, 160.0F})},
      {line({180.0F, 100.0F}, {180.0F, 160.0F}), line({120.0F, 100.0F}, {120.0F, 160.0F})}};
  const std::string message = message_of(boundary, pairs);
  EXPECT_NE(message.find("fold over near (1"), std::string::npos) << message;
}

TEST(SketchWarp, RejectsBadStrokes) {
  const std::vector<SketchPair> good = a_smile();
  const auto says = [](const std::string& message, const char* part) {
    EXPECT_NE(message.find(part), std::string::npos) << message;
  };
  says(message_of({}, good), "boundary has no points");
  says(message_of(line({0.0F, 0.0F}, {50.0F, 50.0F}), good), "enclose an area");
  says(message_of(boundary, {{{}, good[0].target}}), "source stroke has no points");
  says(message_of(boundary, {{good[0].source, {{Vec2f(50.0F, 5.0F)}}}}), "to the point (50, 5)");
  says(message_of(boundary, {{good[0].source, line({100.0F, 130.0F}, {500.0F, 130.0F})}}),
       "outside the boundary");
  const auto pin = [](const Vec2f& from, const Vec2f& to) { return SketchPair{{{from}}, {{to}}}; };
  says(message_of(boundary, {pin({150.0F, 23.0F}, {150.0F, 22.5F})}), "too close to the boundary");
  says(message_of(boundary, {pin({150.0F, 100.0F}, {150.0F, 120.0F}),
                             pin({160.0F, 120.0F}, {150.2F, 120.0F})}),
       "different things at (150, 120)");
  says(message_of(boundary, {{good[0].source, line({100.0F, 130.0F}, {200.0F, 130.0F})},
                             {good[1].source, line({150.0F, 90.0F}, {150.0F, 170.0F})}}),
       "fold over near (1");
  says(message_of(boundary, {{line({nan, 0.0F}, {1.0F, 1.0F}), good[0].target}}), "source stroke");
  says(message_of(boundary, good, {.spacing = nan}), "spacing must");
  says(message_of(boundary, good, {.point_spacing = 0.0F}), "point_spacing must");
  says(message_of(boundary, good, {.least_area = nan}), "least_area must");
}

TEST(SketchWarp, ManyStrokesStandFartherApart) {
  const SketchWarp warp = sketch_warp(boundary, a_smile(), {.point_spacing = 0.5F});
  EXPECT_LT(warp.miss, 1e-2);
  EXPECT_GT(warp.least.determinant, 0.01);
}

TEST(SketchWarp, TheNumberOfThreadsChangesNothing) {
  const SketchWarp many = sketch_warp(boundary, a_smile());
  const ThreadLimit limit(1);
  const SketchWarp one = sketch_warp(boundary, a_smile());
  for (int row = 0; row < one.lattice.rows(); ++row) {
    for (int column = 0; column < one.lattice.columns(); ++column) {
      const auto& a = many.lattice.node(column, row);
      const auto& b = one.lattice.node(column, row);
      ASSERT_TRUE(a.offset == b.offset && a.dx == b.dx && a.dy == b.dy && a.dxdy == b.dxdy);
    }
  }
}

TEST(StrokeSamples, PartsOfTheLength) {
  const Stroke square = {{{0.0F, 0.0F}}, {{10.0F, 0.0F}}, {{10.0F, 10.0F}}, {{0.0F, 10.0F}}};
  const PolylineByLength open(square, false);
  EXPECT_EQ(open.length(), 30.0);
  EXPECT_EQ(open.at(0.5), Vec2d(10.0, 5.0));
  EXPECT_EQ(open.at(2.0), Vec2d(0.0, 10.0));
  const PolylineByLength outline(square, true);
  EXPECT_EQ(outline.length(), 40.0);
  EXPECT_EQ(outline.at(1.125), Vec2d(5.0, 0.0));
  EXPECT_EQ(outline.enclosed_area(), 100.0);
  EXPECT_TRUE(outline.has_inside({5.0, 5.0}));
  EXPECT_FALSE(outline.has_inside({11.0, 5.0}));
  EXPECT_EQ(outline.distance({5.0, 4.0}), 4.0);
  EXPECT_EQ(outline.distance({13.0, 14.0}), 5.0);
  EXPECT_EQ(open.distance({-3.0, 5.0}), std::hypot(3.0, 5.0));  // its last side is missing
}

// Also with a notch, around whose corners the inset bends, and wherever the outline starts.
TEST(StrokeSamples, AnInsetKeepsItsDepthAndLeavesNoGap) {
  const Stroke notched = {{{0.0F, 0.0F}},   {{90.0F, 0.0F}},  {{90.0F, 80.0F}}, {{50.0F, 80.0F}},
                          {{45.0F, 40.0F}}, {{40.0F, 80.0F}}, {{0.0F, 80.0F}}};
  for (std::size_t start = 0; start < notched.size(); ++start) {
    Stroke stroke(notched.begin() + static_cast<std::ptrdiff_t>(start), notched.end());
    stroke.insert(stroke.end(), notched.begin(),
                  notched.begin() + static_cast<std::ptrdiff_t>(start));
    const PolylineByLength outline(stroke, true);
    const std::vector<Vec2d> points = outline.inset(6.0, 5.0);
    for (const Vec2d& p : points) {
      EXPECT_TRUE(outline.has_inside(p));
      EXPECT_NEAR(outline.distance(p), 6.0, 1e-9);
    }
    for (std::size_t i = 0; i < points.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) EXPECT_GT((points[i] - points[j]).norm(), 4.0);
    }
    for (double y = 0.0; y < 80.0; y += 0.5) {  // every place on it has a point beside it
      for (double x = 0.0; x < 90.0; x += 0.5) {
        if (!outline.has_inside({x, y}) || std::abs(outline.distance({x, y}) - 6.0) > 0.05)
          continue;
        double nearest = 1e9;
        for (const Vec2d& p : points) nearest = std::min(nearest, (p - Vec2d(x, y)).norm());
        ASSERT_LT(nearest, 5.0) << x << ' ' << y;
      }
    }
    EXPECT_TRUE(outline.inset(60.0, 5.0).empty());
  }
}

}  // namespace
}  // namespace normalshop::test
