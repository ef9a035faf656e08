#include <limits>
#include <numbers>

#include "style_checks.h"
#include <gtest/gtest.h>

#include "normalshop/core/error.h"
#include "normalshop/rgbn/shade_lambert.h"

namespace normalshop::test {
namespace {

using std::numbers::pi_v;

TEST(ShadeLambert, AddsLightsAndAmbient) {
  const Vec3f n = Vec3f(0.2F, 0.3F, 0.9F).normalized();
  const Image<Vec3f> normals(1, 1, n);
  const ColorImage albedo(1, 1, Vec3f(0.5F, 0.25F, 1.0F));
  LambertOptions options;
  options.lights = {{{0.0F, 0.0F, 3.0F}, {pi_v<float>, 0.0F, 0.0F}},
                    {{0.0F, 1.0F, 0.0F}, {0.0F, 2.0F * pi_v<float>, 0.0F}},
                    {{0.0F, 0.0F, -1.0F}, {9.0F, 9.0F, 9.0F}}};  // behind
  options.ambient = {0.1F, 0.1F, 0.1F};
  ColorImage out(1, 1);
  shade_lambert(normals, albedo, out, out.rect(), options);
  const Vec3f expected(0.5F * (0.1F + n.z()), 0.25F * (0.1F + 2.0F * n.y()), 0.1F);
  EXPECT_LT((out(0, 0) - expected).norm(), 1e-6F);
}

TEST(ShadeLambert, ALightOfPiShowsTheAlbedoOfWhatFacesIt) {
  const Image<Vec3f> normals(1, 1, Vec3f(0.0F, 0.0F, 1.0F));
  LambertOptions options;
  options.lights = {{{0.0F, 0.0F, 1.0F}, {pi_v<float>, pi_v<float>, pi_v<float>}}};
  ColorImage out(1, 1);
  shade_lambert(normals, {}, out, out.rect(), options);
  EXPECT_NEAR(out(0, 0).x(), 1.0F, 1e-6F);
  options.lights.clear();
  shade_lambert(normals, {}, out, out.rect(), options);
  EXPECT_EQ(out(0, 0), Vec3f(Vec3f::Zero()));
}

TEST(ShadeLambert, RegionsThreadsEdgesAndGaps) {
  const auto draw = [](ImageView<Vec3f> normals, ColorSpan target, Rect region) {
    return shade_lambert(normals, {}, target, region);
  };
  const Vec3f background(0.1F, 0.2F, 7.0F);
  expect_a_style(background, std::optional(background), draw);
}

TEST(ShadeLambert, RejectsLightsThatAreNone) {
  const Image<Vec3f> normals(1, 1, Vec3f(0.0F, 0.0F, 1.0F));
  ColorImage out(1, 1);
  LambertOptions options;
  options.lights = {{{0.0F, 0.0F, 0.0F}, {1.0F, 1.0F, 1.0F}}};
  EXPECT_THROW(shade_lambert(normals, {}, out, out.rect(), options), InvalidInput);
  options.lights[0].direction = {0.0F, std::numeric_limits<float>::infinity(), 0.0F};
  EXPECT_THROW(shade_lambert(normals, {}, out, out.rect(), options), InvalidInput);
  options.lights.clear();
  options.ambient.x() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(shade_lambert(normals, {}, out, out.rect(), options), InvalidInput);
}

}  // namespace
}  // namespace normalshop::test
