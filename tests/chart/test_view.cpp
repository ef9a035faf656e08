#include <cmath>
#include <limits>

#include "chart_fixtures.h"
#include "support/meshes.h"
#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "normalshop/chart/extend.h"
#include "normalshop/chart/resolution.h"
#include "normalshop/core/error.h"

namespace normalshop {
namespace {

using namespace test;

void expect_frame(const View& view) {
  Mat3f m;
  m << view.right, view.up, view.direction;
  EXPECT_LT((m.transpose() * m - Mat3f::Identity()).norm(), 1e-5F);
  EXPECT_NEAR(m.determinant(), 1.0F, 1e-5F);
}

TEST(View, named_views_look_from_their_side) {
  const Mesh mesh = cube();
  const std::array<Vec3f, 6> rights{Vec3f(1, 0, 0),  Vec3f(-1, 0, 0), Vec3f(0, 0, 1),
                                    Vec3f(0, 0, -1), Vec3f(1, 0, 0),  Vec3f(1, 0, 0)};
  for (int i = 0; i < 6; ++i) {
    const View view = named_view(mesh, static_cast<NamedView>(i));
    expect_frame(view);
    EXPECT_LT((view.right - rights[static_cast<std::size_t>(i)]).norm(), 1e-6F) << i;
    EXPECT_NEAR(view.width, 2.0F * 1.04F, 1e-4F);
    EXPECT_LT(view.center.norm(), 1e-5F);
  }
}

TEST(View, any_up_makes_a_frame) {
  for (const Vec3f& up : {Vec3f(0, 1, 0), Vec3f(0, 0, 0), Vec3f(0, 0, -3), Vec3f(1e-8F, 0, 1)}) {
    expect_frame(make_view({0, 0, 1}, up, {0, 0, 0}, 1, 1));
    expect_frame(make_view({0, 5, 0}, up, {0, 0, 0}, 1, 1));
  }
}

TEST(View, bad_numbers_are_refused) {
  const Vec3f ok(0, 0, 1);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(make_view({0, 0, 0}, ok, ok, 1, 1), InvalidInput);
  EXPECT_THROW(make_view({nan, 0, 0}, ok, ok, 1, 1), InvalidInput);
  EXPECT_THROW(make_view(ok, {nan, 0, 0}, ok, 1, 1), InvalidInput);
  EXPECT_THROW(make_view(ok, ok, {nan, 0, 0}, 1, 1), InvalidInput);
  EXPECT_THROW(make_view(ok, ok, ok, 0, 1), InvalidInput);
  EXPECT_THROW(make_view(ok, ok, ok, 1, nan), InvalidInput);
  EXPECT_THROW(named_view(Mesh(), NamedView::Front), InvalidInput);
  EXPECT_THROW(facing_view(Mesh(), ok, 1, 1), InvalidInput);
  EXPECT_THROW(facing_view(cube(), {nan, 0, 0}, 1, 1), InvalidInput);
}

TEST(View, facing_looks_along_the_base_normal) {
  const Mesh mesh = uv_sphere(96, 48);
  const Vec3f toward = Vec3f(0.3F, 0.5F, -0.7F).normalized();
  const View view = facing_view(mesh, 3.0F * toward, 0.5F, 0.4F);
  expect_frame(view);
  EXPECT_LT(angle_degrees(view.direction, toward), 1.9);
  EXPECT_LT((view.center - toward).norm(), 0.03F);
}

TEST(Grid, pixels_and_units_are_inverse) {
  const View view = make_view({0.2F, 0.1F, 1}, {0, 1, 0}, {3, -2, 1}, 2.0F, 1.5F);
  const ChartGrid grid = make_grid(view, 0.01F, {-0.3F, -0.2F}, {0.5F, 0.1F});
  EXPECT_LT((grid.to_pixel(grid.to_units({17.25F, 3.5F})) - Vec2f(17.25F, 3.5F)).norm(), 1e-4F);
  const Vec2f low = grid.to_pixel({-0.3F, -0.2F});
  EXPECT_GE(low.x(), -0.5F);
  EXPECT_LE(low.y(), static_cast<float>(grid.height()) - 0.5F + 1e-3F);
  const Vec3f p = grid.project(view.center + view.to_object({0.1F, 0.05F, 0.7F}));
  EXPECT_LT((grid.to_units(p.head<2>()) - Vec2f(0.1F, 0.05F)).norm(), 1e-5F);
  EXPECT_NEAR(p.z(), 0.7F, 1e-5F);
  EXPECT_EQ(make_grid(view, 1e-4F).width(), make_grid(view, 1e-6F).width()) << "capped";
  EXPECT_LE(make_grid(view, 1e-6F).width(), max_chart_side);
  EXPECT_THROW(make_grid(view, 0.0F), InvalidInput);
}

TEST(Resolution, a_texel_of_a_plane_is_a_pixel) {
  const Mesh mesh = plane_grid(8);
  const StorageAtlas storage = storage_of(mesh, flat_normal_map(256, 256, CodeType::U8));
  const View front = named_view(mesh, NamedView::Front);
  EXPECT_NEAR(texel_pixel_size(mesh, storage, front, {-1, -1}, {1, 1}), 1.0F / 256, 1e-7F);
  const View turned = make_view({0, 0, 1}, {1, 2, 0}, {0.5F, 0.5F, 0}, 2, 2);
  EXPECT_NEAR(texel_pixel_size(mesh, storage, turned, {-1, -1}, {1, 1}), 1.0F / 256, 1e-7F);
  // Seen at 60 degrees a texel is half as high.
  const View tilted = make_view({0, std::sqrt(0.75F), 0.5F}, {0, 1, 0}, {0.5F, 0.5F, 0}, 2, 2);
  EXPECT_NEAR(texel_pixel_size(mesh, storage, tilted, {-1, -1}, {1, 1}), 0.5F / 256, 1e-6F);
  EXPECT_FLOAT_EQ(texel_pixel_size(mesh, storage, front, {5, 5}, {6, 6}),
                  std::max(front.width, front.height) / 1024);
}

TEST(Extend, keeps_what_is_valid_and_continues_it) {
  constexpr int n = 97;
  MaskImage valid(n, n, 0.0F);
  SlopeImage values(n, n, Vec2f(1e6F, -1e6F));
  const auto ramp = [](int x, int y) {
    return Vec2f(0.01F * static_cast<float>(x), 0.02F * static_cast<float>(y));
  };
  for (int y = 30; y < 70; ++y) {
    for (int x = 20; x < 60; ++x) {
      valid(x, y) = 0.3F;
      values(x, y) = ramp(x, y);
    }
  }
  extend(valid, values);
  float worst_inside = 0.0F;
  float worst_beside = 0.0F;
  float largest = 0.0F;
  for (int y = 0; y < n; ++y) {
    for (int x = 0; x < n; ++x) {
      const float error = (values(x, y) - ramp(x, y)).norm();
      largest = std::max(largest, values(x, y).norm());
      if (valid(x, y) > 0) worst_inside = std::max(worst_inside, error);
      if (grow({20, 30, 60, 70}, 2).contains(x, y)) worst_beside = std::max(worst_beside, error);
    }
  }
  EXPECT_EQ(worst_inside, 0.0F);
  EXPECT_LT(worst_beside, 0.2F);
  EXPECT_LT(largest, 1.6F) << "never beyond the valid values";
}

TEST(Extend, nothing_valid_gives_zero_and_everything_valid_stays) {
  MaskImage none(5, 3, 0.0F);
  SlopeImage values(5, 3, Vec2f(7, 7));
  extend(none, values);
  EXPECT_EQ(values(2, 1), Vec2f(0, 0));
  values.fill({2, 3});
  none.fill(1.0F);
  extend(none, values);
  EXPECT_EQ(values(4, 2), Vec2f(2, 3));
  SlopeImage empty;
  extend(MaskView(), empty);
}

}  // namespace
}  // namespace normalshop
