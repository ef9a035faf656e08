#include <cmath>

#include "chart_fixtures.h"
#include "support/meshes.h"
#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "normalshop/core/random.h"

/// Displacement along any fixed direction.
namespace normalshop {
namespace {

using namespace test;

Vec3f random_unit(Random& random) {
  for (;;) {
    const Vec3f v(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    if (v.norm() > 0.1F && v.norm() < 1.0F) return v.normalized();
  }
}

/// A base normal that the viewer sees, and a direction and a normal on its front side.
struct Place {
  Vec3f base;
  Vec3f along;
  Vec3f normal;
};

Place random_place(Random& random) {
  for (;;) {
    Place p{random_unit(random), random_unit(random), {}};
    p.normal = (p.base + 0.6F * random_unit(random)).normalized();
    const bool defined = p.along.dot(p.base) > 0.25F && p.along.dot(p.normal) > 0.25F;
    if (p.base.z() > 0.26F && defined) return p;
  }
}

TEST(Direction, identity_returns_the_normal) {
  Random random(1);
  double worst = 0.0;
  for (int i = 0; i < 20000; ++i) {
    const Place p = random_place(random);
    const EditDirection d(p.along);
    const Vec2f h = gradient_from_normal(p.normal, p.base, d);
    worst = std::max(worst, angle_degrees(normal_from_gradient(h, p.base, d), p.normal));
    ASSERT_LT(gradient_from_normal(p.base, p.base, d).norm(), 1e-5F);
    ASSERT_EQ(base_gradient(p.base, d), Vec2f(0, 0));
  }
  EXPECT_LT(worst, 1e-5);
}

/// A plane displaced along d by a linear height: b + h d has exactly the normal f_u x f_v.
TEST(Direction, is_that_of_a_displaced_plane) {
  Random random(2);
  for (int i = 0; i < 2000; ++i) {
    const Place p = random_place(random);
    const Vec3d b = p.base.cast<double>();
    const Vec2d h(random.uniform(-1, 1), random.uniform(-1, 1));
    const Vec3d d = p.along.cast<double>();
    const Vec3d fu = Vec3d(1, 0, -b.x() / b.z()) + h.x() * d;
    const Vec3d fv = Vec3d(0, 1, -b.y() / b.z()) + h.y() * d;
    const Vec3f truth = fu.cross(fv).normalized().cast<float>();
    const EditDirection along(p.along);
    ASSERT_LT(angle_degrees(normal_from_gradient(h.cast<float>(), p.base, along), truth), 1e-3);
  }
}

TEST(Direction, has_the_other_modes_as_special_cases) {
  Random random(3);
  for (int i = 0; i < 2000; ++i) {
    const Place p = random_place(random);
    const EditDirection normal(p.base);
    const Vec2f h = gradient_from_normal(p.normal, p.base, EditMode::Base);
    ASSERT_LT((gradient_from_normal(p.normal, p.base, normal) - h).norm(), 1e-4F * (1 + h.norm()));
    ASSERT_LT(angle_degrees(normal_from_gradient(h, p.base, normal),
                            normal_from_gradient(h, p.base, EditMode::Base)),
              1e-4);
    if (p.normal.z() < 0.1F) continue;
    const EditDirection viewer(Vec3f(0, 0, 1));
    const Vec2f slope = slope_from_normal(p.normal);
    const Vec2f above = slope - slope_from_normal(p.base);
    ASSERT_LT((gradient_from_normal(p.normal, p.base, viewer) - above).norm(),
              1e-5F * (1 + slope.norm()));
    ASSERT_LT(angle_degrees(normal_from_gradient(above, p.base, viewer), p.normal), 1e-4);
  }
}

/// Thesis 4.8: the tangent plane method gives what the change of basis gives: rotate so that d is
/// up, take slopes, combine, go back.
TEST(Direction, equals_the_change_of_basis) {
  Random random(4);
  double worst = 0.0;
  for (int i = 0; i < 5000; ++i) {
    const Place p = random_place(random);
    const Vec3f other = (p.base + 0.4F * random_unit(random)).normalized();
    if (p.along.dot(other) < 0.25F) continue;
    const Vec3d d = p.along.cast<double>().normalized();
    const Eigen::Matrix3d turn =
        Eigen::Quaterniond::FromTwoVectors(d, Vec3d::UnitZ()).toRotationMatrix();
    const auto slope = [&](const Vec3f& n) {
      const Vec3d t = turn * n.cast<double>().normalized();
      return Vec2d(-t.x() / t.z(), -t.y() / t.z());
    };
    const double a = random.uniform(-0.3F, 0.8F);
    const double b = random.uniform(-0.3F, 0.8F);
    const Vec2d below = slope(p.base);
    const Vec2d s = below + a * (slope(p.normal) - below) + b * (slope(other) - below);
    const Vec3d truth = turn.transpose() * Vec3d(-s.x(), -s.y(), 1).normalized();
    const EditDirection along(p.along);
    const Vec2f h = (a * gradient_from_normal(p.normal, p.base, along).cast<double>() +
                     b * gradient_from_normal(other, p.base, along).cast<double>())
                        .cast<float>();
    worst =
        std::max(worst, angle_degrees(normal_from_gradient(h, p.base, along), truth.cast<float>()));
  }
  EXPECT_LT(worst, 1e-5);
}

/// The sphere of radius 1 with noise, from the front.
struct PushedSphere {
  Mesh mesh = smooth_sphere(48, 24);
  StorageAtlas before = storage_of(mesh, noise_map(128, CodeType::F32));
  EditingChart chart = chart_from(mesh, before, {0, 0, 1}, 200);
};

TEST(Direction, push_makes_what_the_formula_says) {
  const PushedSphere sphere;
  const View& view = sphere.chart.grid.view;
  for (const Vec3f& d : {Vec3f(0.4F, 0.5F, 0.8F), Vec3f(-0.7F, 0.1F, 0.4F)}) {
    const EditDirection along(d);
    EditingChart chart = pull(sphere.mesh, sphere.before, sphere.chart.grid);
    compute_weight(chart, {});
    ASSERT_TRUE(limit_weight(chart, {}, along.along, chart.weight.rect()));
    const Vec2f change(0.15F, -0.1F);
    StorageAtlas storage = sphere.before;
    const PushResult pushed =
        push(sphere.mesh, chart, constant_edit(chart, change, 0.4F).edit(along), storage);
    EXPECT_GT(pushed.changed, 800U);
    int inside = 0;
    for_texels(storage, [&](int x, int y, const SurfacePoint& at) {
      const Vec3f base = view.to_chart(position_at(sphere.mesh, at).normalized());
      if (base.dot(along.along) < 0.0F) {
        ASSERT_FALSE(storage.sets[0].normals.edited(x, y));
      }
      if (base.z() < 0.55F || base.dot(along.along) < 0.55F) return;
      ++inside;
      const Vec3f old = view.to_chart(stored_normal(sphere.mesh, sphere.before, x, y, at));
      const Vec3f smooth = frame_at(sphere.mesh, at, NormalSpace::Object).object_normal(base);
      ASSERT_LT((smooth - base).norm(), 1e-4F);
      const Vec2f h = 0.6F * gradient_from_normal(old, base, along) + change;
      const Vec3f truth = normal_from_gradient(h, base, along);
      ASSERT_LT(angle_degrees(view.to_chart(stored_normal(sphere.mesh, storage, x, y, at)), truth),
                0.05)
          << x << ", " << y;
    });
    EXPECT_GT(inside, 500);
  }
}

TEST(Direction, along_the_view_pushes_what_the_view_mode_pushes) {
  const PushedSphere sphere;
  const EditImages images = constant_edit(sphere.chart, {0.2F, 0.1F}, 0.3F);
  StorageAtlas view = sphere.before;
  StorageAtlas along = sphere.before;
  const PushResult a = push(sphere.mesh, sphere.chart, images.edit(EditMode::View), view);
  const PushResult b =
      push(sphere.mesh, sphere.chart, images.edit(EditDirection(Vec3f(0, 0, 2))), along);
  EXPECT_EQ(a.changed, b.changed);
  float most = 0.0F;
  for_texels(view, [&](int x, int y, const SurfacePoint& at) {
    // Those at the horizon count as on it in ways of their own.
    const Vec3f old = stored_normal(sphere.mesh, sphere.before, x, y, at);
    if (old.dot(sphere.chart.grid.view.direction) < 0.05F) return;
    most = std::max(
        most, (view.sets[0].normals.normal(x, y) - along.sets[0].normals.normal(x, y)).norm());
  });
  EXPECT_LT(most, 2e-6F);
}

/// The weight falls to nothing before the direction's horizon.
TEST(Direction, fades_towards_its_horizon) {
  const PushedSphere sphere;
  EditingChart chart = pull(sphere.mesh, sphere.before, sphere.chart.grid);
  compute_weight(chart, {});
  const MaskImage all = chart.weight;
  const Vec3f d = Vec3f(0.8F, 0, 0.6F);
  ASSERT_TRUE(limit_weight(chart, {}, d, all.rect()));
  const FacingWeight facing({});
  for (int y = 0; y < all.height(); ++y) {
    for (int x = 0; x < all.width(); ++x) {
      ASSERT_EQ(chart.weight(x, y), std::min(all(x, y), facing(chart.base_normal(x, y).dot(d))));
    }
  }
  EXPECT_EQ(facing(std::cos(1.31F)), 0.0F);
  EXPECT_EQ(facing(1.0F), 1.0F);
  MaskImage same = all;
  chart.weight = all;
  EXPECT_TRUE(limit_weight(chart, {}, Vec3f(0, 0, 1), all.rect()));
  for (int y = 0; y < all.height(); ++y) {
    for (int x = 0; x < all.width(); ++x) ASSERT_EQ(chart.weight(x, y), same(x, y));
  }
  EXPECT_FALSE(limit_weight(chart, {}, Vec3f(0, 0, -1), all.rect()));
}

/// Beside the hard edges of a cube no side that turns away takes the weight of its neighbour.
TEST(Direction, sides_that_turn_away_keep_their_codes) {
  const Mesh mesh = cube();
  const StorageAtlas before = storage_of(mesh, noise_map(96, CodeType::U8));
  EditingChart chart = chart_from(mesh, before, {1, 1, 1}, 200);
  const EditDirection along(chart.grid.view.to_chart(Vec3f(1, 0, -0.2F)));
  ASSERT_TRUE(limit_weight(chart, {}, along.along, chart.weight.rect()));
  StorageAtlas storage = before;
  push(mesh, chart, constant_edit(chart, {0.3F, 0.3F}).edit(along), storage);
  int edited = 0;
  for_texels(storage, [&](int x, int y, const SurfacePoint& at) {
    if (!storage.sets[0].normals.edited(x, y)) return;
    ++edited;
    const Vec3f base = frame_at(mesh, at, NormalSpace::Tangent).object_normal(Vec3f::UnitZ());
    ASSERT_GT(base.x(), 0.9F) << x << ", " << y;
  });
  EXPECT_GT(edited, 300);
}

}  // namespace
}  // namespace normalshop
