#include <cmath>

#include "chart_fixtures.h"
#include "support/meshes.h"
#include <gtest/gtest.h>

#include "normalshop/core/random.h"
#include "normalshop/surface/seam_mismatch.h"

namespace normalshop {
namespace {

using namespace test;

/// A ridge of the given width along the x axis at y = 0 in object units, height over width 0.3.
EditImages ridge(const EditingChart& chart, float width) {
  EditImages images = constant_edit(chart, {0, 0});
  for (int y = 0; y < chart.grid.height(); ++y) {
    for (int x = 0; x < chart.grid.width(); ++x) {
      const Vec2f p = chart.grid.to_units({static_cast<float>(x), static_cast<float>(y)});
      const float u = p.y() / width;
      if (std::abs(u) < 1.0F) images.change(x, y).y() = -1.2F * u * (1.0F - u * u);
    }
  }
  return images;
}

struct Growth {
  SeamMismatch before;
  SeamMismatch after;
  SeamMismatch growth;
};

Growth push_ridge(const Mesh& mesh, StorageAtlas& storage, const Vec3f& direction, int side,
                  float width, EditMode mode) {
  const Seams seams = find_seams(mesh);
  const std::array<const NormalMap*, 1> maps{&storage.sets[0].normals};
  const std::vector<SeamSample> samples = sample_seams(mesh, seams.edges, maps);
  const std::vector<float> before = seam_angles(mesh, samples, maps);
  const EditingChart chart = chart_from(mesh, storage, direction, side);
  push(mesh, chart, ridge(chart, width).edit(mode), storage);
  const std::vector<float> after = seam_angles(mesh, samples, maps);
  return {summarize(before), summarize(after),
          mismatch_growth(before, after, edited_samples(mesh, samples, maps))};
}

TEST(PushSeams, a_stroke_across_a_turned_chart_keeps_both_sides_together) {
  const Mesh mesh = plane_two_charts(8);
  for (const EditMode mode : {EditMode::View, EditMode::Base}) {
    StorageAtlas storage =
        storage_of(mesh, 512, NormalSpace::Tangent, [](const Vec3f&) { return Vec3f(0, 0, 1); });
    const Growth g = push_ridge(mesh, storage, {0.2F, 0.1F, 1}, 600, 0.1F, mode);
    EXPECT_LT(g.before.max, 1e-3);
    EXPECT_GT(g.growth.count, 50U);
    EXPECT_LT(g.growth.mean, 0.1);
    EXPECT_LT(g.growth.p99, 1.0);
  }
}

TEST(PushSeams, details_that_differ_at_the_seam_differ_no_more) {
  const Mesh mesh = plane_two_charts(8);
  StorageAtlas storage = storage_of(mesh, noise_map(512, CodeType::U8, 3, 0.15F));
  const Growth g = push_ridge(mesh, storage, {0, 0, 1}, 600, 0.1F, EditMode::View);
  EXPECT_GT(g.before.mean, 1.0) << "noise does not meet at seams";
  EXPECT_LT(g.growth.mean, 0.1);
}

TEST(PushSeams, the_seam_of_a_sphere_stays_closed) {
  const Mesh mesh = smooth_sphere(96, 48);
  StorageAtlas storage = storage_of(mesh, 1024, NormalSpace::Tangent,
                                    [](const Vec3f& p) { return Vec3f(p.normalized()); });
  const Growth g = push_ridge(mesh, storage, {0.1F, 0.2F, 1}, 900, 0.2F, EditMode::Base);
  EXPECT_GT(g.growth.count, 50U);
  EXPECT_LT(g.growth.mean, 0.1);
  EXPECT_LT(g.growth.p99, 1.0);
}

/// Around a hard edge each face is a surface of its own: what happens to one leaves the other's
/// gutter alone, and its own gutter continues it.
TEST(PushSeams, a_hard_edge_keeps_its_faces_apart) {
  const Mesh mesh = cube(4);
  StorageAtlas storage = storage_of(mesh, flat_normal_map(384, 384, CodeType::U16));
  const EditingChart chart = chart_from(mesh, storage, {0, 0, 1}, 300);
  const Vec2f c(0.3F, 0.1F);
  push(mesh, chart, constant_edit(chart, c).edit(), storage);
  const NormalMap& map = storage.sets[0].normals;
  const Vec3f truth = normal_from_slope(c);
  int others = 0;
  int own = 0;
  double worst = 0.0;
  for (const GutterTexel& g : storage.sets[0].texels.gutter()) {
    const int x = static_cast<int>(g.texel % 384);
    const int y = static_cast<int>(g.texel / 384);
    EXPECT_TRUE(g.hard_edge);
    if (g.owner >= 32) {
      others += map.edited(x, y) ? 1 : 0;
      continue;
    }
    ++own;
    worst = std::max(worst, angle_degrees(map.normal(x, y), truth));
  }
  EXPECT_EQ(others, 0);
  EXPECT_GT(own, 1000);
  EXPECT_LT(worst, 1e-3);
}

/// The chart sees only the half that owns nothing: the gutter that both share follows it.
TEST(PushSeams, the_gutter_of_mirrored_halves_follows_the_one_that_is_seen) {
  Mesh mesh = mirrored_pair(4);
  for (Vec2f& uv : mesh.uvs) uv = Vec2f(0.1F, 0.1F) + 0.8F * uv;
  StorageAtlas storage = storage_of(mesh, flat_normal_map(128, 128, CodeType::U8));
  const View view = make_view({0, 0, 1}, {0, 1, 0}, {-0.56F, 0.5F, 0}, 1.1F, 1.1F);
  EditingChart chart = pull(mesh, storage, make_grid(view, 1.0F / 160));
  compute_weight(chart, {});
  const Vec2f c(0.2F, 0.1F);
  push(mesh, chart, constant_edit(chart, c).edit(), storage);
  const Vec3f truth = normal_from_slope({-c.x(), c.y()});
  int texels = 0;
  double worst = 0.0;
  for (const GutterTexel& g : storage.sets[0].texels.gutter()) {
    const int x = static_cast<int>(g.texel % 128);
    const int y = static_cast<int>(g.texel / 128);
    if (x < 16) continue;  // beside the fold, at whose other end lies the half that is not seen
    ++texels;
    worst = std::max(worst, angle_degrees(storage.sets[0].normals.normal(x, y), truth));
  }
  EXPECT_GT(texels, 2000);
  EXPECT_LT(worst, 1e-3);
}

TEST(SeamMismatch, finds_a_turned_chart) {
  const Mesh mesh = plane_two_charts(4);
  StorageAtlas storage = storage_of(mesh, 256, NormalSpace::Tangent,
                                    [](const Vec3f&) { return Vec3f(0.3F, 0, 1).normalized(); });
  const Seams seams = find_seams(mesh);
  EXPECT_EQ(seams.edges.size(), 4U);
  NormalMap& map = storage.sets[0].normals;
  const std::array<const NormalMap*, 1> maps{&map};
  const SeamMismatch right = measure_seams(mesh, seams.edges, maps);
  EXPECT_NEAR(static_cast<double>(right.count), 0.8 * 256, 4.0);
  EXPECT_LT(right.max, 0.01);
  // The same vector in both charts is wrong: they are turned by 90 degrees.
  for_texels(storage, [&](int x, int y, const SurfacePoint&) {
    map.set_normal(x, y, Vec3f(0.3F, 0, 1).normalized());
  });
  for (const GutterTexel& g : storage.sets[0].texels.gutter()) {
    map.set_normal(static_cast<int>(g.texel) % 256, static_cast<int>(g.texel) / 256,
                   Vec3f(0.3F, 0, 1).normalized());
  }
  const SeamMismatch wrong = measure_seams(mesh, seams.edges, maps);
  const double angle = angle_degrees(Vec3f(0.3F, 0, 1), Vec3f(0, 0.3F, 1));
  EXPECT_NEAR(wrong.mean, angle, 0.01);
  EXPECT_NEAR(wrong.p50, angle, 0.01);
  EXPECT_NEAR(wrong.max, angle, 0.01);
}

TEST(SeamMismatch, takes_uvs_that_are_no_numbers) {
  Mesh mesh = plane_two_charts(2);
  const Seams seams = find_seams(mesh);
  for (Vec2f& uv : mesh.uvs) uv.x() = std::nanf("");
  const NormalMap map = flat_normal_map(64, 64, CodeType::U8);
  const std::array<const NormalMap*, 1> maps{&map};
  const std::vector<SeamSample> samples = sample_seams(mesh, seams.edges, maps);
  EXPECT_EQ(samples.size(), seams.edges.size());
  for (const float degrees : seam_angles(mesh, samples, maps)) EXPECT_LT(degrees, 0.5F);
}

TEST(SeamMismatch, chooses_the_samples_that_edits_touch) {
  const Mesh mesh = plane_two_charts(4);
  StorageAtlas storage = storage_of(mesh, flat_normal_map(256, 256, CodeType::U8));
  NormalMap& map = storage.sets[0].normals;
  const std::array<const NormalMap*, 1> maps{&map};
  const Seams seams = find_seams(mesh);
  const std::vector<SeamSample> samples = sample_seams(mesh, seams.edges, maps);
  EXPECT_TRUE(edited_samples(mesh, samples, maps).empty());
  map.set_normal(127, 128, Vec3f(0, 0, 1));
  const auto chosen = edited_samples(mesh, samples, maps);
  ASSERT_FALSE(chosen.empty());
  EXPECT_LE(chosen.size(), 4U);
  for (const std::uint32_t i : chosen) {
    EXPECT_NEAR(position_at(mesh, samples[i].a).y(), 0.5F, 0.02F);
    EXPECT_LT((position_at(mesh, samples[i].a) - position_at(mesh, samples[i].b)).norm(), 1e-5F);
  }
  EXPECT_EQ(summarize({}).count, 0U);
  const SeamMismatch s = summarize({4, 1, 2, 3});
  EXPECT_DOUBLE_EQ(s.mean, 2.5);
  EXPECT_DOUBLE_EQ(s.p50, 2.0);
  EXPECT_DOUBLE_EQ(s.p99, 4.0);
}

}  // namespace
}  // namespace normalshop
