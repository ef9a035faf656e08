#include <cmath>

#include "chart_fixtures.h"
#include "support/meshes.h"
#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace normalshop {
namespace {

using namespace test;

/// What becomes of a flat map on a plane facing +z when slopes of `c` are added in a view.
Vec3f raised_plane(const View& view, const Vec2f& c) {
  return view.to_object(normal_from_slope(slope_from_normal(view.to_chart({0, 0, 1})) + c));
}

double worst_error(const Mesh& mesh, const StorageAtlas& storage, const Vec3f& truth) {
  double worst = 0.0;
  for_texels(storage, [&](int x, int y, const SurfacePoint& p) {
    worst = std::max(worst, angle_degrees(stored_normal(mesh, storage, x, y, p), truth));
  });
  return worst;
}

/// The diagonal cuts a row of 64 texels into runs of every length from 1 to 64; maps smaller than a
/// tile, and a little larger.
TEST(PushMaps, of_every_size_take_the_change) {
  const Mesh mesh = plane_grid(1);
  const Vec2f c(0.3F, -0.2F);
  for (const int size : {1, 2, 7, 63, 64, 65, 130}) {
    StorageAtlas storage = storage_of(mesh, flat_normal_map(size, size, CodeType::F32));
    const EditingChart chart = chart_from(mesh, storage, {0.2F, 0.1F, 1}, 150);
    const PushResult result = push(mesh, chart, constant_edit(chart, c).edit(), storage);
    EXPECT_EQ(result.visited, static_cast<std::size_t>(size) * static_cast<std::size_t>(size));
    EXPECT_EQ(result.changed, result.visited);
    EXPECT_LT(worst_error(mesh, storage, raised_plane(chart.grid.view, c)), 1e-3) << size;
  }
}

TEST(PushMaps, of_two_texture_sets_each_take_their_part) {
  Mesh mesh = plane_two_charts(4);
  mesh.texture_set_names = {"left", "right"};
  std::fill(mesh.texture_sets.begin() + 32, mesh.texture_sets.end(), 1U);
  StorageAtlas storage;
  for (const std::uint32_t set : {0U, 1U}) {
    const int size = set == 0 ? 100 : 150;
    storage.sets.push_back({flat_normal_map(size, size, CodeType::U8),
                            ColorMap(Vec3f::Constant(0.5F)), TexelMap(mesh, set, size, size)});
  }
  const EditingChart chart = chart_from(mesh, storage, {0.1F, 0.2F, 1}, 200);
  const Vec2f c(0.2F, 0.1F);
  const PushResult result = push(mesh, chart, constant_edit(chart, c).edit(), storage);
  const Vec3f truth = raised_plane(chart.grid.view, c);
  std::size_t edited = 0;
  for (const StorageSet& set : storage.sets) {
    double worst = 0.0;
    for (int y = 0; y < set.normals.height(); ++y) {
      for (int x = 0; x < set.normals.width(); ++x) {
        const std::uint32_t owner = set.texels.owner()(x, y);
        if (owner == no_triangle) continue;
        const SurfacePoint p = set.texels.surface_point(owner, x, y);
        const Vec3f n =
            frame_at(mesh, p, NormalSpace::Tangent).object_normal(set.normals.normal(x, y));
        worst = std::max(worst, angle_degrees(n, truth));
      }
    }
    EXPECT_LT(worst, 1e-3);
    EXPECT_GT(set.normals.edited_count(), 1000U);
    edited += set.normals.edited_count();
  }
  EXPECT_EQ(result.changed, edited);
}

/// Object-space maps hold the node's own normals: turned, mirrored, and a thousand times as long.
TEST(PushMaps, of_object_space_belong_to_their_node) {
  Mesh mesh = plane_grid(3);
  mesh.nodes.assign(mesh.triangle_count(), 0);
  const Mat3f turn = Eigen::AngleAxisf(0.7F, Vec3f(1, 2, -1).normalized()).toRotationMatrix();
  const Vec2f c(0.25F, -0.1F);
  for (const Vec3f& scale :
       {Vec3f(1, 1, 1), Vec3f(-1, 1, 1), Vec3f(-1e-3F, 2e-3F, 3e-3F), Vec3f(1e3F, 1e3F, -1e3F)}) {
    mesh.node_normals = {turn * scale.asDiagonal()};
    for (const NormalSpace space : {NormalSpace::Object, NormalSpace::World}) {
      const Vec3f detail = Vec3f(0.2F, 0.1F, 1).normalized();
      StorageAtlas storage = storage_of(mesh, 96, space, [&](const Vec3f&) { return detail; });
      const EditingChart chart = chart_from(mesh, storage, {0, 0.1F, 1}, 200);
      const View& view = chart.grid.view;
      double shown = 0.0;
      for (std::size_t i = 0; i < chart.normal.size(); ++i) {
        if (chart.ids.triangle.data()[i] == no_triangle) continue;
        shown = std::max(shown, angle_degrees(chart.normal.data()[i], view.to_chart(detail)));
      }
      EXPECT_LT(shown, 1e-3);
      push(mesh, chart, constant_edit(chart, c).edit(), storage);
      const Vec2f slope = slope_from_normal(view.to_chart(detail)) + c;
      EXPECT_LT(worst_error(mesh, storage, view.to_object(normal_from_slope(slope))), 1e-3);
    }
  }
}

TEST(PushMaps, of_two_channels_or_with_green_down_hold_the_change) {
  const Mesh mesh = plane_grid(3);
  const Vec2f c(0.2F, 0.3F);
  for (const bool down : {false, true}) {
    for (const bool two : {false, true}) {
      NormalConvention convention;
      convention.green_down = down;
      convention.two_channel = two;
      RawImage codes(64, 64, 3, CodeType::U16);
      std::fill_n(codes.row<std::uint16_t>(0), 64 * 64 * 3, std::uint16_t{32768});
      for (int i = 2; i < 64 * 64 * 3; i += 3) codes.row<std::uint16_t>(0)[i] = 65535;
      StorageAtlas storage = storage_of(mesh, NormalMap(std::move(codes), convention));
      const EditingChart chart = chart_from(mesh, storage, {0, 0, 1}, 150);
      push(mesh, chart, constant_edit(chart, c).edit(), storage);
      const Vec3f truth = normal_from_slope(c);
      EXPECT_LT(worst_error(mesh, storage, truth), 0.01);
      StorageAtlas read = storage_of(mesh, NormalMap(storage.sets[0].normals.encode(), convention));
      EXPECT_FALSE(read.sets[0].normals.has_edits());
      EXPECT_LT(worst_error(mesh, read, truth), 0.01);
    }
  }
}

/// texel' = texel + coverage * (base - texel) + change, on a plane that is seen squarely.
TEST(PushMaps, are_covered_in_part) {
  const Mesh mesh = plane_grid(2);
  const StorageAtlas before = storage_of(mesh, noise_map(128, CodeType::F32));
  const Vec2f c(0.1F, -0.2F);
  for (const EditMode mode : {EditMode::View, EditMode::Base}) {
    for (const float coverage : {0.25F, 0.75F}) {
      StorageAtlas storage = before;
      const EditingChart chart = chart_from(mesh, storage, {0, 0, 1}, 200);
      push(mesh, chart, constant_edit(chart, c, coverage).edit(mode), storage);
      float worst = 0.0F;
      for_texels(storage, [&](int x, int y, const SurfacePoint&) {
        const Vec2f was = slope_from_normal(before.sets[0].normals.normal(x, y));
        const Vec2f is = slope_from_normal(storage.sets[0].normals.normal(x, y));
        worst = std::max(worst, (is - (1.0F - coverage) * was - c).norm());
      });
      EXPECT_LT(worst, 1e-5F);
    }
  }
}

TEST(PushMaps, stay_as_they_are_without_a_region) {
  const Mesh mesh = plane_grid(2);
  StorageAtlas storage = storage_of(mesh, noise_map(64, CodeType::U8));
  const EditingChart chart = chart_from(mesh, storage, {0, 0, 1}, 100);
  const EditImages images = constant_edit(chart, {0.5F, 0.5F}, 1.0F);
  for (const Rect& region : {Rect{}, Rect{10, 10, 10, 50}, Rect{-50, -50, -10, -10}}) {
    ChartEdit edit = images.edit();
    edit.region = region;
    const PushResult result = push(mesh, chart, edit, storage);
    EXPECT_EQ(result.visited, 0U);
    EXPECT_EQ(result.changed, 0U);
    EXPECT_EQ(result.largest_change, 0.0F);
  }
  EXPECT_FALSE(storage.sets[0].normals.has_edits());
}

TEST(PushMaps, follow_a_chart_of_one_pixel) {
  const Mesh mesh = plane_grid(2);
  StorageAtlas storage = storage_of(mesh, flat_normal_map(32, 32, CodeType::U8));
  ChartGrid grid = make_grid(make_view({0, 0, 1}, {0, 1, 0}, {0, 1, 0}, 1.0F, 1.0F), 1.0F);
  grid.window = {0, 0, 1, 1};  // its centre is the plane's
  EditingChart chart = pull(mesh, storage, grid);
  compute_weight(chart, {});
  ASSERT_EQ(chart.weight(0, 0), 1.0F);
  const PushResult result = push(mesh, chart, constant_edit(chart, {0.3F, 0.1F}).edit(), storage);
  EXPECT_EQ(result.changed, 32U * 32U);
  EXPECT_LT(worst_error(mesh, storage, normal_from_slope({0.3F, 0.1F})), 1e-3);
}

}  // namespace
}  // namespace normalshop
