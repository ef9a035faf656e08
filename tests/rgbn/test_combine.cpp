#include <cmath>
#include <limits>

#include "combine_fixtures.h"
#include <gtest/gtest.h>

#include "normalshop/core/error.h"
#include "normalshop/core/parallel.h"
#include "normalshop/rgbn/combine.h"
#include "normalshop/rgbn/curl.h"

namespace normalshop::test {
namespace {

TEST(Combine, AddsDetailsByStrengthAndMask) {
  const SlopeImage base(7, 5, Vec2f(0.5F, -1.0F));
  const SlopeImage details(7, 5, Vec2f(0.25F, 4.0F));
  MaskImage mask(7, 5, 0.5F);
  mask(3, 2) = 0.0F;
  SlopeImage target(7, 5, Vec2f::Constant(9.0F));
  EXPECT_EQ(combine_linear(base, details, mask, 2.0F, target, {1, 1, 99, 4}), (Rect{1, 1, 7, 4}));
  EXPECT_EQ(target(1, 1), Vec2f(0.75F, 3.0F));
  EXPECT_EQ(target(3, 2), base(3, 2));
  EXPECT_EQ(target(0, 0), Vec2f(9.0F, 9.0F));
}

TEST(Combine, WorksInPlaceWithoutMask) {
  SlopeImage target(3, 3, Vec2f(1.0F, 1.0F));
  const SlopeImage details(3, 3, Vec2f(-1.0F, 1.0F));
  combine_linear(target, details, {}, 1.0F, target, target.rect());
  EXPECT_EQ(target(2, 2), Vec2f(0.0F, 2.0F));
  EXPECT_TRUE(combine_linear(target, details, {}, 1.0F, target, {5, 5, 9, 9}).empty());
}

TEST(CombineModels, LinearIsCombineLinear) {
  const SlopeImage base = random_slopes(30, 20, 1);
  const SlopeImage details = random_slopes(30, 20, 2);
  const MaskImage mask(30, 20, 0.3F);
  SlopeImage a(30, 20);
  SlopeImage b(30, 20);
  combine(base, details, mask, a, a.rect(), {.strength = -0.7F});
  combine_linear(base, details, mask, -0.7F, b, b.rect());
  EXPECT_TRUE(same(a, b));
}

TEST(CombineModels, LinearAddsHeights) {
  const auto bumps = [](int x, int y) {
    return 6.0 * std::exp(-((x - 40) * (x - 40) + (y - 30) * (y - 30)) / 200.0);
  };
  const SlopeImage base = slopes_of(80, 60, hills);
  const SlopeImage details = slopes_of(80, 60, bumps);
  const SlopeImage sum =
      slopes_of(80, 60, [&](int x, int y) { return hills(x, y) - 0.5 * bumps(x, y); });
  SlopeImage out(80, 60);
  combine(base, details, {}, out, out.rect(), {.strength = -0.5F});
  EXPECT_LT(largest_difference(out, sum), 5e-7);
  EXPECT_LT(curl_share(out, {}), 1e-10);
  // Only the linear model keeps to heights.
  combine(base, details, {}, out, out.rect(), {.model = CombineModel::Rotation});
  EXPECT_GT(curl_share(out, {}), 1e-5);
}

TEST(CombineModels, NoStrengthAndNoMaskLeaveTheBaseBitForBit) {
  SlopeImage base = random_slopes(30, 20, 1, 500.0F);
  base(3, 4) = {-0.0F, 0.0F};
  const SlopeImage details = random_slopes(30, 20, 2);
  const MaskImage none(30, 20, 0.0F);
  for (const CombineModel model : all_models) {
    for (const float strength : {0.0F, 1.0F}) {
      SlopeImage target(30, 20);
      combine(base, details, none, target, target.rect(), {.model = model, .strength = strength});
      EXPECT_TRUE(same(target, base)) << name_of(model);
      EXPECT_TRUE(std::signbit(target(3, 4).x()));
      target.fill(Vec2f::Zero());
      combine(base, details, {}, target, target.rect(), {.model = model, .strength = 0.0F});
      EXPECT_TRUE(same(target, base)) << name_of(model);
    }
  }
}

TEST(CombineModels, FlatDetailsLeaveTheBaseBitForBitButOverlaid) {
  const SlopeImage base = random_slopes(30, 20, 1, 500.0F);
  const SlopeImage flat(30, 20, Vec2f::Zero());
  for (const CombineModel model : all_models) {
    SlopeImage target(30, 20);
    combine(base, flat, {}, target, target.rect(), {.model = model});
    EXPECT_EQ(same(target, base), model != CombineModel::Overlay) << name_of(model);
  }
}

TEST(CombineModels, OnAFlatBaseTheDetailsAreWhatComesOut) {
  for (const CombineModel model : {CombineModel::Linear, CombineModel::Rotation,
                                   CombineModel::Reoriented, CombineModel::Whiteout}) {
    for (const double tilt : {0.01, 1.0, 30.0, 80.0}) {
      const Vec2f details = tilted_slope(tilt, 200.0);
      const Vec2f out = combined(Vec2f::Zero(), details, model);
      EXPECT_LT(degrees_between(normal(out), normal(details)), 1e-5) << name_of(model) << tilt;
    }
  }
}

TEST(CombineModels, TheMaskScalesTheDetails) {
  const SlopeImage base = random_slopes(20, 20, 1, 2.0F);
  const SlopeImage details = random_slopes(20, 20, 2, 2.0F);
  SlopeImage half(20, 20);
  for (int y = 0; y < 20; ++y) {
    for (int x = 0; x < 20; ++x) half(x, y) = 0.5F * details(x, y);
  }
  const MaskImage mask(20, 20, 0.25F);
  for (const CombineModel model : all_models) {
    if (model == CombineModel::Overlay) continue;
    SlopeImage a(20, 20);
    SlopeImage b(20, 20);
    combine(base, details, mask, a, a.rect(), {.model = model, .strength = 2.0F});
    combine(base, half, {}, b, b.rect(), {.model = model});
    EXPECT_TRUE(same(a, b)) << name_of(model);
  }
}

TEST(CombineModels, TheOrderMattersToAllButLinear) {
  const Vec2f a = tilted_slope(35.0, 10.0);
  const Vec2f b = tilted_slope(30.0, 130.0);
  const Vec2f c = tilted_slope(25.0, 250.0);
  const auto linear = [](const Vec2f& t, const Vec2f& u) {
    return combined(t, u, CombineModel::Linear);
  };
  EXPECT_EQ(linear(a, b), linear(b, a));
  EXPECT_LT((linear(linear(a, b), c) - linear(a, linear(b, c))).norm(), 2e-7F);
  EXPECT_GT(degrees_between(normal(rnm(a, b)), normal(rnm(b, a))), 4.0);
  EXPECT_GT(degrees_between(normal(rnm(rnm(a, b), c)), normal(rnm(a, rnm(b, c)))), 1.0);
}

/// Mean angle over all azimuths between a tilted base and 10 degrees of detail on it.
double kept_tilt(double base_tilt, CombineModel model) {
  const Vec2f base = tilted_slope(base_tilt, 20.0);
  double sum = 0.0;
  for (int k = 0; k < 360; ++k) {
    sum += degrees_between(normal(combined(base, tilted_slope(10.0, k), model)), normal(base));
  }
  return sum / 360.0;
}

TEST(CombineModels, KeepTheTiltOfDetailsOnATiltedBase) {
  struct Row {
    double tilt, linear, whiteout, udn, turned;
  };
  for (const Row& row : {Row{0.0, 10.0, 10.0, 9.9, 10.0}, Row{30.0, 8.1, 9.3, 9.2, 10.0},
                         Row{45.0, 6.1, 8.6, 8.5, 10.0}, Row{60.0, 3.9, 7.7, 7.7, 10.0}}) {
    EXPECT_NEAR(kept_tilt(row.tilt, CombineModel::Linear), row.linear, 0.06) << row.tilt;
    EXPECT_NEAR(kept_tilt(row.tilt, CombineModel::Whiteout), row.whiteout, 0.06) << row.tilt;
    EXPECT_NEAR(kept_tilt(row.tilt, CombineModel::Udn), row.udn, 0.06) << row.tilt;
    EXPECT_NEAR(kept_tilt(row.tilt, CombineModel::Reoriented), row.turned, 1e-4) << row.tilt;
    EXPECT_NEAR(kept_tilt(row.tilt, CombineModel::Rotation), row.turned, 1e-4) << row.tilt;
  }
}

TEST(CombineModels, OverlayIsThatOfColours) {
  const auto code = [](double n) { return 0.5 * n + 0.5; };
  const Vec3d t = normal(tilted_slope(50.0, 30.0));
  const Vec3d u = normal(tilted_slope(35.0, 140.0));
  Vec3d expected;
  for (Eigen::Index k = 0; k < 3; ++k) {
    const double b = code(t[k]);
    const double d = code(u[k]);
    expected[k] = 2.0 * (b < 0.5 ? 2.0 * b * d : 1.0 - 2.0 * (1.0 - b) * (1.0 - d)) - 1.0;
  }
  const Vec2f out =
      combined(tilted_slope(50.0, 30.0), tilted_slope(35.0, 140.0), CombineModel::Overlay);
  EXPECT_LT(degrees_between(normal(out), expected.normalized()), 1e-4);
}

TEST(CombineModels, NothingPointsBelowTheHorizon) {
  const SlopeImage base = random_slopes(80, 80, 1, 49.0F);
  const SlopeImage details = random_slopes(80, 80, 2, 49.0F);
  for (const CombineModel model : all_models) {
    if (model == CombineModel::Linear) continue;
    SlopeImage out(80, 80);
    combine(base, details, {}, out, out.rect(), {.model = model});
    for (const Vec2f& slope : {out(0, 0), out(17, 50), out(79, 79)}) EXPECT_TRUE(slope.allFinite());
    for (std::size_t i = 0; i < out.size(); ++i) {
      ASSERT_LE(out.data()[i].norm(), 50.001F) << name_of(model);
    }
  }
}

TEST(CombineModels, ARegionGivesThePixelsOfTheWholeForAnyNumberOfThreads) {
  const SlopeImage base = random_slopes(120, 90, 1);
  const SlopeImage details = random_slopes(120, 90, 2);
  MaskImage mask(120, 90);
  for (std::size_t i = 0; i < mask.size(); ++i)
    mask.data()[i] = std::abs(base.data()[i].x()) / 45.0F;
  const Rect region = {31, 22, 70, 81};
  for (const CombineModel model : all_models) {
    SlopeImage whole(120, 90);
    combine(base, details, mask, whole, whole.rect(), {.model = model});
    SlopeImage part = base;
    const ThreadLimit limit(1);
    EXPECT_EQ(combine(part, details, mask, part, region, {.model = model}), region);  // in place
    for (int y = 0; y < 90; ++y) {
      for (int x = 0; x < 120; ++x) {
        ASSERT_EQ(part(x, y), region.contains(x, y) ? whole(x, y) : base(x, y)) << name_of(model);
      }
    }
  }
}

TEST(CombineModels, WhatIsNoNumberStaysInItsPixel) {
  const SlopeImage clean_base = random_slopes(9, 7, 1);
  const SlopeImage clean_details = random_slopes(9, 7, 2);
  SlopeImage base = clean_base;
  SlopeImage details = clean_details;
  MaskImage mask(9, 7, 1.0F);
  base(2, 3) = {nan, 1.0F};
  details(5, 1) = {1.0F, std::numeric_limits<float>::infinity()};
  details(7, 4) = {nan, nan};
  details(4, 4) = {nan, nan};
  mask(4, 4) = 0.0F;
  for (const CombineModel model : all_models) {
    SlopeImage whole(9, 7);
    combine(clean_base, clean_details, mask, whole, whole.rect(), {.model = model});
    SlopeImage out(9, 7);
    combine(base, details, mask, out, out.rect(), {.model = model});
    for (const Vec2i& hole : {Vec2i(2, 3), Vec2i(5, 1), Vec2i(7, 4)}) {
      EXPECT_FALSE(out(hole.x(), hole.y()).allFinite()) << name_of(model);
      out(hole.x(), hole.y()) = whole(hole.x(), hole.y());
    }
    EXPECT_TRUE(same(out, whole)) << name_of(model);  // (4, 4) too, where nothing is laid
  }
}

TEST(CombineModels, RejectAStrengthThatIsNoNumber) {
  SlopeImage image(2, 2, Vec2f::Zero());
  for (const CombineModel model : all_models) {
    for (const float strength : {nan, std::numeric_limits<float>::infinity()}) {
      EXPECT_THROW(
          combine(image, image, {}, image, image.rect(), {.model = model, .strength = strength}),
          InvalidInput);
    }
    EXPECT_TRUE(combine({}, {}, {}, {}, {0, 0, 5, 5}, {.model = model}).empty());
  }
}

}  // namespace
}  // namespace normalshop::test
