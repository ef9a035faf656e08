#include "chart_fixtures.h"
#include "support/meshes.h"
#include "support/whole_texels.h"
#include <gtest/gtest.h>

#include "normalshop/chart/live_push.h"
#include "normalshop/chart/shared_cursor.h"

/// Charts that lie on each other in the atlas.
namespace normalshop::test {
namespace {

/// Squares of side 1 beside each other along x, all on one square of the map: each is turned by a
/// quarter more than the one before, every second one is mirrored.
Mesh stacked_squares(int count) {
  MeshBuilder builder;
  for (int i = 0; i < count; ++i) {
    const auto corner = [&](float x, float y) {
      Vec2f p(x - 0.5F, y - 0.5F);
      if (i % 2 == 1) p.x() = -p.x();
      for (int k = 0; k < i % 4; ++k) p = Vec2f(-p.y(), p.x());
      return MeshBuilder::Corner{{x + 1.2F * static_cast<float>(i), y, 0.0F},
                                 {0, 0, 1},
                                 {0.5F + 0.8F * p.x(), 0.5F - 0.8F * p.y()}};
    };
    builder.quad(corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1));
  }
  return builder.finish();
}

/// Straight from the front, `width` wide around x.
EditingChart front_chart(const Mesh& mesh, const StorageAtlas& storage, float x, float width) {
  const View view = make_view({0, 0, 1}, {0, 1, 0}, {x, 0.5F, 0}, width, 1.1F);
  return pull(mesh, storage, make_grid(view, 1.0F / 120));
}

constexpr int stack = 5;
const Vec2f slope_added{0.25F, -0.1F};

TEST(SharedTexels, take_the_edit_of_the_square_that_is_seen_once_and_wholly) {
  const Mesh mesh = stacked_squares(stack);
  for (int i = 0; i < stack; ++i) {
    StorageAtlas storage = storage_of(mesh, noise_map(96, CodeType::U16));
    StorageSet& set = storage.sets[0];
    EditingChart chart = front_chart(mesh, storage, 0.5F + 1.2F * static_cast<float>(i), 1.1F);
    PushResult result;
    const WholeTexels found = push_and_check(mesh, set, 0, chart, slope_added, result);
    EXPECT_EQ(found.strange + found.unshown + found.repeated + found.touched, 0U) << i;
    EXPECT_GT(found.written, 5500U) << i;
    EXPECT_EQ(found.shared, found.written) << i;
    EXPECT_EQ(result.shared, found.shared) << i;
    EXPECT_GT(result.changed, result.shared) << i << ": the gutter lies under none";
  }
}

TEST(SharedTexels, take_the_first_of_several_squares_that_are_seen) {
  const Mesh mesh = stacked_squares(stack);
  StorageAtlas storage = storage_of(mesh, noise_map(96, CodeType::U16));
  StorageAtlas first = storage;
  EditingChart all = front_chart(mesh, storage, 2.9F, 6.2F);
  EditingChart one = front_chart(mesh, first, 0.5F, 1.1F);
  PushResult result;
  const WholeTexels found = push_and_check(mesh, storage.sets[0], 0, all, slope_added, result);
  EXPECT_EQ(found.strange + found.unshown + found.repeated + found.touched, 0U);
  push_and_check(mesh, first.sets[0], 0, one, slope_added, result);
  float worst = 0.0F;
  for_texels(storage, [&](int x, int y, const SurfacePoint&) {
    const Vec3f apart = storage.sets[0].normals.normal(x, y) - first.sets[0].normals.normal(x, y);
    worst = std::max(worst, apart.norm());
  });
  EXPECT_LT(worst, 1e-4F);
}

/// A square of the map that two triangles alone share, of many.
TEST(SharedTexels, are_counted_by_every_way_of_pushing) {
  Mesh mesh = plane_two_charts(2);
  // The first quad's map lies on that of the right half, too.
  for (std::size_t c = 0; c < 6; ++c) mesh.uvs[c] += Vec2f(0.55F, -0.4F);
  const StorageAtlas before = storage_of(mesh, noise_map(128, CodeType::U8));
  EXPECT_FALSE(before.sets[0].texels.shared().empty());
  const EditingChart chart = chart_from(mesh, before, {0, 0, 1}, 200);
  const EditImages images = constant_edit(chart, slope_added);
  StorageAtlas storage = before;
  const PushResult pushed = push(mesh, chart, images.edit(), storage);
  std::size_t shared = 0;
  for_texels(storage, [&](int x, int y, const SurfacePoint&) {
    const bool several = covering(storage.sets[0].texels, x, y).size() > 1;
    shared += several && storage.sets[0].normals.edited(x, y) ? 1 : 0;
  });
  EXPECT_GT(shared, 300U);
  EXPECT_LT(shared, pushed.changed / 4);
  EXPECT_EQ(pushed.shared, shared);
  StorageAtlas live = before;
  LivePush drawn(mesh, live, chart, EditMode::View, images.change, {});
  drawn.update(images.change.rect(), live);
  EXPECT_EQ(drawn.result(live).shared, shared);
}

TEST(SharedTexels, are_none_without_overlaps) {
  const Mesh mesh = smooth_sphere(24, 12);
  StorageAtlas storage = storage_of(mesh, noise_map(96, CodeType::U8));
  const EditingChart chart = chart_from(mesh, storage, {0.3F, 0.2F, 1}, 120);
  EXPECT_EQ(push(mesh, chart, constant_edit(chart, slope_added).edit(), storage).shared, 0U);
}

TEST(SharedTexels, are_found_among_any) {
  std::vector<SharedTexel> shared;
  for (std::uint32_t t = 0; t < 4000; t += 1 + t % 7) {
    for (std::uint32_t k = 0; k <= t % 3; ++k) shared.push_back({t, k});
  }
  const auto holds = [&](std::uint32_t texel) {
    return std::any_of(shared.begin(), shared.end(),
                       [&](const SharedTexel& s) { return s.texel == texel; });
  };
  for (const std::uint32_t step : {1U, 3U, 64U, 1500U}) {
    SharedCursor cursor(shared);
    for (std::uint32_t t = step / 2; t < 5000; t += step) ASSERT_EQ(cursor.holds(t), holds(t)) << t;
  }
  shared.clear();
  EXPECT_FALSE(SharedCursor(shared).holds(0));
}

}  // namespace
}  // namespace normalshop::test
