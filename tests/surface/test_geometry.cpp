#include <cmath>

#include "support/meshes.h"
#include <gtest/gtest.h>

#include "normalshop/core/slope.h"
#include "normalshop/surface/seams.h"
#include "normalshop/surface/subdivide.h"
#include "normalshop/surface/texel_density.h"
#include "normalshop/surface/vertex_normals.h"

namespace normalshop {
namespace {

TEST(VertexNormals, SphereIsSmoothAcrossItsSeam) {
  Mesh mesh = test::uv_sphere(96, 48);
  const std::vector<Vec3f> truth = mesh.normals;
  compute_normals(mesh);
  double worst = 0.0;
  for (std::size_t c = 0; c < truth.size(); ++c) {
    worst = std::max(worst, angle_degrees(mesh.normals[c], truth[c]));
    EXPECT_NEAR(mesh.normals[c].norm(), 1.0F, 1e-6F);
  }
  EXPECT_LT(worst, 0.2);
}

TEST(VertexNormals, CubeCornersWeighTheFacesAlike) {
  // Faces are split into one or two triangles at a corner: only angles make that even.
  Mesh mesh = test::cube(1);
  compute_normals(mesh);
  for (std::size_t c = 0; c < mesh.corner_count(); ++c) {
    EXPECT_LT(angle_degrees(mesh.normals[c], mesh.position(c)), 1e-5);
  }
}

TEST(VertexNormals, TinyAndHugeMeshesAreAlike) {
  for (const float scale : {1e-15F, 1e12F}) {
    Mesh mesh = test::cube(2);
    for (Vec3f& p : mesh.positions) p *= scale;
    compute_normals(mesh, NormalsRule::Flat);
    const Mesh truth = test::cube(2);
    for (std::size_t c = 0; c < mesh.corner_count(); ++c) {
      EXPECT_LT(angle_degrees(mesh.normals[c], truth.normals[c]), 1e-4);
    }
  }
}

TEST(VertexNormals, TrianglesWithoutAreaTakeTheirVerticesNormals) {
  const Vec3f n(0.0F, 0.0F, 1.0F);
  test::MeshBuilder builder;
  builder.triangle({{0, 0, 0}, n, {0, 0}}, {{1, 0, 0}, n, {1, 0}}, {{0, 1, 0}, n, {0, 1}});
  builder.triangle({{0, 0, 0}, n, {0, 0}}, {{1, 0, 0}, n, {1, 0}}, {{2, 0, 0}, n, {0, 1}});
  builder.triangle({{5, 0, 0}, n, {0, 0}}, {{5, 0, 0}, n, {1, 0}}, {{5, 0, 0}, n, {0, 1}});
  Mesh mesh = builder.finish();
  for (const NormalsRule rule : {NormalsRule::AngleWeighted, NormalsRule::Flat}) {
    compute_normals(mesh, rule);
    for (const Vec3f& normal : mesh.normals) EXPECT_EQ(normal, n);
  }
}

TEST(Subdivide, KeepsShapeAndTopology) {
  const Mesh cube = test::cube(1);
  const Mesh fine = subdivide(cube, 3);
  EXPECT_EQ(fine.triangle_count(), cube.triangle_count() * 64);
  EXPECT_EQ(fine.tangents.size(), fine.corner_count());
  const Seams seams = find_seams(fine);
  EXPECT_TRUE(seams.open_edges.empty());
  EXPECT_EQ(seams.chart_count, 6U);
  EXPECT_EQ(seams.edges.size(), 12U * 8U);
  for (std::size_t c = 0; c < fine.corner_count(); ++c) {
    EXPECT_EQ(fine.position(c).cwiseAbs().maxCoeff(), 1.0F);
    EXPECT_EQ(fine.normals[c], cube.normals[c / 64 / 3 * 3]);
  }
  EXPECT_EQ(subdivide(cube, 0).triangles, cube.triangles);
}

TEST(TexelDensity, PlaneHasOneSizeOfTexel) {
  const Mesh mesh = test::plane_grid(4);
  const TexelDensity density = texel_density(mesh, 0, 200, 50);
  EXPECT_EQ(density.triangles, 32U);
  EXPECT_NEAR(density.median, 0.01, 1e-8);
  EXPECT_NEAR(density.min, 0.01, 1e-6);
  EXPECT_NEAR(density.max, 0.01, 1e-6);
  EXPECT_EQ(texel_density(mesh, 1, 200, 50).triangles, 0U);
}

TEST(TexelDensity, PercentilesAreOfTheSurfacesArea) {
  // Left half: 0.5 x 1 on 0.4 x 0.8 of the map; right half: on 0.3 x 0.15.
  const Mesh mesh = test::plane_two_charts(3);
  const TexelDensity density = texel_density(mesh, 0, 100, 100);
  EXPECT_NEAR(density.p05, std::sqrt(0.5 / 0.32) / 100.0, 1e-6);
  EXPECT_NEAR(density.p95, std::sqrt(0.5 / 0.045) / 100.0, 1e-6);
}

TEST(TexelUse, CountsSharedTexelsOnce) {
  const Mesh mesh = test::mirrored_pair(2);
  const TexelUse use = texel_use(TexelMap(mesh, 0, 20, 30));
  EXPECT_EQ(use.covered, 600U);
  EXPECT_EQ(use.shared, 600U);
  EXPECT_EQ(use.overlap, 1.0);
  EXPECT_EQ(use.coverage, 1.0);
  EXPECT_EQ(texel_use(TexelMap(test::plane_grid(2), 0, 20, 30)).overlap, 0.0);
}

}  // namespace
}  // namespace normalshop
