#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "chart_fixtures.h"
#include "support/meshes.h"
#include <gtest/gtest.h>

#include "normalshop/chart/live_push.h"
#include "normalshop/core/parallel.h"
#include "normalshop/core/random.h"

namespace normalshop {
namespace {

using namespace test;

/// What a dab of a brush at a random place makes of an edit: more, or nothing again.
Rect dab(Random& random, int radius, EditImages& images) {
  const auto at = [&](int size) {
    return static_cast<int>(random.uniform(0.0F, 1.0F) * static_cast<float>(size));
  };
  const int cx = at(images.change.width());
  const int cy = at(images.change.height());
  const bool erases = random.uniform(0.0F, 1.0F) < 0.25F;
  const float fall = random.uniform(-0.4F, 0.4F);
  const Rect around =
      intersect({cx - radius, cy - radius, cx + radius + 1, cy + radius + 1}, images.change.rect());
  for (int y = around.y0; y < around.y1; ++y) {
    for (int x = around.x0; x < around.x1; ++x) {
      const int squared = (x - cx) * (x - cx) + (y - cy) * (y - cy);
      if (squared > radius * radius) continue;
      const float share = 1.0F - static_cast<float>(squared) / static_cast<float>(radius * radius);
      images.change(x, y) = erases ? Vec2f(0, 0) : Vec2f(share * fall, 0.1F * share);
      if (!images.coverage.empty()) images.coverage(x, y) = erases ? 0.0F : share;
    }
  }
  return around;
}

/// Texels whose normals differ in any bit, or that one map alone has edited.
int differing(const StorageAtlas& a, const StorageAtlas& b) {
  int count = 0;
  const NormalMap& p = a.sets[0].normals;
  const NormalMap& q = b.sets[0].normals;
  for (int y = 0; y < p.height(); ++y) {
    for (int x = 0; x < p.width(); ++x) {
      const bool same = p.edited(x, y) == q.edited(x, y) && p.vector(x, y) == q.vector(x, y);
      count += same ? 0 : 1;
    }
  }
  return count;
}

struct LiveCase {
  std::string name;
  Mesh mesh;
  StorageAtlas storage;
  Vec3f direction;
};

/// Seams, texels that both sides of a mirrored model share, repeating maps, other spaces.
std::vector<LiveCase> live_cases() {
  std::vector<LiveCase> cases;
  const auto add = [&](const char* name, const Mesh& mesh, StorageAtlas storage,
                       const Vec3f& direction) {
    cases.push_back({name, mesh, std::move(storage), direction});
  };
  const Mesh sphere = smooth_sphere(24, 12);
  add("sphere", sphere, storage_of(sphere, noise_map(128, CodeType::U8)), {0.9F, 0.3F, 0.2F});
  const NormalAt outward = [](const Vec3f& p) { return Vec3f(p.normalized()); };
  add("object space", sphere, storage_of(sphere, 128, NormalSpace::Object, outward), {0, 0, 1});
  const Mesh pair = mirrored_pair(4);
  add("mirrored", pair, storage_of(pair, noise_map(128, CodeType::U16)), {0.2F, 0.1F, 1.0F});
  Mesh repeated = plane_grid(3);
  for (Vec2f& uv : repeated.uvs) uv = 1.7F * uv + Vec2f(0.3F, -0.6F);
  add("repeating", repeated, storage_of(repeated, noise_map(100, CodeType::U8)), {0, 0, 1});
  return cases;
}

TEST(LivePush, is_after_every_dab_what_a_push_of_all_is) {
  for (LiveCase& c : live_cases()) {
    for (const EditDirection& direction :
         {EditDirection(EditMode::View), EditDirection(EditMode::Base),
          EditDirection(Vec3f(0.4F, -0.2F, 0.9F))}) {
      // What was edited before stays below.
      const EditingChart earlier = chart_from(c.mesh, c.storage, c.direction, 60);
      push(c.mesh, earlier, constant_edit(earlier, {0.1F, 0.0F}).edit(), c.storage);
      const EditingChart chart = chart_from(c.mesh, c.storage, c.direction, 120);
      EditImages images = constant_edit(chart, {0, 0});
      if (direction.mode == EditMode::Base) {
        images.coverage = MaskImage(images.change.width(), images.change.height(), 0.0F);
      }
      StorageAtlas live = c.storage;
      LivePush pushed(c.mesh, live, chart, direction, images.change, images.coverage);
      Random random(5);
      PushResult batch;
      for (int i = 0; i < 12; ++i) {
        pushed.update(dab(random, 14, images), live);
        StorageAtlas whole = c.storage;
        batch = push(c.mesh, chart, images.edit(direction), whole);
        EXPECT_EQ(differing(live, whole), 0) << c.name << ", dab " << i;
      }
      EXPECT_GT(batch.changed, 100U) << c.name;
      EXPECT_EQ(pushed.result(live).changed, batch.changed) << c.name;
      EXPECT_NEAR(pushed.result(live).largest_change, batch.largest_change, 0.3F)
          << c.name << ": a push grows gutter texels anew before it turns them";
      pushed.restore(live);
      EXPECT_EQ(differing(live, c.storage), 0) << c.name;
    }
  }
}

TEST(LivePush, tells_the_tiles_that_look_different) {
  const Mesh mesh = plane_grid(2);
  StorageAtlas live = storage_of(mesh, noise_map(512, CodeType::U8));
  const EditingChart chart = chart_from(mesh, live, {0, 0, 1}, 512);
  EditImages images = constant_edit(chart, {0, 0});
  LivePush pushed(mesh, live, chart, EditMode::View, images.change, {});
  EXPECT_TRUE(pushed.update(images.change.rect(), live).empty()) << "nothing is drawn yet";
  const Vec2f middle(0.5F * static_cast<float>(chart.grid.width()),
                     0.5F * static_cast<float>(chart.grid.height()));
  const auto x = static_cast<int>(middle.x());
  const auto y = static_cast<int>(middle.y());
  images.change(x, y) = Vec2f(0.2F, 0.0F);
  const StorageAtlas before = live;
  const std::vector<MapTile> tiles = pushed.update({x, y, x + 1, y + 1}, live);
  EXPECT_FALSE(tiles.empty());
  EXPECT_LE(tiles.size(), 4U) << "a dot in the middle of 64 tiles";
  for (int ty = 0; ty < 512; ++ty) {
    for (int tx = 0; tx < 512; ++tx) {
      if (!live.sets[0].normals.edited(tx, ty)) continue;
      const MapTile tile{0, tx / NormalMap::tile_size, ty / NormalMap::tile_size};
      EXPECT_NE(std::find(tiles.begin(), tiles.end(), tile), tiles.end());
    }
  }
  images.change(x, y) = Vec2f(0.0F, 0.0F);
  EXPECT_EQ(pushed.update({x, y, x + 1, y + 1}, live), tiles) << "where it is taken back";
  EXPECT_EQ(differing(live, before), 0);
}

TEST(LivePush, is_the_same_for_one_thread) {
  const Mesh mesh = smooth_sphere(24, 12);
  const StorageAtlas storage = storage_of(mesh, noise_map(128, CodeType::U8));
  const EditingChart chart = chart_from(mesh, storage, {0.9F, 0.3F, 0.2F}, 120);
  const auto make = [&] {
    StorageAtlas live = storage;
    EditImages images = constant_edit(chart, {0, 0});
    LivePush pushed(mesh, live, chart, EditMode::View, images.change, {});
    Random random(5);
    for (int i = 0; i < 8; ++i) pushed.update(dab(random, 20, images), live);
    return live;
  };
  const StorageAtlas many = make();
  const ThreadLimit limit(1);
  EXPECT_EQ(differing(many, make()), 0);
}

TEST(LivePush, survives_what_is_not_there) {
  const Mesh mesh = plane_grid(1);
  StorageAtlas live = storage_of(mesh, noise_map(64, CodeType::U8));
  const EditingChart chart = chart_from(mesh, live, {0, 0, 1}, 80);
  EditImages images = constant_edit(chart, {0, 0});
  LivePush pushed(mesh, live, chart, EditMode::View, images.change, {});
  EXPECT_TRUE(pushed.update({}, live).empty());
  EXPECT_TRUE(pushed.update({-50, -50, -10, -10}, live).empty());
  images.change(40, 40) = Vec2f(std::nanf(""), 0.0F);
  pushed.update({-5, -5, 1000, 1000}, live);
  EXPECT_FALSE(live.sets[0].normals.has_edits()) << "what is no number changes nothing";
}

}  // namespace
}  // namespace normalshop
