#include "chart_fixtures.h"
#include "support/meshes.h"
#include <gtest/gtest.h>

#include "normalshop/chart/resolution.h"

/// A mirrored view of a model's mirror image is the view of the model: the same pixels, numbers and
/// codes, because mirroring in a coordinate plane only changes signs.
namespace normalshop::test {
namespace {

/// In the plane where x is 0. Faces keep their outside.
Mesh mirror_image(Mesh mesh) {
  for (Vec3f& p : mesh.positions) p.x() = -p.x();
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
    std::swap(mesh.normals[3 * t + 1], mesh.normals[3 * t + 2]);
    std::swap(mesh.uvs[3 * t + 1], mesh.uvs[3 * t + 2]);
    std::swap(mesh.tangents[3 * t + 1], mesh.tangents[3 * t + 2]);
  }
  for (Vec3f& n : mesh.normals) n.x() = -n.x();
  for (Vec4f& t : mesh.tangents) {
    t.x() = -t.x();
    t.w() = -t.w();
  }
  return mesh;
}

/// A model, its image, and a chart of either.
struct Pair {
  Mesh mesh = smooth_sphere(40, 20);
  Mesh image = mirror_image(mesh);
  StorageAtlas storage = storage_of(mesh, noise_map(256, CodeType::U16));
  StorageAtlas image_storage = storage_of(image, noise_map(256, CodeType::U16));
  View view = make_view({0.7F, 0.4F, 0.6F}, {0.2F, 1.0F, 0.1F}, {0.1F, 0.0F, 0.05F}, 1.6F, 1.2F);
  View mirrored_view = mirrored(view, 0, 0.0F);

  EditingChart chart(const View& from, const Mesh& of, const StorageAtlas& atlas) const {
    EditingChart out = pull(of, atlas, make_grid(from, 0.008F));
    compute_weight(out, {});
    return out;
  }
};

TEST(MirroredView, IsItsOwnInverse) {
  const Pair pair;
  EXPECT_EQ(pair.view.handedness(), 1.0F);
  EXPECT_EQ(pair.mirrored_view.handedness(), -1.0F);
  const View back = mirrored(pair.mirrored_view, 0, 0.0F);
  EXPECT_EQ(back.right, pair.view.right);
  EXPECT_EQ(back.center, pair.view.center);
  EXPECT_EQ(mirrored(pair.view, 1, 2.0F).center.y(), 4.0F);
}

TEST(MirroredView, SeesTheSame) {
  const Pair pair;
  const EditingChart chart = pair.chart(pair.view, pair.mesh, pair.storage);
  const EditingChart image = pair.chart(pair.mirrored_view, pair.image, pair.image_storage);
  int seen = 0;
  for (int y = 0; y < chart.grid.height(); ++y) {
    for (int x = 0; x < chart.grid.width(); ++x) {
      ASSERT_EQ(chart.ids.triangle(x, y), image.ids.triangle(x, y)) << x << ", " << y;
      ASSERT_NEAR(chart.weight(x, y), image.weight(x, y), 1e-5F);
      ASSERT_LT((chart.normal(x, y) - image.normal(x, y)).norm(), 1e-3F) << x << ", " << y;
      ASSERT_LT((chart.base_normal(x, y) - image.base_normal(x, y)).norm(), 1e-5F);
      seen += chart.weight(x, y) > 0.0F ? 1 : 0;
    }
  }
  EXPECT_GT(seen, 5000);
  const Vec2f low(-0.5F, -0.5F);
  EXPECT_NEAR(texel_pixel_size(pair.mesh, pair.storage, pair.view, low, -low),
              texel_pixel_size(pair.image, pair.image_storage, pair.mirrored_view, low, -low),
              1e-6F);
}

TEST(MirroredView, PushesTheSame) {
  for (const EditMode mode : {EditMode::View, EditMode::Base}) {
    Pair pair;
    const EditingChart chart = pair.chart(pair.view, pair.mesh, pair.storage);
    const EditingChart image = pair.chart(pair.mirrored_view, pair.image, pair.image_storage);
    const EditImages edit = constant_edit(chart, {0.4F, -0.2F}, 0.5F);
    const PushResult pushed = push(pair.mesh, chart, edit.edit(mode), pair.storage);
    EXPECT_EQ(push(pair.image, image, edit.edit(mode), pair.image_storage).changed, pushed.changed);
    EXPECT_GT(pushed.changed, 3000U);
    float most = 0.0F;
    for (int y = 0; y < 256; ++y) {
      for (int x = 0; x < 256; ++x) {
        most = std::max(most, (pair.storage.sets[0].normals.normal(x, y) -
                               pair.image_storage.sets[0].normals.normal(x, y))
                                  .norm());
      }
    }
    EXPECT_LT(most, 1e-4F);  // a code of 16 bits is 3e-5
  }
}

}  // namespace
}  // namespace normalshop::test
