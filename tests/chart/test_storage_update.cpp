#include <cmath>

#include "chart_fixtures.h"
#include "support/meshes.h"
#include "support/same_codes.h"
#include "support/sanitized.h"
#include <gtest/gtest.h>

#include "normalshop/chart/point_pull.h"
#include "normalshop/chart/update_storage.h"
#include "normalshop/core/parallel.h"
#include "normalshop/core/random.h"

namespace normalshop {
namespace {

using namespace test;

constexpr std::array<Update, 2> pixel_updates{Update::Point, Update::Area};
constexpr std::array<Transfer, 2> both_transfers{Transfer::Triangle, Transfer::Point};

EditingChart transfer_chart(const Mesh& mesh, const StorageAtlas& storage, const View& view,
                            float pixel, Transfer transfer) {
  const ChartGrid grid = make_grid(view, pixel);
  EditingChart chart =
      transfer == Transfer::Point ? pull_points(mesh, storage, grid) : pull(mesh, storage, grid);
  if (transfer == Transfer::Triangle) find_texels(mesh, storage, chart);
  compute_weight(chart, {});
  return chart;
}

/// The unit square from the front, so many pixels a texel.
EditingChart square_chart(const Mesh& mesh, const StorageAtlas& storage, float pixels_a_texel,
                          Transfer transfer) {
  const View view = make_view(Vec3f::UnitZ(), Vec3f::UnitY(), {0.5F, 0.5F, 0.0F}, 1.0F, 1.0F);
  const auto texels = static_cast<float>(storage.sets[0].normals.width());
  return transfer_chart(mesh, storage, view, 1.0F / (texels * pixels_a_texel), transfer);
}

StorageAtlas flat_storage(const Mesh& mesh, int size) {
  return storage_of(mesh, flat_normal_map(size, size, CodeType::U8));
}

double largest_difference(const StorageAtlas& a, const StorageAtlas& b) {
  double worst = 0.0;
  for (int y = 0; y < a.sets[0].normals.height(); ++y) {
    for (int x = 0; x < a.sets[0].normals.width(); ++x) {
      const double angle =
          angle_degrees(a.sets[0].normals.normal(x, y), b.sets[0].normals.normal(x, y));
      worst = std::max(worst, angle);
    }
  }
  return worst;
}

TEST(StorageUpdate, pixels_know_their_texels) {
  const Mesh mesh = plane_grid(4);
  const StorageAtlas storage = flat_storage(mesh, 32);
  for (const Transfer transfer : both_transfers) {
    const EditingChart chart = square_chart(mesh, storage, 3.0F, transfer);
    ASSERT_EQ(chart.grid.width(), 96);
    for (int y = 0; y < 96; ++y) {
      for (int x = 0; x < 96; ++x) {
        const TexelPlace at = texel_place(chart.texel(x, y), 32);
        EXPECT_EQ(at.x, x / 3);
        EXPECT_EQ(at.y, y / 3);
      }
    }
  }
}

TEST(StorageUpdate, points_come_back_as_they_were) {
  const Mesh mesh = smooth_sphere(48, 24);
  const StorageAtlas before = storage_of(mesh, noise_map(256, CodeType::U16));
  const View view = framing_view(mesh, {0.5F, 0.3F, 0.8F});
  const EditingChart chart =
      transfer_chart(mesh, before, view, view.width / 300.0F, Transfer::Point);
  const EditImages no_change = constant_edit(chart, Vec2f::Zero());
  for (const Update how : pixel_updates) {
    StorageAtlas after = before;
    const PushResult result = update_storage(mesh, chart, no_change.edit(), how, after);
    EXPECT_GT(result.changed, 10000U);
    EXPECT_EQ(result.changed, after.sets[0].normals.edited_count());
    EXPECT_LT(result.largest_change, 0.05F);
    EXPECT_LT(largest_difference(before, after), 0.05);
  }
}

TEST(StorageUpdate, triangles_blur_what_comes_back) {
  const Mesh mesh = plane_grid(4);
  const StorageAtlas before = storage_of(mesh, noise_map(64, CodeType::U16));
  const EditingChart chart = square_chart(mesh, before, 1.3F, Transfer::Triangle);
  const EditImages no_change = constant_edit(chart, Vec2f::Zero());
  for (const Update how : pixel_updates) {
    StorageAtlas after = before;
    const PushResult result = update_storage(mesh, chart, no_change.edit(), how, after);
    EXPECT_GT(result.largest_change, 1.0F) << "bilinear look-ups are not the texels";
    EXPECT_LT(result.largest_change, 40.0F);
  }
}

/// Slope along x that an edit of slope 0.01 per pixel column leaves in texel column x.
float column_slope(Update how, int x) {
  const Mesh mesh = plane_grid(2);
  StorageAtlas storage = flat_storage(mesh, 16);
  const EditingChart chart = square_chart(mesh, storage, 3.0F, Transfer::Triangle);
  EditImages images = constant_edit(chart, Vec2f::Zero());
  for (int j = 0; j < chart.grid.height(); ++j) {
    for (int i = 0; i < chart.grid.width(); ++i) {
      // 1, 0 and 0.5 from left to right in every texel.
      images.change(i, j).x() = i % 3 == 0 ? 1.0F : i % 3 == 1 ? 0.0F : 0.5F;
    }
  }
  update_storage(mesh, chart, images.edit(), how, storage);
  const Vec3f n = storage.sets[0].normals.normal(x, 5);
  return -n.x() / n.z();
}

TEST(StorageUpdate, point_takes_the_middle_pixel_and_area_the_mean) {
  EXPECT_NEAR(column_slope(Update::Point, 7), 0.0F, 1e-5F);
  const Vec3f sum = Vec3f(-1, 0, 1).normalized() + Vec3f(0, 0, 1) + Vec3f(-0.5F, 0, 1).normalized();
  EXPECT_NEAR(column_slope(Update::Area, 7), -sum.x() / sum.z(), 1e-5F);
}

TEST(StorageUpdate, writes_what_gathering_writes_where_both_can) {
  const Mesh mesh = smooth_sphere(48, 24);
  const StorageAtlas before = flat_storage(mesh, 128);
  const View view = framing_view(mesh, {0.2F, 0.3F, 0.9F});
  for (const EditMode mode : {EditMode::View, EditMode::Base}) {
    for (const Transfer transfer : both_transfers) {
      const EditingChart chart = transfer_chart(mesh, before, view, view.width / 400.0F, transfer);
      const EditImages images = constant_edit(chart, {0.1F, -0.05F});
      StorageAtlas gathered = before;
      push(mesh, chart, images.edit(mode), gathered);
      for (const Update how : pixel_updates) {
        StorageAtlas written = before;
        update_storage(mesh, chart, images.edit(mode), how, written);
        double sum = 0.0;
        int count = 0;
        for_texels(gathered, [&](int x, int y, const SurfacePoint&) {
          const NormalMap& a = gathered.sets[0].normals;
          const NormalMap& b = written.sets[0].normals;
          if (!a.edited(x, y) || !b.edited(x, y)) return;
          sum += angle_degrees(a.normal(x, y), b.normal(x, y));
          ++count;
        });
        EXPECT_GT(count, 3000);
        EXPECT_LT(sum / count, 0.3) << "of a change of six degrees";
      }
    }
  }
}

TEST(StorageUpdate, losses_are_counted) {
  const Mesh mesh = plane_grid(4);
  const StorageAtlas before = storage_of(mesh, noise_map(64, CodeType::U8));
  for (const Transfer transfer : both_transfers) {
    for (const float pixels : {0.25F, 2.0F}) {
      const EditingChart chart = square_chart(mesh, before, pixels, transfer);
      const EditImages no_change = constant_edit(chart, Vec2f::Zero());
      StorageAtlas after = before;
      const PushResult result = update_storage(mesh, chart, no_change.edit(), Update::Point, after);
      const std::size_t lost = lost_texels(mesh, chart, no_change.edit().region, before);
      const std::size_t pixels_of_chart = chart.ids.triangle.size();
      EXPECT_EQ(result.changed + lost, 64U * 64U) << "every texel is seen";
      EXPECT_EQ(result.changed, std::min<std::size_t>(pixels_of_chart, 64U * 64U));
      EXPECT_EQ(lost == 0, pixels >= 1.0F);
    }
  }
}

TEST(StorageUpdate, keeps_to_the_region) {
  const Mesh mesh = plane_grid(4);
  const StorageAtlas before = storage_of(mesh, noise_map(64, CodeType::U8));
  const EditingChart chart = square_chart(mesh, before, 3.0F, Transfer::Point);
  const EditImages images = constant_edit(chart, {0.3F, 0.0F});
  ChartEdit edit = images.edit();
  edit.region = {48, 96, 72, 150};
  StorageAtlas after = before;
  const PushResult result = update_storage(mesh, chart, edit, Update::Area, after);
  EXPECT_EQ(result.changed, 8U * 18U);
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      EXPECT_EQ(after.sets[0].normals.edited(x, y), (Rect{16, 32, 24, 50}.contains(x, y)));
    }
  }
  edit.region = {};
  EXPECT_EQ(update_storage(mesh, chart, edit, Update::Area, after).changed, 0U);
  EXPECT_EQ(lost_texels(mesh, chart, edit.region, after), 0U);
}

TEST(StorageUpdate, mirrored_halves_and_views) {
  const Mesh mesh = mirrored_pair(4);
  const StorageAtlas before = storage_of(mesh, noise_map(64, CodeType::U16));
  const View front = framing_view(mesh, Vec3f::UnitZ());
  for (const View& view : {front, mirrored(front, 0, 0.2F)}) {
    const EditingChart chart = transfer_chart(mesh, before, view, 1.0F / 200.0F, Transfer::Point);
    const EditImages no_change = constant_edit(chart, Vec2f::Zero());
    StorageAtlas after = before;
    const PushResult result = update_storage(mesh, chart, no_change.edit(), Update::Point, after);
    EXPECT_EQ(result.changed, 64U * 64U);
    EXPECT_LT(largest_difference(before, after), 0.05);
  }
}

TEST(StorageUpdate, half_that_shares_its_texels) {
  const Mesh mesh = mirrored_pair(4);
  const StorageAtlas before = storage_of(mesh, noise_map(64, CodeType::U16));
  const View left = make_view(Vec3f::UnitZ(), Vec3f::UnitY(), {-0.5F, 0.5F, 0.0F}, 0.9F, 0.9F);
  for (const Transfer transfer : both_transfers) {
    const EditingChart chart = transfer_chart(mesh, before, left, 1.0F / 192.0F, transfer);
    const EditImages no_change = constant_edit(chart, Vec2f::Zero());
    StorageAtlas after = before;
    const PushResult result = update_storage(mesh, chart, no_change.edit(), Update::Point, after);
    EXPECT_GT(result.changed, 3000U);
    EXPECT_LT(result.largest_change, transfer == Transfer::Point ? 0.05F : 1.0F)
        << "the frame is that of the half that the chart shows";
  }
}

TEST(StorageUpdate, same_bits_for_any_number_of_threads) {
  const Mesh mesh = smooth_sphere(48, 24);
  const StorageAtlas before = storage_of(mesh, noise_map(256, CodeType::U16));
  const View view = framing_view(mesh, {0.5F, 0.3F, 0.8F});
  const EditingChart chart =
      transfer_chart(mesh, before, view, view.width / 700.0F, Transfer::Triangle);
  const EditImages images = constant_edit(chart, {0.1F, 0.2F}, 0.4F);
  for (const Update how : pixel_updates) {
    StorageAtlas many = before;
    update_storage(mesh, chart, images.edit(), how, many);
    const ThreadLimit limit(1);
    StorageAtlas one = before;
    update_storage(mesh, chart, images.edit(), how, one);
    EXPECT_TRUE(same_codes(many.sets[0].normals.encode(CodeType::F32, {}),
                           one.sets[0].normals.encode(CodeType::F32, {})));
  }
}

TEST(StorageUpdate, many_edits_that_change_nothing) {
  NORMALSHOP_SKIP_FIGURES();
  // Gathering writes nothing; writing pixels blurs a little more with every edit.
  const Mesh mesh = smooth_sphere(48, 24);
  const StorageAtlas before = storage_of(mesh, noise_map(256, CodeType::U8));
  StorageAtlas gathered = before;
  StorageAtlas written = before;
  Random random(5);
  for (int i = 0; i < 12; ++i) {
    const Vec3f direction(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(0.2F, 1));
    const View view = framing_view(mesh, direction.normalized());
    const auto edit_once = [&](StorageAtlas& storage, Update how) {
      const EditingChart chart =
          transfer_chart(mesh, storage, view, view.width / 300.0F, Transfer::Triangle);
      const EditImages no_change = constant_edit(chart, Vec2f::Zero());
      if (how == Update::Gather) return push(mesh, chart, no_change.edit(), storage);
      return update_storage(mesh, chart, no_change.edit(), how, storage);
    };
    EXPECT_EQ(edit_once(gathered, Update::Gather).changed, 0U);
    EXPECT_GT(edit_once(written, Update::Area).changed, 5000U);
  }
  EXPECT_FALSE(gathered.sets[0].normals.has_edits());
  EXPECT_TRUE(same_codes(gathered.sets[0].normals.encode(), before.sets[0].normals.codes()));
  EXPECT_GT(largest_difference(before, written), 5.0);
}

}  // namespace
}  // namespace normalshop
