#include <cmath>

#include <gtest/gtest.h>

#include "normalshop/core/error.h"
#include "normalshop/rgbn/emboss.h"

namespace normalshop::test {
namespace {

/// A square letter with a square hole, wound the other way round.
const Outline letter = {{{0.0F, 0.0F}, {1.0F, 0.0F}, {1.0F, 1.0F}, {0.0F, 1.0F}},
                        {{0.35F, 0.35F}, {0.35F, 0.65F}, {0.65F, 0.65F}, {0.65F, 0.35F}}};

EmbossOptions options_of(float size, float height, float bevel) {
  EmbossOptions o;
  o.size = size;
  o.height = height;
  o.bevel = bevel;
  return o;
}

TEST(Emboss, RisesByItsHeightAndKeepsHolesOpen) {
  SlopeImage slopes(200, 200);
  MaskImage coverage(200, 200);
  emboss(slopes, coverage, slopes.rect(), letter, {50.2F, 149.7F}, options_of(100.0F, 5.0F, 8.0F));
  double rise = 0.0;
  for (int x = 0; x < 67; ++x) rise += static_cast<double>(slopes(x, 100).x());
  EXPECT_NEAR(rise, 5.0, 0.02);  // on the letter
  for (int x = 67; x < 100; ++x) rise += static_cast<double>(slopes(x, 100).x());
  EXPECT_NEAR(rise, 0.0, 0.02);  // in its hole
  double up = 0.0;
  for (int y = 199; y > 133; --y) up += static_cast<double>(slopes(100, y).y());
  EXPECT_NEAR(up, 5.0, 0.02);
  EXPECT_EQ(coverage(67, 100), 1.0F);
  EXPECT_EQ(coverage(100, 100), 0.0F);
  EXPECT_EQ(slopes(67, 100), Vec2f(0.0F, 0.0F));
}

TEST(Emboss, ReversedContoursGiveTheSame) {
  Outline reversed = letter;
  for (auto& contour : reversed) std::reverse(contour.begin(), contour.end());
  SlopeImage a(120, 120);
  SlopeImage b(120, 120);
  const EmbossOptions o = options_of(80.0F, 3.0F, 6.0F);
  emboss(a, {}, a.rect(), letter, {20.3F, 100.1F}, o);
  emboss(b, {}, b.rect(), reversed, {20.3F, 100.1F}, o);
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 120; ++x) EXPECT_LT((a(x, y) - b(x, y)).norm(), 1e-4F);
  }
}

TEST(Emboss, BoundsAndReachHoldEverything) {
  EmbossOptions o = options_of(60.0F, 3.0F, 6.0F);
  o.rotation = 30.0F;
  o.shear = 0.3F;
  o.scale_x = 1.5F;
  const Outline middle = centered(letter);
  SlopeImage slopes(300, 300);
  const Rect changed = emboss(slopes, {}, slopes.rect(), middle, {150.0F, 150.0F}, o);
  const int r = reach(o, middle);
  EXPECT_LT(changed.width(), 200);
  for (int y = 0; y < 300; ++y) {
    for (int x = 0; x < 300; ++x) {
      if (slopes(x, y).isZero(0.0F)) continue;
      EXPECT_TRUE(changed.contains(x, y));
      EXPECT_LE(std::max(std::abs(x - 150), std::abs(y - 150)), r);
    }
  }
}

TEST(Emboss, LimitsAndBadInput) {
  SlopeImage slopes(20, 20);
  EXPECT_TRUE(emboss(slopes, {}, slopes.rect(), letter, {5.0F, 5.0F}, options_of(0.0F, 1.0F, 1.0F))
                  .empty());
  EXPECT_EQ(slopes(5, 5), Vec2f(0.0F, 0.0F));
  EXPECT_THROW(emboss(slopes, {}, slopes.rect(), {{{0.0F, 0.0F}}}, {5.0F, 5.0F}), InvalidInput);
}

}  // namespace
}  // namespace normalshop::test
