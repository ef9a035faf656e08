#include <cmath>

#include <gtest/gtest.h>

#include "normalshop/core/error.h"
#include "normalshop/rgbn/profile.h"

namespace normalshop::test {
namespace {

const Curve uneven(std::vector<Vec2f>{{-1.0F, 0.5F}, {-0.2F, 1.0F}, {0.4F, -0.3F}, {1.0F, 2.0F}});

std::vector<Profile> all_profiles() {
  std::vector<Profile> all;
  for (const auto shape : {ProfileShape::Bump, ProfileShape::Crease, ProfileShape::Scratch}) {
    all.emplace_back(Profile::Options{shape, false, {}});
    all.emplace_back(Profile::Options{shape, true, {}});
  }
  all.emplace_back(Profile::Options{ProfileShape::Step, true, {}});
  all.emplace_back(Profile::Options{ProfileShape::Custom, false, uneven});
  all.emplace_back(Profile::Options{ProfileShape::Custom, true, uneven});
  return all;
}

TEST(Profile, SlopeIsTheDerivativeOfTheHeight) {
  for (const Profile& p : all_profiles()) {
    for (float u = -0.995F; u < 1.0F; u += 0.0137F) {
      const float numeric = (p.at(u + 1e-3F).height - p.at(u - 1e-3F).height) / 2e-3F;
      EXPECT_NEAR(p.at(u).slope, numeric, 0.02F) << u;
    }
  }
}

TEST(Profile, StartsAtZeroAndEndsAtTheLevel) {
  for (const Profile& p : all_profiles()) {
    EXPECT_NEAR(p.at(-1.0F + 1e-6F).height, 0.0F, 1e-5F);
    EXPECT_NEAR(p.at(1.0F - 1e-6F).height, p.level(), 1e-5F);
    EXPECT_NEAR(p.at(-1.0F + 1e-6F).slope, 0.0F, 1e-4F);
    EXPECT_NEAR(p.at(1.0F - 1e-6F).slope, 0.0F, 1e-4F);
    EXPECT_EQ(p.at(5.0F).height, p.level());
  }
  EXPECT_EQ(Profile({ProfileShape::Custom, false, uneven}).level(), 0.0F);
  EXPECT_FLOAT_EQ(Profile({ProfileShape::Custom, true, uneven}).level(), 1.5F);
  EXPECT_EQ(Profile({ProfileShape::Step, true, {}}).level(), 1.0F);
}

TEST(Profile, ExtremesAreOne) {
  EXPECT_FLOAT_EQ(Profile({ProfileShape::Bump, false, {}}).at(0.0F).height, 1.0F);
  EXPECT_FLOAT_EQ(Profile({ProfileShape::Crease, false, {}}).at(0.0F).height, -1.0F);
  EXPECT_FLOAT_EQ(Profile({ProfileShape::Scratch, false, {}}).at(0.0F).height, -1.0F);
}

TEST(Profile, RejectsWhatWouldBreakTheSurface) {
  EXPECT_THROW(Profile({ProfileShape::Step, false, {}}), InvalidInput);
  EXPECT_THROW(Profile({ProfileShape::Custom, false, {}}), InvalidInput);
  EXPECT_THROW(Profile({ProfileShape::Custom, false, Curve({{-2.0F, 0.0F}, {1.0F, 1.0F}})}),
               InvalidInput);
}

}  // namespace
}  // namespace normalshop::test
