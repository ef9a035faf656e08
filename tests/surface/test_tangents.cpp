#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <numeric>
#include <vector>

#include "support/data.h"
#include "support/gltf_corners.h"
#include "support/meshes.h"
#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "normalshop/core/error.h"
#include "normalshop/core/parallel.h"
#include "normalshop/core/random.h"
#include "normalshop/core/slope.h"
#include "normalshop/surface/tangents.h"

namespace normalshop {
namespace {

using test::MeshBuilder;

std::vector<Vec4f> read_reference(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::vector<char> bytes(std::istreambuf_iterator<char>(stream), {});
  std::vector<Vec4f> tangents(bytes.size() / (4 * sizeof(float)));
  for (std::size_t i = 0; i < tangents.size(); ++i) {
    std::memcpy(tangents[i].data(), bytes.data() + 16 * i, 16);
  }
  return tangents;
}

bool has_map_area(const Mesh& mesh, std::size_t triangle) {
  const Vec2d e1 = (mesh.uvs[3 * triangle + 1] - mesh.uvs[3 * triangle]).cast<double>();
  const Vec2d e2 = (mesh.uvs[3 * triangle + 2] - mesh.uvs[3 * triangle]).cast<double>();
  return std::abs(e1.x() * e2.y() - e1.y() * e2.x()) > 1e-12;
}

struct Comparison {
  double mean = 0.0;
  double p99 = 0.0;
  double equal_signs = 0.0;
};

Comparison compare(const Mesh& mesh, const std::vector<Vec4f>& reference) {
  std::vector<double> errors;
  double equal = 0.0;
  for (std::size_t c = 0; c < mesh.corner_count(); ++c) {
    if (!has_map_area(mesh, c / 3)) continue;
    errors.push_back(angle_degrees(mesh.tangents[c].head<3>(), reference[c].head<3>()));
    equal += mesh.tangents[c][3] == reference[c][3] ? 1.0 : 0.0;
  }
  std::sort(errors.begin(), errors.end());
  const auto count = static_cast<double>(errors.size());
  return {std::accumulate(errors.begin(), errors.end(), 0.0) / count,
          errors[errors.size() * 99 / 100], equal / count};
}

struct ReferenceCase {
  const char* model;
  const char* tangents;
};

class ReferenceTangents : public testing::TestWithParam<ReferenceCase> {};

TEST_P(ReferenceTangents, AreMatched) {
  const auto model = test::data_file(GetParam().model);
  const auto tangents = test::data_file(GetParam().tangents);
  if (!model || !tangents) GTEST_SKIP() << "needs " << GetParam().model << " of the real data";
  Mesh mesh = test::load_gltf_corners(*model);
  const std::vector<Vec4f> reference = read_reference(*tangents);
  ASSERT_EQ(reference.size(), mesh.corner_count());
  compute_tangents(mesh);
  const Comparison found = compare(mesh, reference);
  std::cout << GetParam().model << ": mean " << found.mean << ", 99th percentile " << found.p99
            << " degrees, equal signs " << found.equal_signs << '\n';
  EXPECT_LE(found.mean, 0.1);
  EXPECT_LE(found.p99, 1.0);
  EXPECT_GE(found.equal_signs, 0.999);
}

INSTANTIATE_TEST_SUITE_P(
    Models, ReferenceTangents,
    testing::Values(
        ReferenceCase{"khr_avocado/Avocado.gltf", "reference_tangents/Avocado.f32"},
        ReferenceCase{"khr_waterbottle/WaterBottle.gltf", "reference_tangents/WaterBottle.f32"},
        ReferenceCase{"lee_perry_smith/LeePerrySmith.glb", "reference_tangents/LeePerrySmith.f32"},
        ReferenceCase{"khr_normal_tangent_test/NormalTangentTest.gltf",
                      "reference_tangents/NormalTangentTest.f32"}));

double worst_difference(const std::vector<Vec4f>& a, const std::vector<Vec4f>& b) {
  double worst = 0.0;
  for (std::size_t c = 0; c < a.size(); ++c) {
    EXPECT_EQ(a[c][3], b[c][3]) << c;
    worst = std::max(worst, angle_degrees(a[c].head<3>(), b[c].head<3>()));
  }
  return worst;
}

TEST(Tangents, FlatChartsHaveTheirAnalyticTangents) {
  for (Mesh mesh :
       {test::plane_grid(3), test::plane_two_charts(2), test::cube(2), test::mirrored_pair(3)}) {
    const std::vector<Vec4f> truth = mesh.tangents;
    compute_tangents(mesh);
    EXPECT_LT(worst_difference(truth, mesh.tangents), 1e-4);
  }
}

TEST(Tangents, SphereFollowsItsLongitude) {
  Mesh mesh = test::uv_sphere(64, 32);
  compute_tangents(mesh);
  for (std::size_t c = 0; c < mesh.corner_count(); ++c) {
    const Vec3f& n = mesh.normals[c];
    if (std::abs(n.y()) > 0.99F) continue;
    const Vec3f east = Vec3f::UnitY().cross(n);
    // At the seam only one side's triangles are in the group.
    EXPECT_LT(angle_degrees(mesh.tangents[c].head<3>(), east), 4.0);
    EXPECT_EQ(mesh.tangents[c][3], 1.0F);
  }
}

/// Two triangles that share an edge, the second turned by 90 degrees in the map: one group with the
/// corner angles as weights when the map hangs together.
TEST(Tangents, WeightsAreCornerAngles) {
  const Vec3f n(0.0F, 0.0F, 1.0F);
  MeshBuilder builder;
  builder.triangle({{0, 0, 0}, n, {0, 0}}, {{1, 0, 0}, n, {1, 0}}, {{0, 1, 0}, n, {0, -1}});
  builder.triangle({{0, 0, 0}, n, {0, 0}}, {{0, 1, 0}, n, {0, -1}}, {{-1, 1, 0}, n, {-2, -1}});
  Mesh mesh = builder.finish();
  compute_tangents(mesh);
  // dP/du is (1, 0, 0) and, for the second, from u(-1,1) = -2, u(0,1) = 0: (0.5, 0, 0).
  EXPECT_LT(angle_degrees(mesh.tangents[0].head<3>(), Vec3f::UnitX()), 1e-4);
  mesh.uvs[5] = Vec2f(-1.0F, 0.0F);
  compute_tangents(mesh);
  // Second triangle: P = p0 + a (0,1) + b (-1,1), uv = a (0,-1) + b (-1,0): dP/du = (1, -1).
  const Vec3f second = Vec3f(1.0F, -1.0F, 0.0F).normalized();
  const Vec3f expected = (90.0F * Vec3f::UnitX() + 45.0F * second).normalized();
  EXPECT_LT(angle_degrees(mesh.tangents[0].head<3>(), expected), 1e-4);
  EXPECT_LT(angle_degrees(mesh.tangents[1].head<3>(), Vec3f::UnitX()), 1e-4);
  EXPECT_EQ(mesh.tangents[0], mesh.tangents[3]);
}

TEST(Tangents, TrianglesWithoutMapAreaJoinTheirNeighboursGroup) {
  const Vec3f n(0.0F, 0.0F, 1.0F);
  MeshBuilder builder;
  builder.triangle({{0, 0, 0}, n, {0, 0}}, {{1, 0, 0}, n, {1, 0}}, {{0, 1, 0}, n, {0, -1}});
  builder.triangle({{0, 0, 0}, n, {0, 0}}, {{0, 1, 0}, n, {0, -1}}, {{-1, 0, 0}, n, {0, -0.5F}});
  Mesh mesh = builder.finish();
  compute_tangents(mesh);
  EXPECT_EQ(mesh.tangents[3], mesh.tangents[0]);
  EXPECT_EQ(mesh.tangents[4], mesh.tangents[2]);
  EXPECT_EQ(mesh.tangents[3][3], 1.0F);
  EXPECT_EQ(mesh.tangents[5], Vec4f(1.0F, 0.0F, 0.0F, -1.0F));
}

TEST(Tangents, DegenerateTrianglesCopyFromTheSameCorner) {
  const Vec3f n(0.0F, 0.0F, 1.0F);
  MeshBuilder builder;
  builder.triangle({{0, 0, 0}, n, {0, 0}}, {{0, 0, 0}, n, {0, 0}}, {{0, 1, 0}, n, {1, 0}});
  builder.triangle({{0, 0, 0}, n, {0, 0}}, {{0, 1, 0}, n, {1, 0}}, {{-1, 0, 0}, n, {0, -1}});
  Mesh mesh = builder.finish();
  compute_tangents(mesh);
  EXPECT_LT(angle_degrees(mesh.tangents[3].head<3>(), Vec3f::UnitY()), 1e-4);
  EXPECT_EQ(mesh.tangents[0], mesh.tangents[3]);
  EXPECT_EQ(mesh.tangents[1], mesh.tangents[3]);
  EXPECT_EQ(mesh.tangents[2], mesh.tangents[4]);
}

TEST(Tangents, TheOrderOfTrianglesDoesNotMatter) {
  Mesh mesh = test::hemisphere(8, 15);
  compute_tangents(mesh);
  Random random(11);
  std::vector<std::size_t> order(mesh.triangle_count());
  std::iota(order.begin(), order.end(), std::size_t{0});
  for (std::size_t i = order.size() - 1; i > 0; --i) std::swap(order[i], order[random.next() % i]);
  Mesh shuffled = mesh;
  for (std::size_t t = 0; t < order.size(); ++t) {
    shuffled.triangles[t] = mesh.triangles[order[t]];
    for (std::size_t k = 0; k < 3; ++k) {
      shuffled.normals[3 * t + k] = mesh.normals[3 * order[t] + k];
      shuffled.uvs[3 * t + k] = mesh.uvs[3 * order[t] + k];
    }
  }
  compute_tangents(shuffled);
  for (std::size_t t = 0; t < order.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec4f& a = shuffled.tangents[3 * t + k];
      const Vec4f& b = mesh.tangents[3 * order[t] + k];
      EXPECT_LT((a - b).norm(), 1e-6);
    }
  }
}

TEST(Tangents, ThreadsDoNotMatter) {
  Mesh mesh = test::uv_sphere(100, 60);
  compute_tangents(mesh);
  Mesh single = mesh;
  const ThreadLimit one(1);
  compute_tangents(single);
  EXPECT_EQ(mesh.tangents, single.tangents);
}

TEST(Tangents, NeedUvsAndNormals) {
  Mesh mesh = test::plane_grid(1);
  mesh.normals.clear();
  EXPECT_THROW(compute_tangents(mesh), InvalidInput);
  mesh = test::plane_grid(1);
  mesh.uvs.clear();
  EXPECT_THROW(compute_tangents(mesh), InvalidInput);
  Mesh empty;
  compute_tangents(empty);
  EXPECT_TRUE(empty.tangents.empty());
}

}  // namespace
}  // namespace normalshop
