#include <cmath>

#include "chart_fixtures.h"
#include "support/meshes.h"
#include <gtest/gtest.h>

#include "normalshop/chart/depth_steps.h"
#include "normalshop/core/sample.h"

namespace normalshop {
namespace {

using namespace test;

constexpr float radians_per_degree = 3.14159265F / 180.0F;

TEST(Effective, weight_falls_with_the_angle) {
  const Mesh mesh = hemisphere(64, 128);
  const StorageAtlas storage = storage_of(mesh, flat_normal_map(64, 64, CodeType::U8));
  const EditingChart chart = chart_from(mesh, storage, {0, 0, 1}, 256);
  const float low = std::cos(75 * radians_per_degree);
  const float high = std::cos(60 * radians_per_degree);
  for (int y = 0; y < chart.grid.height(); ++y) {
    for (int x = 0; x < chart.grid.width(); ++x) {
      const float z = chart.base_normal(x, y).z();
      ASSERT_NEAR(chart.weight(x, y), smoothstep(low, high, z), 1e-5F) << "no step on a sphere";
    }
  }
}

/// Two plates facing +z, the nearer one over the middle of the other.
Mesh plates(float gap) {
  MeshBuilder builder;
  const auto plate = [&](float low, float high, float z, const Vec2f& uv, float scale) {
    const auto corner = [&](float x, float y) {
      return MeshBuilder::Corner{
          {x, y, z}, {0, 0, 1}, uv + scale * Vec2f(x - low, high - y) / (high - low)};
    };
    builder.quad(corner(low, low), corner(high, low), corner(high, high), corner(low, high));
  };
  plate(0.0F, 1.0F, 0.0F, {0.02F, 0.02F}, 0.6F);
  plate(0.3F, 0.7F, gap, {0.7F, 0.7F}, 0.25F);
  return builder.finish();
}

TEST(Effective, weight_falls_towards_depth_steps) {
  const Mesh mesh = plates(0.2F);
  const StorageAtlas storage = storage_of(mesh, flat_normal_map(64, 64, CodeType::U8));
  EffectiveOptions options;
  options.step_falloff = 0.05F;
  const EditingChart chart = chart_from(mesh, storage, {0, 0, 1}, 200, options);
  const auto weight_at = [&](float x, float y) {
    const Vec2f p = chart.grid.to_pixel({x - 0.5F, y - 0.5F});
    return chart.weight(static_cast<int>(std::lround(p.x())), static_cast<int>(std::lround(p.y())));
  };
  EXPECT_EQ(weight_at(0.3F, 0.5F), 0.0F) << "on the step";
  EXPECT_NEAR(weight_at(0.3F - 0.028F, 0.5F), 0.4F, 0.25F) << "half way";
  EXPECT_NEAR(weight_at(0.3F + 0.028F, 0.5F), 0.4F, 0.25F) << "on both sides";
  EXPECT_EQ(weight_at(0.3F - 0.065F, 0.5F), 1.0F);
  EXPECT_EQ(weight_at(0.5F, 0.5F), 1.0F);
  EXPECT_EQ(weight_at(0.002F, 0.5F), 1.0F) << "an open rim is no step";
}

TEST(Effective, touching_surfaces_are_no_step) {
  const Mesh mesh = plates(0.004F);  // less than a pixel
  const StorageAtlas storage = storage_of(mesh, flat_normal_map(64, 64, CodeType::U8));
  const EditingChart chart = chart_from(mesh, storage, {0, 0, 1}, 200);
  Image<std::uint8_t> steps;
  find_depth_steps(chart, 0.0F, steps);
  EXPECT_EQ(std::count(steps.data(), steps.data() + steps.size(), 1), 0);
}

}  // namespace
}  // namespace normalshop
