#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "normalshop/core/error.h"
#include "normalshop/surface/seams.h"
#include "normalshop/surface/shapes.h"

namespace normalshop {
namespace {

std::array<ChartSquare, 6> grid_charts() {
  std::array<ChartSquare, 6> charts;
  for (std::size_t f = 0; f < 6; ++f) {
    charts[f].center = {(static_cast<float>(f % 3) + 0.5F) / 3.0F, f < 3 ? 0.25F : 0.75F};
    charts[f].side = 0.3F;
  }
  return charts;
}

TEST(CubeSphere, IsClosedRoundAndTurnedOutwards) {
  const Mesh mesh = cube_sphere(9, grid_charts(), "ball");
  EXPECT_EQ(mesh.triangle_count(), 6U * 81U * 2U);
  EXPECT_EQ(mesh.positions.size(), 6U * 81U + 2U);
  double volume = 0.0;
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    const Vec3d a = mesh.position(3 * t).cast<double>();
    const Vec3d b = mesh.position(3 * t + 1).cast<double>();
    const Vec3d c = mesh.position(3 * t + 2).cast<double>();
    const double part = a.dot(b.cross(c)) / 6.0;
    EXPECT_GT(part, 0.0);
    volume += part;
  }
  EXPECT_NEAR(volume, 4.18879, 0.1);
  for (std::size_t c = 0; c < mesh.corner_count(); ++c) {
    EXPECT_NEAR(mesh.position(c).norm(), 1.0F, 1e-6F);
    EXPECT_EQ(mesh.normals[c], mesh.position(c));
  }
  const Seams seams = find_seams(mesh);
  EXPECT_EQ(seams.chart_count, 6U);
  EXPECT_EQ(seams.edges.size(), 12U * 9U);
  EXPECT_TRUE(seams.open_edges.empty());
}

TEST(CubeSphere, ChartsAreNotMirroredAndLieWhereTheyShould) {
  std::array<ChartSquare, 6> charts = grid_charts();
  for (std::size_t f = 0; f < 6; ++f) charts[f].degrees = 30.0F * static_cast<float>(f);
  const Mesh mesh = cube_sphere(4, charts, "ball");
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    const Vec2f& a = mesh.uvs[3 * t];
    const Vec2f u = mesh.uvs[3 * t + 1] - a;
    const Vec2f v = mesh.uvs[3 * t + 2] - a;
    EXPECT_LT(u.x() * v.y() - u.y() * v.x(), 0.0F);  // v runs down
    const Vec2f from_center = a - charts[t / 32].center;
    EXPECT_LE(from_center.norm(), 0.3F * 0.7072F);
  }
}

TEST(CubeSphere, FrontIsUprightInTheMap) {
  const Mesh mesh = cube_sphere(2, grid_charts(), "ball");
  for (std::size_t c = std::size_t{3} * 32; c < std::size_t{3} * 40; ++c) {  // +z
    const Vec2f place = mesh.uvs[c] - grid_charts()[4].center;
    EXPECT_NEAR(std::copysign(1.0F, mesh.position(c).x()) * place.x(), std::abs(place.x()), 1e-6F);
    EXPECT_NEAR(std::copysign(1.0F, -mesh.position(c).y()) * place.y(), std::abs(place.y()), 1e-6F);
  }
}

TEST(CubeSphere, RefusesUnusableSizes) {
  EXPECT_THROW(cube_sphere(0, grid_charts(), "ball"), InvalidInput);
  EXPECT_THROW(cube_sphere(4096, grid_charts(), "ball"), InvalidInput);
}

}  // namespace
}  // namespace normalshop
