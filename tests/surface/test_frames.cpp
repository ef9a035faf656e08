#include <algorithm>

#include "support/meshes.h"
#include <Eigen/LU>
#include <gtest/gtest.h>

#include "normalshop/core/random.h"
#include "normalshop/core/slope.h"
#include "normalshop/surface/frames.h"

namespace normalshop {
namespace {

Vec3f random_upper(Random& random) {
  return Vec3f(random.uniform(-1.0F, 1.0F), random.uniform(-1.0F, 1.0F),
               random.uniform(0.05F, 1.0F))
      .normalized();
}

double worst_round_trip(const Mesh& mesh) {
  Random random(7);
  double worst = 0.0;
  for (int i = 0; i < 4000; ++i) {
    const auto triangle = random.next() % static_cast<std::uint32_t>(mesh.triangle_count());
    const float b1 = random.uniform();
    const float b2 = random.uniform() * (1.0F - b1);
    const TangentFrame frame = frame_at(mesh, {triangle, b1, b2}, NormalSpace::Tangent);
    const Vec3f m = random_upper(random);
    worst = std::max(worst, angle_degrees(frame.map_normal(frame.object_normal(m)), m));
  }
  return worst;
}

TEST(Frames, MapNormalUndoesObjectNormal) {
  EXPECT_LT(worst_round_trip(test::plane_grid(2)), 1e-5);
  EXPECT_LT(worst_round_trip(test::hemisphere(6, 12)), 1e-5);
  EXPECT_LT(worst_round_trip(test::mirrored_pair(2)), 1e-5);
}

TEST(Frames, FlatMapShowsTheBaseNormal) {
  const Mesh mesh = test::hemisphere(4, 9);
  for (std::uint32_t t = 0; t < mesh.triangle_count(); ++t) {
    const SurfacePoint point{t, 0.25F, 0.3F};
    const TangentFrame frame = frame_at(mesh, point, NormalSpace::Tangent);
    const Vec3f n = base_normal_at(mesh, point);
    EXPECT_LT(angle_degrees(frame.object_normal(Vec3f::UnitZ()), n), 1e-5);
    EXPECT_LT(angle_degrees(frame.map_normal(n), Vec3f::UnitZ()), 1e-5);
  }
}

TEST(Frames, GreenPointsUpInTheMapAlsoOnMirroredTriangles) {
  // u = |x|, v = 1 - y: up in the map is +y on both halves, right is +x and -x.
  const Mesh mesh = test::mirrored_pair(1);
  const Vec3f red(0.6F, 0.0F, 0.8F);
  const Vec3f green(0.0F, 0.6F, 0.8F);
  const TangentFrame right = frame_at(mesh, {0, 0.3F, 0.3F}, NormalSpace::Tangent);
  const TangentFrame left = frame_at(mesh, {2, 0.3F, 0.3F}, NormalSpace::Tangent);
  EXPECT_LT(angle_degrees(right.object_normal(red), {0.6F, 0.0F, 0.8F}), 1e-5);
  EXPECT_LT(angle_degrees(left.object_normal(red), {-0.6F, 0.0F, 0.8F}), 1e-5);
  EXPECT_LT(angle_degrees(right.object_normal(green), green), 1e-5);
  EXPECT_LT(angle_degrees(left.object_normal(green), green), 1e-5);
}

TEST(Frames, InterpolatedVectorsAreNotNormalised) {
  Mesh mesh = test::plane_grid(1);
  mesh.normals[1] = Vec3f(0.6F, 0.0F, 0.8F);
  const TangentFrame frame = frame_at(mesh, {0, 0.5F, 0.0F}, NormalSpace::Tangent);
  const Vec3f n(0.3F, 0.0F, 0.9F);
  EXPECT_NEAR((frame.to_object.col(2) - n).norm(), 0.0, 1e-6);
  EXPECT_NEAR(frame.to_object.col(1).norm(), 0.9, 1e-6);
}

TEST(Frames, DegenerateTangentsGiveAnOrthonormalFrame) {
  Mesh mesh = test::plane_grid(1);
  const auto expect_orthonormal = [&] {
    const Mat3f m = frame_at(mesh, {0, 0.5F, 0.25F}, NormalSpace::Tangent).to_object;
    EXPECT_LT((m.transpose() * m - Mat3f::Identity()).norm(), 1e-5);
    EXPECT_NEAR(m.determinant(), 1.0, 1e-5);
    EXPECT_NEAR(m(2, 2), 1.0, 1e-6);
  };
  for (Vec4f& t : mesh.tangents) t = Vec4f(0.0F, 0.0F, 1.0F, 1.0F);
  expect_orthonormal();
  for (Vec4f& t : mesh.tangents) t = Vec4f(0.0F, 0.0F, 0.0F, -1.0F);
  expect_orthonormal();
  mesh.tangents[0] = Vec4f(1.0F, 0.0F, 0.0F, 1.0F);
  mesh.tangents[1] = Vec4f(-1.0F, 0.0F, 0.0F, 1.0F);
  mesh.tangents[2] = Vec4f(1.0F, 0.0F, 0.0F, 1.0F);
  expect_orthonormal();
}

TEST(Frames, CancellingNormalsFallBackToTheTriangle) {
  Mesh mesh = test::plane_grid(1);
  mesh.normals[0] = -mesh.normals[1];
  const Vec3f n = base_normal_at(mesh, {0, 0.5F, 0.0F});
  EXPECT_LT(angle_degrees(n, Vec3f::UnitZ()), 1e-6);
}

TEST(Frames, ObjectSpaceIsTheIdentity) {
  const Mesh mesh = test::hemisphere(2, 5);
  EXPECT_EQ(frame_at(mesh, {1, 0.2F, 0.2F}, NormalSpace::Object).to_object, Mat3f::Identity());
  EXPECT_EQ(frame_at(mesh, {1, 0.2F, 0.2F}, NormalSpace::World).to_object, Mat3f::Identity());
}

TEST(Frames, ZeroStaysZero) {
  const TangentFrame frame;
  EXPECT_EQ(frame.object_normal(Vec3f::Zero()), Vec3f::Zero());
  EXPECT_EQ(frame.map_normal(Vec3f::Zero()), Vec3f::Zero());
}

}  // namespace
}  // namespace normalshop
