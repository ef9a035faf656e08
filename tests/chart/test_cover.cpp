#include <cmath>

#include "chart_fixtures.h"
#include "support/chart_bijection.h"
#include "support/meshes.h"
#include "support/sanitized.h"
#include <gtest/gtest.h>

#include "normalshop/chart/cover.h"
#include "normalshop/chart/surface_blend.h"
#include "normalshop/core/error.h"
#include "normalshop/core/parallel.h"

namespace normalshop::test {
namespace {

EditingChart chart_of(const Mesh& mesh, const StorageAtlas& storage, const CoverView& view,
                      float pixel, const CoverOptions& options) {
  EditingChart chart;
  chart.grid = make_grid(view.view, pixel, view.low, view.high);
  view.rasterize(mesh, chart.grid, chart.ids);
  pull_attributes(mesh, storage, chart);
  compute_weight(chart, options.effective);
  return chart;
}

const Mesh& sphere() {
  static const Mesh mesh = smooth_sphere(32, 16);
  return mesh;
}

/// The views that cover it, found once: that takes long under sanitizers.
const std::vector<CoverView>& sphere_views() {
  static const std::vector<CoverView> views = cover_surface(sphere(), {});
  return views;
}

/// The same change of slopes from each view that covers the mesh.
PushResult blend_constant(const Mesh& mesh, const std::vector<CoverView>& views,
                          StorageAtlas& storage, const Vec2f& change) {
  const CoverOptions options;
  SurfaceBlend blend(storage);
  for (const CoverView& view : views) {
    const float pixel = std::max(view.view.width, view.view.height) / 160.0F;
    const EditingChart chart = chart_of(mesh, storage, view, pixel, options);
    const EditImages images = constant_edit(chart, change);
    blend.add(mesh, chart, images.edit(EditMode::Base), storage);
  }
  return blend.write(storage);
}

/// The best cosine that any view has at each covered texel; 0 where none sees it.
std::vector<float> best_cosines(const Mesh& mesh, const StorageAtlas& storage,
                                const std::vector<CoverView>& views) {
  std::vector<float> best;
  for_texels(storage, [&](int, int, const SurfacePoint& p) {
    float most = 0.0F;
    for (const CoverView& view : views) {
      most = std::max(most, base_normal_at(mesh, p).dot(view.view.direction));
    }
    best.push_back(most);
  });
  return best;
}

TEST(Cover, shows_all_of_a_sphere_squarely) {
  NORMALSHOP_SKIP_FIGURES();
  const Mesh& mesh = sphere();
  const StorageAtlas storage = storage_of(mesh, flat_normal_map(64, 64, CodeType::U8));
  const std::vector<CoverView>& views = sphere_views();
  EXPECT_GE(views.size(), 8U);
  EXPECT_LE(views.size(), 32U);
  for (const float cosine : best_cosines(mesh, storage, views)) EXPECT_GT(cosine, 0.8F);
}

TEST(Cover, needs_one_view_for_a_plane_and_takes_no_more_than_asked_for) {
  NORMALSHOP_SKIP_FIGURES();
  const std::vector<CoverView> one = cover_surface(plane_grid(2), {});
  ASSERT_EQ(one.size(), 1U);
  EXPECT_GT(one[0].view.direction.z(), 0.99F);
  CoverOptions few;
  few.views = 4;
  int outer = 0;  // the others show what these leave
  for (const CoverView& view : cover_surface(sphere(), few)) {
    outer += view.shown == nullptr ? 1 : 0;
  }
  EXPECT_EQ(outer, 4);
}

TEST(Cover, is_the_same_for_one_thread) {
  const Mesh mesh = cube(3);
  const std::vector<CoverView> many = cover_surface(mesh, {});
  const ThreadLimit limit(1);
  const std::vector<CoverView> one = cover_surface(mesh, {});
  ASSERT_EQ(one.size(), many.size());
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].view.direction, many[i].view.direction);
    EXPECT_EQ(one[i].low, many[i].low);
    EXPECT_EQ(one[i].high, many[i].high);
  }
}

TEST(Cover, refuses_a_model_without_surface) {
  EXPECT_THROW(cover_surface(Mesh{}, {}), InvalidInput);
  Mesh flat = plane_grid(1);
  for (Vec3f& p : flat.positions) p = Vec3f::Ones();
  EXPECT_THROW(cover_surface(flat, {}), InvalidInput);
}

/// Texels that a view's chart shows are changed, and no other, whatever the sizes of both.
TEST(Cover, gives_views_whose_effective_charts_are_updated_wholly) {
  for (const float side : {60.0F, 250.0F}) {
    const StorageAtlas storage = storage_of(sphere(), flat_normal_map(128, 128, CodeType::U8));
    Bijection all;
    for (const CoverView& view : sphere_views()) {
      const float pixel = std::max(view.view.width, view.view.height) / side;
      EditingChart chart = chart_of(sphere(), storage, view, pixel, {});
      all.add(edit_all(sphere(), storage, chart));
    }
    EXPECT_GT(all.effective, 50000U);
    EXPECT_GT(all.pixels, 10000U);
    EXPECT_EQ(all.missed, 0U) << side;
    EXPECT_EQ(all.unlinked, 0U) << side;
    EXPECT_EQ(all.outside, 0U) << side;
    EXPECT_LT(all.behind, all.effective / 1000) << side;
  }
}

TEST(SurfaceBlend, reaches_every_texel_of_a_sphere) {
  StorageAtlas storage = storage_of(sphere(), flat_normal_map(96, 96, CodeType::U8));
  const PushResult result = blend_constant(sphere(), sphere_views(), storage, {0.3F, 0.1F});
  std::size_t covered = 0;
  std::size_t missed = 0;
  for_texels(storage, [&](int x, int y, const SurfacePoint&) {
    ++covered;
    missed += storage.sets[0].normals.edited(x, y) ? 0 : 1;
  });
  EXPECT_EQ(missed, 0U);
  EXPECT_GE(result.changed, covered);
  EXPECT_GT(result.visited, 2 * covered);
}

/// Every view takes all details away; their mean does, too, at every texel and in its gutter.
TEST(SurfaceBlend, of_equal_results_is_that_result) {
  const Mesh& mesh = sphere();
  StorageAtlas storage = storage_of(mesh, noise_map(96, CodeType::U16));
  SurfaceBlend blend(storage);
  for (const CoverView& view : sphere_views()) {
    const EditingChart chart = chart_of(mesh, storage, view, 0.012F, {});
    const EditImages images = constant_edit(chart, {0, 0}, 1.0F);
    blend.add(mesh, chart, images.edit(EditMode::Base), storage);
  }
  blend.write(storage);
  float worst = 0.0F;
  for_texels(storage, [&](int x, int y, const SurfacePoint& p) {
    worst = std::max(worst, static_cast<float>(angle_degrees(stored_normal(mesh, storage, x, y, p),
                                                             base_normal_at(mesh, p))));
  });
  EXPECT_LT(worst, 0.05F);
}

/// The wall of a cavity in a ball, which no view of the whole shows.
TEST(SurfaceBlend, reaches_the_inside_of_a_cavity) {
  Mesh mesh = smooth_sphere(32, 16);
  const Mesh ball = mesh;
  for (Vec2f& uv : mesh.uvs) uv.y() *= 0.5F;
  for (std::size_t t = 0; t < ball.triangle_count(); ++t) {
    const auto base = static_cast<std::uint32_t>(ball.positions.size());
    const Vec3u& corners = ball.triangles[t];
    mesh.triangles.push_back(Vec3u(base + corners[0], base + corners[2], base + corners[1]));
    for (const std::size_t k : {0U, 2U, 1U}) {
      mesh.normals.push_back(-ball.normals[3 * t + k]);
      mesh.tangents.push_back(ball.tangents[3 * t + k]);
      mesh.uvs.emplace_back(ball.uvs[3 * t + k].x(), 0.5F + 0.5F * ball.uvs[3 * t + k].y());
    }
    mesh.texture_sets.push_back(0);
  }
  for (const Vec3f& p : ball.positions) mesh.positions.push_back(0.5F * p);
  StorageAtlas storage = storage_of(mesh, flat_normal_map(96, 96, CodeType::U8));
  const std::vector<CoverView> views = cover_surface(mesh, {});
  EXPECT_EQ(views.front().shown, nullptr);
  EXPECT_NE(views.back().shown, nullptr);
  blend_constant(mesh, views, storage, {0.2F, 0.0F});
  std::size_t missed = 0;
  for_texels(storage, [&](int x, int y, const SurfacePoint&) {
    missed += storage.sets[0].normals.edited(x, y) ? 0 : 1;
  });
  EXPECT_EQ(missed, 0U);
}

/// A roof whose slopes share the texels, mirrored. Each is seen by one view alone, which adds the
/// same slope: in the map these are not the same.
TEST(SurfaceBlend, gives_shared_texels_to_the_first_of_their_triangles) {
  Mesh mesh = mirrored_pair(4);
  const auto half = 3 * mesh.triangle_count() / 2;
  const std::array<Vec3f, 2> normals{Vec3f(0.8F, 0, 0.6F), Vec3f(-0.8F, 0, 0.6F)};
  for (Vec3f& p : mesh.positions) p = Vec3f(0.6F * p.x(), p.y(), -0.8F * std::abs(p.x()));
  for (std::size_t c = 0; c < 2 * half; ++c) {
    Vec4f& t = mesh.tangents[c];
    mesh.normals[c] = normals[c / half];
    t.head<3>() = t.x() * Vec3f(0.6F, 0, c < half ? -0.8F : 0.8F);
  }
  const StorageAtlas before = storage_of(mesh, noise_map(64, CodeType::U16));
  const auto edited = [&](const std::vector<int>& views, PushResult& result) {
    StorageAtlas storage = before;
    SurfaceBlend blend(storage);
    for (const int view : views) {
      const EditingChart chart =
          chart_from(mesh, storage, normals[static_cast<std::size_t>(view)], 120);
      const EditImages images = constant_edit(chart, {0.3F, 0.1F});
      blend.add(mesh, chart, images.edit(EditMode::Base), storage);
    }
    result = blend.write(storage);
    return storage;
  };
  PushResult result;
  const StorageAtlas first = edited({0}, result);
  const StorageAtlas second = edited({1}, result);
  float apart = 0.0F;
  for (const std::vector<int>& views : {std::vector<int>{0, 1}, std::vector<int>{1, 0}}) {
    const StorageAtlas both = edited(views, result);
    EXPECT_EQ(result.changed, 64U * 64U);
    EXPECT_EQ(result.shared, 64U * 64U);
    for_texels(both, [&](int x, int y, const SurfacePoint&) {
      const Vec3f n = first.sets[0].normals.normal(x, y);
      ASSERT_EQ(both.sets[0].normals.normal(x, y), n);
      apart += (second.sets[0].normals.normal(x, y) - n).norm() / (2.0F * 64.0F * 64.0F);
    });
  }
  EXPECT_GT(apart, 0.3F);
}

TEST(SurfaceBlend, of_no_change_stores_nothing) {
  StorageAtlas storage = storage_of(sphere(), noise_map(64, CodeType::U8));
  EXPECT_EQ(blend_constant(sphere(), sphere_views(), storage, {0, 0}).changed, 0U);
  EXPECT_FALSE(storage.sets[0].normals.has_edits());
}

TEST(SurfaceBlend, is_the_same_for_one_thread) {
  StorageAtlas many = storage_of(sphere(), noise_map(64, CodeType::U16));
  StorageAtlas one = many;
  blend_constant(sphere(), sphere_views(), many, {0.2F, -0.1F});
  const ThreadLimit limit(1);
  blend_constant(sphere(), sphere_views(), one, {0.2F, -0.1F});
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      ASSERT_EQ(one.sets[0].normals.normal(x, y), many.sets[0].normals.normal(x, y));
    }
  }
}

}  // namespace
}  // namespace normalshop::test
