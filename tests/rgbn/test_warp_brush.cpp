#include <cmath>

#include "support/nan.h"
#include <Eigen/LU>
#include <gtest/gtest.h>

#include "normalshop/core/error.h"
#include "normalshop/rgbn/warp_brush.h"

namespace normalshop::test {
namespace {

const Rect canvas = {0, 0, 256, 256};

bool same_nodes(const WarpLattice& a, const WarpLattice& b) {
  for (int row = 0; row < a.rows(); ++row) {
    for (int column = 0; column < a.columns(); ++column) {
      const WarpLattice::Node& m = a.node(column, row);
      const WarpLattice::Node& n = b.node(column, row);
      if (m.offset != n.offset || m.dx != n.dx || m.dy != n.dy || m.dxdy != n.dxdy) return false;
    }
  }
  return true;
}

TEST(WarpBrush, GrabTakesThePlaceAlong) {
  for (const Vec2f& to : {Vec2f(100.0F, 140.0F), Vec2f(210.0F, 60.0F)}) {  // one step and several
    WarpLattice lattice(canvas);
    const WarpDab dab = grab(lattice, {90.0F, 130.0F}, to, {.radius = 60.0F});
    EXPECT_EQ(dab.strength, 1.0F);
    EXPECT_LT((lattice.at(to.cast<double>()).position - Vec2d(90.0, 130.0)).norm(), 0.1);
    EXPECT_GE(least_area(lattice).determinant, 0.01);
  }
}

// One step of a grab is the exact inverse of y + motion * (1 - |y - centre|^2 / radius^2)^3.
TEST(WarpBrush, GrabFollowsTheFalloffAroundItsStart) {
  WarpLattice lattice(canvas, 2.0F);
  const Vec2d center(120.0, 128.0);
  const Vec2d motion(12.0, -8.0);
  grab(lattice, {120.0F, 128.0F}, {132.0F, 120.0F}, {.radius = 80.0F});
  for (const Vec2d& y : {Vec2d(120, 128), Vec2d(150, 100), Vec2d(90, 160), Vec2d(60, 110)}) {
    const double s = 1.0 - (y - center).squaredNorm() / 6400.0;
    const Vec2d moved = y + motion * s * s * s;
    EXPECT_LT((lattice.at(moved).position - y).norm(), 1e-3);
  }
}

TEST(WarpBrush, PushSmearsAlongItsWay) {
  WarpLattice lattice(canvas);
  push(lattice, {80.0F, 128.0F}, {150.0F, 128.0F}, {.radius = 30.0F, .strength = 0.5F});
  // What is shown on the way comes from its beginning, by about half of it at its end.
  const double from = lattice.at({140.0, 128.0}).position.x();
  EXPECT_LT(from, 130.0);
  EXPECT_GT(from, 100.0);
  EXPECT_NEAR(lattice.at({140.0, 128.0}).position.y(), 128.0, 1e-6);
  EXPECT_GE(least_area(lattice).determinant, 0.01);
}

TEST(WarpBrush, PinchScalesTheCentre) {
  for (const float strength : {1.0F, 0.3F, -1.0F, 2.0F}) {
    WarpLattice lattice(canvas, 2.0F);
    pinch(lattice, {128.0F, 128.0F}, {.radius = 90.0F, .strength = strength});
    const WarpPoint p = lattice.at({128.0, 128.0});
    EXPECT_LT((p.position - Vec2d(128.0, 128.0)).norm(), 1e-9);
    // A picture of half the size steps through the source twice as fast.
    EXPECT_NEAR(p.jacobian(0, 0), std::exp2(static_cast<double>(strength)), 1e-6);
    EXPECT_NEAR(p.jacobian(1, 1), std::exp2(static_cast<double>(strength)), 1e-6);
  }
}

TEST(WarpBrush, TwirlTurnsCounterClockwiseAndKeepsAreas) {
  WarpLattice lattice(canvas, 2.0F);
  twirl(lattice, {128.0F, 128.0F}, {.radius = 100.0F, .strength = 1.0F});
  // What was to the right of the centre is above it now (y down).
  const Vec2d above = lattice.at({128.0, 126.0}).position;
  EXPECT_NEAR(above.x(), 130.0, 0.02);
  EXPECT_NEAR(above.y(), 128.0, 0.02);
  for (const Vec2d& p : {Vec2d(128, 128), Vec2d(150, 110), Vec2d(77.3, 150.1)}) {
    EXPECT_NEAR(lattice.at(p).jacobian.determinant(), 1.0, 1e-3);
  }
  WarpLattice back = lattice;
  twirl(back, {128.0F, 128.0F}, {.radius = 100.0F, .strength = -1.0F});
  EXPECT_LT((back.at({140.0, 111.0}).position - Vec2d(140.0, 111.0)).norm(), 1e-3);
}

TEST(WarpBrush, ChangesNothingOutsideItsRectangle) {
  WarpLattice lattice(canvas);
  const WarpDab dab = twirl(lattice, {100.0F, 120.0F}, {.radius = 40.0F, .strength = 2.0F});
  EXPECT_GE(dab.changed.x0, 100 - 40 - 9);
  EXPECT_LE(dab.changed.x1, 100 + 40 + 10);
  for (int y = 0; y < 256; ++y) {
    for (int x = 0; x < 256; ++x) {
      if (dab.changed.contains(x, y)) continue;
      ASSERT_EQ(lattice.at(Vec2d(x, y)).position, Vec2d(x, y));
    }
  }
}

TEST(WarpBrush, NeutralValuesLeaveTheLattice) {
  WarpLattice lattice(canvas);
  twirl(lattice, {100.0F, 120.0F}, {.radius = 40.0F, .strength = 0.7F});
  const WarpLattice before = lattice;
  const Vec2f p(110.0F, 118.0F);
  EXPECT_TRUE(twirl(lattice, p, {.radius = 40.0F, .strength = 0.0F}).changed.empty());
  EXPECT_TRUE(pinch(lattice, p, {.radius = 0.0F}).changed.empty());
  EXPECT_TRUE(push(lattice, p, p, {.radius = 40.0F}).changed.empty());
  EXPECT_TRUE(grab(lattice, p, p, {.radius = 40.0F}).changed.empty());
  EXPECT_TRUE(same_nodes(before, lattice));
}

TEST(WarpBrush, LimitsItsStrengthBeforeThePictureFolds) {
  WarpLattice lattice(canvas);
  const Vec2f p(128.0F, 128.0F);
  const WarpBrushOptions inflate{.radius = 60.0F, .strength = -2.0F, .least_area = 0.05F};
  EXPECT_EQ(pinch(lattice, p, inflate).strength, -2.0F);  // 16 times the area: 1 / 16
  const WarpDab again = pinch(lattice, p, inflate);
  EXPECT_GT(again.strength, -2.0F);
  EXPECT_LE(again.strength, 0.0F);
  EXPECT_GE(least_area(lattice).determinant, 0.05);
}

// What was tried in vain leaves no trace, across the seam either.
TEST(WarpBrush, LessStrengthIsAsIfAskedFor) {
  for (const LatticeEdge edge : {LatticeEdge::Continue, LatticeEdge::Repeat}) {
    for (const bool grabs : {false, true}) {
      WarpLattice limited({0, 0, 160, 144}, 4.0F, edge);
      const Vec2f p(20.0F, 130.0F);
      const WarpBrushOptions inflate{.radius = 60.0F, .strength = -1.8F, .least_area = 0.05F};
      pinch(limited, p, inflate);
      WarpLattice asked = limited;
      const Vec2f to(60.0F, 115.0F);
      WarpBrushOptions o = inflate;
      o.strength = grabs ? 4.0F : -1.8F;
      const auto brush = [&](WarpLattice& lattice) {
        return grabs ? grab(lattice, p, to, o) : pinch(lattice, p, o);
      };
      const WarpDab dab = brush(limited);
      ASSERT_NE(dab.strength, 0.0F);
      ASSERT_LT(std::abs(dab.strength), std::abs(o.strength));
      EXPECT_FALSE(same_nodes(limited, asked));
      o.strength = dab.strength;
      EXPECT_EQ(brush(asked).strength, dab.strength);
      EXPECT_TRUE(same_nodes(limited, asked));
    }
  }
}

TEST(WarpBrush, RefusesAFoldAndNamesThePlace) {
  WarpLattice lattice(canvas);
  WarpBrushOptions inflate{.radius = 60.0F, .strength = -2.0F, .least_area = 0.05F};
  inflate.on_fold = OnFold::Refuse;
  pinch(lattice, {128.0F, 100.0F}, inflate);
  const WarpLattice before = lattice;
  try {
    pinch(lattice, {128.0F, 100.0F}, inflate);
    FAIL() << "nothing thrown";
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("(128, 100)"), std::string::npos) << error.what();
  }
  EXPECT_TRUE(same_nodes(before, lattice));
}

TEST(WarpBrush, CrossesTheSeamOfALatticeThatRepeats) {
  WarpLattice middle({0, 0, 128, 96}, 4.0F, LatticeEdge::Repeat);
  WarpLattice corner({0, 0, 128, 96}, 4.0F, LatticeEdge::Repeat);
  const WarpBrushOptions o{.radius = 48.0F, .strength = 0.8F};
  twirl(middle, {64.0F, 48.0F}, o);
  const WarpDab dab = twirl(corner, {0.0F, 96.0F}, o);
  EXPECT_EQ(dab.changed, corner.area());
  push(middle, {64.0F, 48.0F}, {94.0F, 58.0F}, o);
  push(corner, {128.0F, 0.0F}, {158.0F, 10.0F}, o);
  for (const Vec2d& p : {Vec2d(64, 48), Vec2d(80.3, 30.1), Vec2d(95, 70), Vec2d(30, 50)}) {
    const Vec2d shift(64, 48);
    const Vec2d moved = middle.at(p).position - p;
    EXPECT_LT((corner.at(p + shift).position - p - shift - moved).norm(), 1e-9);
  }
}

TEST(WarpBrush, RejectsBadInput) {
  WarpLattice lattice(canvas);
  const Vec2f p(128.0F, 128.0F);
  const Vec2f nowhere(nan, 0.0F);
  EXPECT_THROW(twirl(lattice, nowhere, {}), InvalidInput);
  EXPECT_THROW(grab(lattice, p, nowhere, {}), InvalidInput);
  EXPECT_THROW(push(lattice, p, nowhere, {}), InvalidInput);
  EXPECT_THROW(pinch(lattice, p, {.radius = nan}), InvalidInput);
  EXPECT_THROW(pinch(lattice, p, {.radius = -1.0F}), InvalidInput);
  EXPECT_THROW(pinch(lattice, p, {.radius = 3.0F}), InvalidInput);  // less than two cells
  EXPECT_THROW(pinch(lattice, p, {.strength = nan}), InvalidInput);
  EXPECT_THROW(pinch(lattice, p, {.least_area = nan}), InvalidInput);
  EXPECT_THROW(pinch(lattice, p, {.least_area = 0.0F}), InvalidInput);
  WarpLattice tile({0, 0, 64, 64}, 4.0F, LatticeEdge::Repeat);
  EXPECT_THROW(pinch(tile, p, {.radius = 40.0F}), InvalidInput);
  EXPECT_TRUE(same_nodes(lattice, WarpLattice(canvas)));
}

}  // namespace
}  // namespace normalshop::test
