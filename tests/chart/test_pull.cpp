#include <cmath>

#include "chart_fixtures.h"
#include "support/meshes.h"
#include <gtest/gtest.h>

#include "normalshop/core/parallel.h"

namespace normalshop {
namespace {

using namespace test;

struct Errors {
  double mean = 0.0;
  double max = 0.0;
  int count = 0;
  void add(double e) {
    mean = (mean * count + e) / (count + 1);
    max = std::max(max, e);
    ++count;
  }
};

/// Object-space point that a pixel shows.
Vec3f point_at(const EditingChart& chart, int x, int y) {
  const Vec2f p = chart.grid.to_units({static_cast<float>(x), static_cast<float>(y)});
  const View& view = chart.grid.view;
  return view.center + view.to_object({p.x(), p.y(), chart.ids.depth(x, y)});
}

/// Wavy details on the unit sphere.
Vec3f wavy(const Vec3f& position) {
  const Vec3f n = position.normalized();
  const Vec3f wave(std::sin(9.0F * n.x()), std::sin(7.0F * n.y() + 1.0F), std::sin(8.0F * n.z()));
  return (n + 0.2F * wave).normalized();
}

Errors detail_errors(const Mesh& mesh, NormalSpace space, const Vec3f& direction) {
  const StorageAtlas storage = storage_of(mesh, 512, space, wavy);
  const EditingChart chart = chart_from(mesh, storage, direction, 300);
  Errors errors;
  for (int y = 0; y < chart.grid.height(); ++y) {
    for (int x = 0; x < chart.grid.width(); ++x) {
      if (!(chart.base_normal(x, y).z() > 0.2F)) continue;
      const Vec3f point = point_at(chart, x, y);
      if (std::abs(point.y()) > 0.95F) continue;  // around a pole of the map frames turn per texel
      const Vec3f truth = chart.grid.view.to_chart(wavy(point));
      errors.add(angle_degrees(chart.normal(x, y), truth));
    }
  }
  return errors;
}

TEST(Pull, base_normals_of_a_hemisphere) {
  const Mesh mesh = hemisphere(48, 96);
  const StorageAtlas storage = storage_of(mesh, flat_normal_map(128, 128, CodeType::U8));
  for (const Vec3f& direction : {Vec3f(0, 0, 1), Vec3f(0.5F, -0.3F, 0.8F)}) {
    const EditingChart chart = chart_from(mesh, storage, direction, 240);
    Errors errors;
    Errors flat;
    for (int y = 0; y < chart.grid.height(); ++y) {
      for (int x = 0; x < chart.grid.width(); ++x) {
        if (chart.ids.triangle(x, y) == no_triangle) {
          EXPECT_TRUE(chart.base_normal(x, y).isZero());
          continue;
        }
        const Vec3f truth = chart.grid.view.to_chart(point_at(chart, x, y).normalized());
        errors.add(angle_degrees(chart.base_normal(x, y), truth));
        flat.add(angle_degrees(chart.normal(x, y), chart.base_normal(x, y)));
      }
    }
    EXPECT_GT(errors.count, 10000);
    EXPECT_LT(errors.mean, 0.02);
    EXPECT_LT(errors.max, 0.25);
    EXPECT_LT(flat.max, 1e-3) << "a flat map shows the base normals";
  }
}

TEST(Pull, details_of_a_tangent_space_map) {
  const Errors errors = detail_errors(hemisphere(48, 96), NormalSpace::Tangent, {0.2F, 0.1F, 1});
  EXPECT_GT(errors.count, 10000);
  EXPECT_LT(errors.mean, 0.1);
  EXPECT_LT(errors.max, 1.5);
}

TEST(Pull, details_of_an_object_space_map) {
  const Errors errors = detail_errors(hemisphere(48, 96), NormalSpace::Object, {0.2F, 0.1F, 1});
  EXPECT_LT(errors.mean, 0.05);
  EXPECT_LT(errors.max, 0.5);
}

TEST(Pull, details_over_the_seam_of_a_sphere) {
  const Errors errors = detail_errors(smooth_sphere(96, 48), NormalSpace::Tangent, {0, 0.3F, 1});
  EXPECT_LT(errors.mean, 0.1);
  EXPECT_LT(errors.max, 2.0);
}

/// The left half reads the right half's texels, mirrored: x turns over, y stays.
TEST(Pull, mirrored_uvs_mirror_the_details) {
  const Mesh mesh = mirrored_pair(4);
  const Vec3f stored = Vec3f(0.3F, 0.2F, 0.9F).normalized();
  const StorageAtlas storage =
      storage_of(mesh, 64, NormalSpace::Tangent, [&](const Vec3f&) { return stored; });
  const EditingChart chart = chart_from(mesh, storage, {0, 0, 1}, 128);
  const int middle = chart.grid.height() / 2;
  const Vec3f left = chart.normal(chart.grid.width() / 4, middle);
  const Vec3f right = chart.normal(3 * chart.grid.width() / 4, middle);
  EXPECT_LT(angle_degrees(right, stored), 1e-3);
  EXPECT_LT(angle_degrees(left, {-stored.x(), stored.y(), stored.z()}), 1e-3);
}

TEST(Pull, only_what_is_asked_for) {
  const Mesh mesh = plane_grid(2);
  const StorageAtlas storage = storage_of(mesh, flat_normal_map(32, 32, CodeType::U8));
  const ChartGrid grid = make_grid(named_view(mesh, NamedView::Front), 0.02F);
  EditingChart chart = pull(mesh, storage, grid, {.normals = false, .albedo = true});
  EXPECT_TRUE(chart.normal.empty());
  EXPECT_EQ(chart.albedo(25, 25), Vec3f::Constant(0.5F));
  Rasterizer rasterizer;
  pull(mesh, storage, grid, {}, rasterizer, chart);
  EXPECT_TRUE(chart.albedo.empty());
  EXPECT_EQ(chart.normal(25, 25), Vec3f(0, 0, 1));
}

TEST(Pull, threads_change_nothing) {
  const Mesh mesh = uv_sphere(64, 32);
  const StorageAtlas storage = storage_of(mesh, noise_map(256, CodeType::U8));
  const EditingChart many = chart_from(mesh, storage, {1, 0.4F, 0.5F}, 300);
  const ThreadLimit limit(1);
  const EditingChart one = chart_from(mesh, storage, {1, 0.4F, 0.5F}, 300);
  for (std::size_t i = 0; i < many.normal.size(); ++i) {
    ASSERT_EQ(many.normal.data()[i], one.normal.data()[i]);
    ASSERT_EQ(many.weight.data()[i], one.weight.data()[i]);
  }
}

}  // namespace
}  // namespace normalshop
