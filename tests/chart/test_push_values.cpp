#include <cmath>
#include <limits>

#include "chart_fixtures.h"
#include "support/meshes.h"
#include <gtest/gtest.h>

/// What push makes of values at the ends of their range and beyond.
namespace normalshop {
namespace {

using namespace test;

/// Details that lean over the horizon of an edit's direction: a small edit turns them by little,
/// and replacing them replaces them.
TEST(PushValues, details_beyond_the_horizon_are_not_snapped) {
  const Mesh mesh = plane_grid(2);
  const auto radians = [](float degrees) { return degrees * 3.14159265F / 180.0F; };
  const Vec3f away(std::sin(radians(40)), 0, std::cos(radians(40)));
  const auto detail = [&](const Vec3f&) { return away; };
  // The plane at 60 degrees, its details at 100; along the base normals, details behind the plane.
  const Vec3f view(-std::sin(radians(60)), 0, std::cos(radians(60)));
  const auto behind = [](const Vec3f&) { return Vec3f(0.8F, 0.5F, -0.3F).normalized(); };
  const EffectiveOptions wide{70.0F, 80.0F, 0.01F};
  for (const EditMode mode : {EditMode::View, EditMode::Base}) {
    const NormalAt stored = mode == EditMode::View ? NormalAt(detail) : NormalAt(behind);
    const StorageAtlas before = storage_of(mesh, 64, NormalSpace::Tangent, stored);
    const EditingChart chart = chart_from(mesh, before, view, 150, wide);
    StorageAtlas storage = before;
    const PushResult small =
        push(mesh, chart, constant_edit(chart, {0.001F, 0.0005F}).edit(mode), storage);
    EXPECT_EQ(small.changed, 64U * 64U);
    EXPECT_LT(small.largest_change, 0.1F);
    EXPECT_LT(angle_degrees(storage.sets[0].normals.normal(30, 30), stored({})), 0.1);
    EXPECT_NE(storage.sets[0].normals.normal(30, 30), before.sets[0].normals.normal(30, 30));
    storage = before;
    push(mesh, chart, constant_edit(chart, {0.1F, 0.2F}, 1.0F).edit(mode), storage);
    const Vec3f base = chart.grid.view.to_chart({0, 0, 1});
    const Vec3f truth = chart.grid.view.to_object(
        normal_from_gradient(base_gradient(base, mode) + Vec2f(0.1F, 0.2F), base, mode));
    EXPECT_LT(angle_degrees(storage.sets[0].normals.normal(30, 30), truth), 0.01);
  }
}

/// What an operator makes of damaged input reaches no map.
TEST(PushValues, changes_that_are_no_numbers_change_nothing) {
  const Mesh mesh = plane_grid(2);
  constexpr float infinity = std::numeric_limits<float>::infinity();
  for (const float bad : {infinity, -infinity, std::nanf(""), 3e19F, -1e38F}) {
    for (const EditMode mode : {EditMode::View, EditMode::Base}) {
      StorageAtlas storage = storage_of(mesh, noise_map(64, CodeType::U8));
      const EditingChart chart = chart_from(mesh, storage, {0.1F, 0, 1}, 128);
      EditImages images = constant_edit(chart, {0.1F, 0.1F});
      const int middle = chart.grid.width() / 2;
      for (int y = 0; y < chart.grid.height(); ++y) images.change(middle, y) = {bad, 0.0F};
      const PushResult result = push(mesh, chart, images.edit(mode), storage);
      EXPECT_GT(result.changed, 3000U);
      EXPECT_LT(result.changed, 64U * 64U);
      EXPECT_TRUE(std::isfinite(result.largest_change));
      for_texels(storage, [&](int x, int y, const SurfacePoint&) {
        ASSERT_NEAR(storage.sets[0].normals.normal(x, y).norm(), 1.0F, 1e-3F);
      });
    }
  }
}

/// Pull shows the base normals, and push starts from them.
void expect_undetailed(const Mesh& mesh, const NormalMap& map) {
  StorageAtlas storage = storage_of(mesh, map);
  const EditingChart chart = chart_from(mesh, storage, {0.3F, 0.2F, 1}, 100);
  double shown = 0.0;
  for (std::size_t i = 0; i < chart.normal.size(); ++i) {
    if (chart.ids.triangle.data()[i] == no_triangle) continue;
    ASSERT_NEAR(chart.normal.data()[i].norm(), 1.0F, 1e-5F);
    shown = std::max(shown, angle_degrees(chart.normal.data()[i], chart.base_normal.data()[i]));
  }
  EXPECT_LT(shown, 1e-3);
  const Vec2f c(0.3F, 0.1F);
  push(mesh, chart, constant_edit(chart, c).edit(), storage);
  const View& view = chart.grid.view;
  const Vec2f wanted = slope_from_normal(view.to_chart({0, 0, 1})) + c;
  const Vec3f truth = view.to_object(normal_from_slope(wanted));
  double worst = 0.0;
  for_texels(storage, [&](int x, int y, const SurfacePoint& p) {
    worst = std::max(worst, angle_degrees(stored_normal(mesh, storage, x, y, p), truth));
  });
  EXPECT_LT(worst, 1e-3);
}

TEST(PushValues, codes_without_a_direction_count_as_flat) {
  const Mesh mesh = plane_grid(2);
  RawImage grey(64, 64, 3, CodeType::U8);
  std::fill_n(grey.row<std::uint8_t>(0), 64 * 64 * 3, std::uint8_t{128});
  expect_undetailed(mesh, NormalMap(grey, {}));
  constexpr float infinity = std::numeric_limits<float>::infinity();
  for (const float code : {0.0F, 0.01F, 1e20F, infinity, -infinity, std::nanf("")}) {
    for (const NormalSpace space : {NormalSpace::Tangent, NormalSpace::Object}) {
      NormalConvention convention;
      convention.signed_float = true;
      convention.space = space;
      RawImage codes(64, 64, 3, CodeType::F32);
      std::fill_n(codes.row<float>(0), 64 * 64 * 3, code);
      expect_undetailed(mesh, NormalMap(std::move(codes), convention));
    }
  }
}

}  // namespace
}  // namespace normalshop
