#include <cmath>
#include <limits>

#include "chart_fixtures.h"
#include "support/meshes.h"
#include "support/same_codes.h"
#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "normalshop/core/parallel.h"
#include "normalshop/core/random.h"
#include "normalshop/core/sample.h"

namespace normalshop {
namespace {

using namespace test;

Vec3f random_direction(Random& random) {
  for (;;) {
    const Vec3f v(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    if (v.norm() > 0.1F && v.norm() < 1.0F) return v.normalized();
  }
}

TEST(Push, nothing_changes_nothing) {
  const Mesh mesh = uv_sphere(48, 24);
  Random random(9);
  for (const CodeType type : {CodeType::U8, CodeType::U16, CodeType::F32}) {
    StorageAtlas storage = storage_of(mesh, noise_map(256, type));
    const RawImage before = storage.sets[0].normals.encode();
    for (int i = 0; i < 20; ++i) {
      const EditingChart chart = chart_from(mesh, storage, random_direction(random), 200);
      const EditImages images = constant_edit(chart, {0, 0});
      const auto mode = i % 2 == 0 ? EditMode::View : EditMode::Base;
      EXPECT_EQ(push(mesh, chart, images.edit(mode), storage).changed, 0U);
    }
    EXPECT_FALSE(storage.sets[0].normals.has_edits());
    EXPECT_TRUE(same_codes(before, storage.sets[0].normals.encode()));
  }
}

TEST(Push, the_region_is_the_limit) {
  const Mesh mesh = plane_grid(4);
  StorageAtlas storage = storage_of(mesh, noise_map(256, CodeType::U8));
  const EditingChart chart = chart_from(mesh, storage, {0, 0, 1}, 300);
  EditImages images = constant_edit(chart, {0, 0});
  ChartEdit edit = images.edit();
  edit.region = {100, 90, 180, 160};
  for (int py = 90; py < 160; ++py) {
    for (int px = 100; px < 180; ++px) images.change(px, py) = Vec2f(0.3F, 0.0F);
  }
  EXPECT_GT(push(mesh, chart, edit, storage).changed, 1000U);
  int wrong = 0;
  for_texels(storage, [&](int x, int y, const SurfacePoint& p) {
    const Vec3f q = chart.grid.project(position_at(mesh, p));
    const bool inside = q.x() >= 100 && q.y() >= 90 && q.x() <= 179 && q.y() <= 159;
    const bool near = q.x() > 97 && q.y() > 87 && q.x() < 182 && q.y() < 162;
    const bool edited = storage.sets[0].normals.edited(x, y);
    wrong += (inside && !edited) || (!near && edited) ? 1 : 0;
  });
  EXPECT_EQ(wrong, 0);
}

/// A plate over the left half of another, 0.1 above it.
Mesh two_plates() {
  MeshBuilder builder;
  const auto plate = [&](float right, float z, float u) {
    const auto corner = [&](float x, float y) {
      return MeshBuilder::Corner{
          {x, y, z}, {0, 0, 1}, Vec2f(u + 0.45F * x, 0.05F + 0.45F * (1.0F - y))};
    };
    builder.quad(corner(0, 0), corner(right, 0), corner(right, 1), corner(0, 1));
  };
  plate(1.0F, 0.0F, 0.02F);
  plate(0.5F, 0.1F, 0.52F);
  return builder.finish();
}

TEST(Push, hidden_texels_keep_their_codes) {
  const Mesh mesh = two_plates();
  for (const Vec3f& direction : {Vec3f(0, 0, 1), Vec3f(0.3F, 0.2F, 1.0F)}) {
    StorageAtlas storage = storage_of(mesh, noise_map(512, CodeType::U16));
    const EditingChart chart = chart_from(mesh, storage, direction, 400);
    push(mesh, chart, constant_edit(chart, {0.2F, 0.1F}).edit(), storage);
    const Vec3f shift = 0.1F * direction / direction.z();  // where the plate's shadow falls
    int hidden = 0;
    int wrong = 0;
    int unreached = 0;
    for_texels(storage, [&](int x, int y, const SurfacePoint& p) {
      const bool edited = storage.sets[0].normals.edited(x, y);
      if (p.triangle >= 2) {
        unreached += edited ? 0 : 1;
        return;
      }
      const Vec3f q = position_at(mesh, p) + shift;
      const bool under = q.x() > 0 && q.x() < 0.5F && q.y() > 0 && q.y() < 1;
      hidden += under ? 1 : 0;
      wrong += under && edited ? 1 : 0;
    });
    EXPECT_GT(hidden, 15000);
    EXPECT_EQ(wrong, 0);
    EXPECT_LT(unreached, 900) << "texels on the step itself have no weight";
  }
}

/// A smooth cylinder of 8 sides, and a sleeve around the middle third of its length 5 pixels above
/// it. Cylinder first; u around, v along.
Mesh sleeved_cylinder(float gap) {
  MeshBuilder builder;
  const auto ring = [&](float radius, float y0, float y1, float v0, float v1) {
    for (int i = 0; i < 8; ++i) {
      const auto corner = [&](int k, float y, float v) {
        const float angle = 0.25F * 3.14159265F * static_cast<float>(k);
        const Vec3f n(std::sin(angle), 0.0F, std::cos(angle));
        return MeshBuilder::Corner{
            radius * n + Vec3f(0, y, 0), n, {0.02F + 0.12F * static_cast<float>(k), v}};
      };
      builder.quad(corner(i, y0, v1), corner(i + 1, y0, v1), corner(i + 1, y1, v0),
                   corner(i, y1, v0));
    }
  };
  ring(1.0F, -1.5F, 1.5F, 0.02F, 0.48F);
  ring(1.0F + gap, -0.5F, 0.5F, 0.52F, 0.98F);
  return builder.finish();
}

TEST(Push, what_a_sleeve_hides_keeps_its_codes) {
  const Mesh mesh = sleeved_cylinder(5.0F / 100.0F);
  StorageAtlas storage = storage_of(mesh, noise_map(512, CodeType::U8));
  const View view = make_view({0, 0, 1}, {0, 1, 0}, {0, 0, 0}, 3.2F, 3.2F);
  EditingChart chart = pull(mesh, storage, make_grid(view, 0.01F));
  compute_weight(chart, {});
  push(mesh, chart, constant_edit(chart, {0.2F, 0.1F}).edit(), storage);
  int hidden = 0;
  int wrong = 0;
  int seen = 0;
  int missed = 0;
  for_texels(storage, [&](int x, int y, const SurfacePoint& p) {
    const bool edited = storage.sets[0].normals.edited(x, y);
    const float z = base_normal_at(mesh, p).z();
    const float height = std::abs(position_at(mesh, p).y());
    if (p.triangle < 16 && z > 0.0F && height < 0.48F) {
      ++hidden;
      wrong += edited ? 1 : 0;
    }
    if (z > 0.4F && (p.triangle >= 16 || height > 0.55F) && height < 1.45F) {
      if (p.triangle >= 16 && height > 0.45F) return;  // beside the step the weight falls
      ++seen;
      missed += edited ? 0 : 1;
    }
  });
  EXPECT_GT(hidden, 15000);
  EXPECT_EQ(wrong, 0);
  EXPECT_GT(seen, 30000);
  EXPECT_EQ(missed, 0);
}

TEST(Push, back_faces_are_not_edited) {
  const Mesh mesh = plane_grid(2);
  StorageAtlas storage = storage_of(mesh, noise_map(64, CodeType::U8));
  const EditingChart chart = chart_from(mesh, storage, {0, 0.1F, -1}, 100);
  EXPECT_EQ(push(mesh, chart, constant_edit(chart, {0.5F, 0}).edit(), storage).changed, 0U);
}

/// A constant change on a plane seen askew: the analytic normal in both modes.
TEST(Push, a_constant_slope_gives_the_exact_normal) {
  const Mesh mesh = plane_grid(3);
  const Vec2f c(0.25F, -0.15F);
  for (const EditMode mode : {EditMode::View, EditMode::Base}) {
    StorageAtlas storage =
        storage_of(mesh, 128, NormalSpace::Tangent, [](const Vec3f&) { return Vec3f(0, 0, 1); });
    const EditingChart chart = chart_from(mesh, storage, {0.5F, 0.2F, 1}, 250);
    const PushResult result = push(mesh, chart, constant_edit(chart, c).edit(mode), storage);
    EXPECT_GE(result.changed, 128U * 128U);
    const View& view = chart.grid.view;
    const Vec3f n = view.to_chart({0, 0, 1});
    Vec3f truth(n.x() / n.z() - c.x(), n.y() / n.z() - c.y(), 1.0F);
    if (mode == EditMode::Base) {
      truth =
          (Vec3f(1, 0, -n.x() / n.z()) + c.x() * n).cross(Vec3f(0, 1, -n.y() / n.z()) + c.y() * n);
    }
    const Vec3f object = view.to_object(truth.normalized());
    double worst = 0.0;
    for_texels(storage, [&](int x, int y, const SurfacePoint& p) {
      worst = std::max(worst, angle_degrees(stored_normal(mesh, storage, x, y, p), object));
    });
    EXPECT_LT(worst, 1e-3);
    EXPECT_NEAR(result.largest_change, angle_degrees(object, {0, 0, 1}), 1e-3);
  }
}

TEST(Push, full_coverage_replaces_the_details) {
  const Mesh mesh = hemisphere(24, 48);
  for (const EditMode mode : {EditMode::View, EditMode::Base}) {
    StorageAtlas storage = storage_of(mesh, noise_map(256, CodeType::F32));
    const EditingChart chart = chart_from(mesh, storage, {0, 0, 1}, 300);
    push(mesh, chart, constant_edit(chart, {0.1F, 0.2F}, 1.0F).edit(mode), storage);
    double worst = 0.0;
    for_texels(storage, [&](int x, int y, const SurfacePoint& p) {
      const Vec3f base = chart.grid.view.to_chart(base_normal_at(mesh, p));
      if (base.z() < 0.52F) return;  // the weight falls
      const Vec2f wanted = base_gradient(base, mode) + Vec2f(0.1F, 0.2F);
      const Vec3f truth = normal_from_gradient(wanted, base, mode);
      const Vec3f now = chart.grid.view.to_chart(stored_normal(mesh, storage, x, y, p));
      worst = std::max(worst, angle_degrees(now, truth));
    });
    EXPECT_LT(worst, 0.01);
  }
}

/// Noise of single texels, under a chart four times coarser than the texels: it stays.
TEST(Push, details_finer_than_the_chart_survive) {
  const Mesh mesh = plane_grid(4);
  StorageAtlas storage = storage_of(mesh, noise_map(512, CodeType::F32));
  const StorageAtlas before = storage;
  const EditingChart chart = chart_from(mesh, storage, {0, 0, 1}, 128);
  EditImages images = constant_edit(chart, {0, 0});
  const auto wave = [&](const Vec2f& p) {
    return Vec2f(0.3F * std::sin(6.0F * p.x()), 0.3F * std::cos(5.0F * p.y()));
  };
  for (int y = 0; y < chart.grid.height(); ++y) {
    for (int x = 0; x < chart.grid.width(); ++x) {
      images.change(x, y) =
          wave(chart.grid.to_units({static_cast<float>(x), static_cast<float>(y)}));
    }
  }
  push(mesh, chart, images.edit(), storage);
  float worst = 0.0F;
  for_texels(storage, [&](int x, int y, const SurfacePoint& p) {
    const Vec2f was = slope_from_normal(before.sets[0].normals.normal(x, y));
    const Vec2f is = slope_from_normal(storage.sets[0].normals.normal(x, y));
    const Vec3f q = chart.grid.project(position_at(mesh, p));
    worst = std::max(worst, (is - was - wave(chart.grid.to_units(q.head<2>()))).norm());
  });
  EXPECT_LT(worst, 2e-3F);
}

/// Both halves show the same texels; the edit is seen on the left half alone.
TEST(Push, shared_texels_change_once) {
  const Mesh mesh = mirrored_pair(4);
  const Vec2f c(0.2F, 0.1F);
  for (const float side : {-1.0F, 1.0F}) {
    StorageAtlas storage =
        storage_of(mesh, 128, NormalSpace::Tangent, [](const Vec3f&) { return Vec3f(0, 0, 1); });
    const View view = make_view({0, 0, 1}, {0, 1, 0}, {0.5F * side, 0.5F, 0}, 0.8F, 0.8F);
    EditingChart chart = pull(mesh, storage, make_grid(view, 1.0F / 160));
    compute_weight(chart, {});
    const PushResult result = push(mesh, chart, constant_edit(chart, c).edit(), storage);
    // Mirrored texels hold the mirrored slope, so that the edited half reads c.
    const Vec3f truth = normal_from_slope({side * c.x(), c.y()});
    EXPECT_GT(result.changed, 5000U) << side;
    EXPECT_LE(result.changed, 128U * 128U) << side;
    EXPECT_NEAR(result.largest_change, angle_degrees(truth, {0, 0, 1}), 1e-3) << side;
    EXPECT_LT(angle_degrees(storage.sets[0].normals.normal(64, 64), truth), 1e-3) << side;
  }
  // Seen at once: the first triangle's edit, not twice.
  StorageAtlas storage =
      storage_of(mesh, 128, NormalSpace::Tangent, [](const Vec3f&) { return Vec3f(0, 0, 1); });
  const EditingChart chart = chart_from(mesh, storage, {0, 0, 1}, 300);
  const PushResult result = push(mesh, chart, constant_edit(chart, c).edit(), storage);
  EXPECT_EQ(result.changed, 128U * 128U);
  EXPECT_LT(angle_degrees(storage.sets[0].normals.normal(64, 64), normal_from_slope(c)), 1e-3);
}

/// The owner is all but edge-on, the mirrored half faces the viewer: what is seen decides.
TEST(Push, of_shared_texels_the_half_seen_squarely_decides) {
  Mesh mesh = mirrored_pair(4);
  const float angle = 70.0F * 3.14159265F / 180.0F;
  const Vec3f along(std::cos(angle), 0.0F, -std::sin(angle));
  for (Vec3f& p : mesh.positions) {
    if (p.x() > 0.0F) p = p.x() * along + Vec3f(0.0F, p.y(), 0.0F);
  }
  for (std::size_t c = 0; c < 3 * 32; ++c) {
    mesh.normals[c] = Vec3f(std::sin(angle), 0.0F, std::cos(angle));
    mesh.tangents[c].head<3>() = along;
  }
  StorageAtlas storage = storage_of(mesh, flat_normal_map(128, 128, CodeType::F32));
  const EditingChart chart = chart_from(mesh, storage, {0, 0, 1}, 300);
  const Vec2f c(0.2F, 0.1F);
  const PushResult result = push(mesh, chart, constant_edit(chart, c).edit(), storage);
  const Vec3f truth = normal_from_slope({-c.x(), c.y()});
  double worst = 0.0;
  for_texels(storage, [&](int x, int y, const SurfacePoint& p) {
    EXPECT_LT(p.triangle, 32U);
    if (x < 3) return;  // pixels of the fold show both
    worst = std::max(worst, angle_degrees(storage.sets[0].normals.normal(x, y), truth));
  });
  EXPECT_LT(worst, 1e-3);
  EXPECT_EQ(result.changed, 128U * 128U);
  EXPECT_NEAR(result.largest_change, angle_degrees(truth, {0, 0, 1}), 1e-3);
}

TEST(Push, uvs_wrap_around) {
  Mesh mesh = plane_grid(4);
  for (Vec2f& uv : mesh.uvs) uv = 0.8F * uv + Vec2f(-0.4F, 2.7F);  // over both borders of the map
  StorageAtlas storage =
      storage_of(mesh, 128, NormalSpace::Tangent, [](const Vec3f&) { return Vec3f(0, 0, 1); });
  const EditingChart chart = chart_from(mesh, storage, {0, 0, 1}, 250);
  push(mesh, chart, constant_edit(chart, {0.3F, 0.0F}).edit(), storage);
  const Vec3f truth = normal_from_slope({0.3F, 0.0F});
  int texels = 0;
  double worst = 0.0;
  for_texels(storage, [&](int x, int y, const SurfacePoint&) {
    ++texels;
    worst = std::max(worst, angle_degrees(storage.sets[0].normals.normal(x, y), truth));
  });
  EXPECT_GT(texels, 10000);
  EXPECT_LT(worst, 1e-3);
}

/// Every texel that faces the viewer is reached, whatever the chart's resolution; none beyond.
TEST(Push, every_texel_of_the_effective_chart_is_reached) {
  for (const int side : {90, 250, 600}) {
    for (const Vec3f& direction : {Vec3f(0, 0, 1), Vec3f(0.7F, 0.3F, 0.4F)}) {
      const Mesh mesh = uv_sphere(64, 32);
      StorageAtlas storage = storage_of(mesh, flat_normal_map(256, 256, CodeType::U8));
      const EditingChart chart = chart_from(mesh, storage, direction, side);
      push(mesh, chart, constant_edit(chart, {0.1F, 0}).edit(), storage);
      int missed = 0;
      int beyond = 0;
      int reached = 0;
      for_texels(storage, [&](int x, int y, const SurfacePoint& p) {
        const float z = chart.grid.view.to_chart(base_normal_at(mesh, p)).z();
        const bool edited = storage.sets[0].normals.edited(x, y);
        reached += z > 0.4F ? 1 : 0;
        missed += z > 0.4F && !edited ? 1 : 0;  // weight above 0.5
        beyond += z < 0.05F && edited ? 1 : 0;  // weight 0 at 0.26, a pixel of the coarsest inward
      });
      EXPECT_GT(reached, 10000);
      EXPECT_EQ(missed, 0) << side;
      EXPECT_EQ(beyond, 0) << side;
    }
  }
}

/// A plate with rims at random places and turns: up to the rim, the whole change.
TEST(Push, an_open_rim_takes_the_whole_change) {
  const Mesh mesh = plane_grid(2);
  Random random(12);
  for (int i = 0; i < 10; ++i) {
    StorageAtlas storage =
        storage_of(mesh, 200, NormalSpace::Tangent, [](const Vec3f&) { return Vec3f(0, 0, 1); });
    const Vec3f up(random.uniform(-1, 1), random.uniform(-1, 1), 0);
    const Vec3f center(0.5F + random.uniform(0, 0.01F), 0.5F + random.uniform(0, 0.01F), 0);
    const View view = make_view({0, 0, 1}, up, center, 1.6F, 1.6F);
    EditingChart chart = pull(mesh, storage, make_grid(view, 1.0F / 230));
    compute_weight(chart, {});
    push(mesh, chart, constant_edit(chart, {0.3F, 0.1F}).edit(), storage);
    const Vec3f truth = view.to_object(normal_from_slope({0.3F, 0.1F}));
    double worst = 0.0;
    for_texels(storage, [&](int x, int y, const SurfacePoint& p) {
      const Vec3f q = position_at(mesh, p);
      if (std::min({q.x(), q.y(), 1 - q.x(), 1 - q.y()}) < 0.004F) return;
      worst = std::max(worst, angle_degrees(storage.sets[0].normals.normal(x, y), truth));
    });
    EXPECT_LT(worst, 1e-3);
  }
}

TEST(Push, changes_that_are_not_finite_are_not_written) {
  const Mesh mesh = plane_grid(2);
  for (int bad = 0; bad < 3; ++bad) {
    StorageAtlas storage = storage_of(mesh, noise_map(64, CodeType::U8));
    const EditingChart chart = chart_from(mesh, storage, {0, 0, 1}, 100);
    EditImages images = constant_edit(chart, {0.3F, 0.1F});
    images.coverage = MaskImage(chart.grid.width(), chart.grid.height(), 0.5F);
    if (bad == 0) images.change(50, 40).x() = std::nanf("");
    if (bad == 1) images.change(50, 40).y() = -std::numeric_limits<float>::infinity();
    if (bad == 2) images.coverage(50, 40) = std::nanf("");
    push(mesh, chart, images.edit(), storage);
    const NormalMap& map = storage.sets[0].normals;
    for_texels(storage, [&](int x, int y, const SurfacePoint&) {
      ASSERT_TRUE(map.vector(x, y).allFinite());
    });
    EXPECT_GT(map.edited_count(), 64U * 64U - 30U);
    EXPECT_LT(map.edited_count(), 64U * 64U);
  }
}

TEST(Push, frames_without_a_tangent_still_hold_a_normal) {
  Mesh mesh = plane_grid(2);
  for (Vec4f& t : mesh.tangents) t = {0, 0, 1, 1};  // along the normal
  StorageAtlas storage = storage_of(mesh, noise_map(64, CodeType::U8));
  const EditingChart chart = chart_from(mesh, storage, {0, 0, 1}, 100);
  push(mesh, chart, constant_edit(chart, {0.3F, 0.1F}).edit(), storage);
  for_texels(storage, [&](int x, int y, const SurfacePoint&) {
    ASSERT_NEAR(storage.sets[0].normals.normal(x, y).norm(), 1.0F, 1e-4F);
  });
}

TEST(Push, threads_change_nothing) {
  const Mesh mesh = uv_sphere(96, 48);
  const StorageAtlas start = storage_of(mesh, noise_map(512, CodeType::U8));
  const auto edited = [&] {
    StorageAtlas storage = start;
    for (const Vec3f& direction : {Vec3f(0, 0.2F, 1), Vec3f(0.5F, 0, 1)}) {
      const EditingChart chart = chart_from(mesh, storage, direction, 400);
      push(mesh, chart, constant_edit(chart, {0.2F, 0.3F}, 0.5F).edit(EditMode::Base), storage);
    }
    return storage.sets[0].normals.encode(CodeType::F32, storage.sets[0].normals.convention());
  };
  const RawImage many = edited();
  const ThreadLimit limit(1);
  EXPECT_TRUE(same_codes(many, edited()));
}

}  // namespace
}  // namespace normalshop
