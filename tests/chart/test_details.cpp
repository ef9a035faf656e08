#include <cmath>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "normalshop/chart/details.h"
#include "normalshop/core/random.h"

namespace normalshop {
namespace {

Vec3f direction(Random& random, float least_z) {
  for (;;) {
    const Vec3f v(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    if (v.norm() > 0.1F && v.norm() < 1.0F && v.z() > least_z * v.norm()) return v.normalized();
  }
}

TEST(Details, identity_returns_the_normal_at_any_tilt) {
  Random random(1);
  double worst_view = 0.0;
  double worst_base = 0.0;
  for (int i = 0; i < 20000; ++i) {
    const Vec3f base = direction(random, 0.26F);
    const Vec3f n = (base + 0.6F * direction(random, -1.0F)).normalized();
    const Vec2f h = gradient_from_normal(n, base, EditMode::Base);
    worst_base =
        std::max(worst_base, angle_degrees(normal_from_gradient(h, base, EditMode::Base), n));
    if (n.z() < 0.1F) continue;
    const Vec2f s = gradient_from_normal(n, base, EditMode::View);
    worst_view =
        std::max(worst_view, angle_degrees(normal_from_gradient(s, base, EditMode::View), n));
  }
  EXPECT_LT(worst_view, 1e-5);
  EXPECT_LT(worst_base, 1e-5);
}

/// A plane displaced along its normal: the surface b + h N has exactly the normal f_u x f_v.
TEST(Details, base_gradient_is_that_of_a_displaced_plane) {
  Random random(2);
  for (int i = 0; i < 1000; ++i) {
    const Vec3d n = direction(random, 0.2F).cast<double>();
    const Vec2d h(random.uniform(-1, 1), random.uniform(-1, 1));
    const Vec3d fu = Vec3d(1, 0, -n.x() / n.z()) + h.x() * n;
    const Vec3d fv = Vec3d(0, 1, -n.y() / n.z()) + h.y() * n;
    const Vec3f truth = fu.cross(fv).normalized().cast<float>();
    const Vec3f base = n.cast<float>();
    ASSERT_LT(angle_degrees(normal_from_gradient(h.cast<float>(), base, EditMode::Base), truth),
              1e-3);
    const Vec2f back = gradient_from_normal(truth, base, EditMode::Base);
    ASSERT_LT((back - h.cast<float>()).norm(), 2e-4F * static_cast<float>(1.0 / n.z()));
  }
}

TEST(Details, turning_the_view_turns_the_gradient) {
  Random random(3);
  for (const EditMode mode : {EditMode::View, EditMode::Base}) {
    for (int i = 0; i < 500; ++i) {
      const float angle = random.uniform(0, 6.28F);
      const Mat3f turn = Eigen::AngleAxisf(angle, Vec3f::UnitZ()).toRotationMatrix();
      const Vec3f base = direction(random, 0.3F);
      const Vec3f n = (base + 0.4F * direction(random, -1.0F)).normalized();
      if (n.z() < 0.2F) continue;
      const Vec2f there = gradient_from_normal(turn * n, turn * base, mode);
      const Vec2f here = turn.topLeftCorner<2, 2>() * gradient_from_normal(n, base, mode);
      ASSERT_LT((there - here).norm(), 1e-4F * (1.0F + here.norm()));
    }
  }
}

TEST(Details, both_modes_agree_where_the_base_faces_the_viewer) {
  Random random(4);
  for (int i = 0; i < 500; ++i) {
    const Vec3f n = direction(random, 0.2F);
    const Vec2f view = gradient_from_normal(n, Vec3f::UnitZ(), EditMode::View);
    const Vec2f base = gradient_from_normal(n, Vec3f::UnitZ(), EditMode::Base);
    ASSERT_LT((view - base).norm(), 1e-5F * (1.0F + view.norm()));
  }
  EXPECT_EQ(base_gradient(Vec3f::UnitZ(), EditMode::Base), Vec2f(0, 0));
  const Vec3f tilted = Vec3f(0.3F, 0.1F, 0.8F).normalized();
  EXPECT_LT((gradient_from_normal(tilted, tilted, EditMode::Base)).norm(), 1e-6F);
  EXPECT_LT((base_gradient(tilted, EditMode::View) - Vec2f(-0.375F, -0.125F)).norm(), 1e-6F);
}

}  // namespace
}  // namespace normalshop
