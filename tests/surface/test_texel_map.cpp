#include <cmath>
#include <limits>

#include "support/data.h"
#include "support/gltf_corners.h"
#include "support/meshes.h"
#include <gtest/gtest.h>

#include "normalshop/core/error.h"
#include "normalshop/core/parallel.h"
#include "normalshop/core/random.h"
#include "normalshop/surface/seams.h"
#include "normalshop/surface/tangents.h"
#include "normalshop/surface/texel_density.h"
#include "normalshop/surface/texel_map.h"

namespace normalshop {
namespace {

using test::MeshBuilder;

MeshBuilder::Corner corner(float u, float v) {
  return {{u, 1.0F - v, 0.0F}, {0.0F, 0.0F, 1.0F}, {u, v}};
}

std::size_t owned_count(const TexelMap& map) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < map.owner().size(); ++i) {
    count += map.owner().data()[i] != no_triangle ? 1 : 0;
  }
  return count;
}

Vec2f uv_at(const Mesh& mesh, const SurfacePoint& p) {
  const std::size_t c = 3 * static_cast<std::size_t>(p.triangle);
  return interpolate<Vec2f>(mesh.uvs[c], mesh.uvs[c + 1], mesh.uvs[c + 2], p.b1, p.b2);
}

/// Largest distance in texels, whole maps aside, between texels' centres and the UVs found there.
double worst_centre_error(const Mesh& mesh, const TexelMap& map) {
  double worst = 0.0;
  for (int y = 0; y < map.height(); ++y) {
    for (int x = 0; x < map.width(); ++x) {
      if (map.owner()(x, y) == no_triangle) continue;
      const SurfacePoint p = map.surface_point(map.owner()(x, y), x, y);
      EXPECT_GE(std::min({p.b1, p.b2, 1.0F - p.b1 - p.b2}), -1e-4F);
      const Vec2f uv = uv_at(mesh, p);
      const double du = static_cast<double>(uv.x()) * map.width() - x - 0.5;
      const double dv = static_cast<double>(uv.y()) * map.height() - y - 0.5;
      worst = std::max({worst, std::abs(du - map.width() * std::round(du / map.width())),
                        std::abs(dv - map.height() * std::round(dv / map.height()))});
    }
  }
  return worst;
}

TEST(TexelMap, CoversThePlaneOnceAndOnce) {
  for (const int n : {1, 3, 16, 32, 64}) {
    const Mesh mesh = test::plane_grid(n);
    const TexelMap map(mesh, 0, 64, 48);
    EXPECT_EQ(owned_count(map), 64U * 48U) << n;
    EXPECT_TRUE(map.shared().empty()) << n;
    EXPECT_TRUE(map.gutter().empty()) << n;
    EXPECT_LT(worst_centre_error(mesh, map), 1e-3) << n;
  }
}

TEST(TexelMap, CentresOnEdgesAndCornersBelongToOneTriangle) {
  // Shifted by half a texel, every grid line runs through texel centres.
  for (const int n : {4, 8, 32}) {
    Mesh mesh = test::plane_grid(n);
    for (Vec2f& uv : mesh.uvs) uv = 0.5F * uv + Vec2f(0.25F + 0.5F / 64.0F, 0.25F + 0.5F / 64.0F);
    const TexelMap map(mesh, 0, 64, 64, 0);
    EXPECT_EQ(owned_count(map), 32U * 32U);
    EXPECT_TRUE(map.shared().empty());
  }
}

TEST(TexelMap, FansWithSliversAreCoveredOnce) {
  Random random(3);
  MeshBuilder builder;
  const int n = 500;
  const Vec2f middle(0.41F, 0.57F);
  for (int i = 0; i < 4 * n; ++i) {
    const auto rim = [&](int k) {
      const float s = static_cast<float>(k % n) / static_cast<float>(n);
      switch ((k / n) % 4) {
        case 0:
          return corner(s, 0.0F);
        case 1:
          return corner(1.0F, s);
        case 2:
          return corner(1.0F - s, 1.0F);
        default:
          return corner(0.0F, 1.0F - s);
      }
    };
    builder.triangle(corner(middle.x(), middle.y()), rim(i + 1), rim(i));
  }
  const Mesh mesh = builder.finish();
  const TexelMap map(mesh, 0, 256, 256);
  EXPECT_EQ(owned_count(map), 256U * 256U);
  EXPECT_TRUE(map.shared().empty());
}

TEST(TexelMap, TrianglesAcrossTheBorderWrapAround) {
  MeshBuilder builder;
  builder.quad(corner(0.75F, 0.25F), corner(1.25F, 0.25F), corner(1.25F, -0.25F),
               corner(0.75F, -0.25F));
  const Mesh mesh = builder.finish();
  const TexelMap map(mesh, 0, 32, 32, 0);
  EXPECT_EQ(owned_count(map), 16U * 16U);
  EXPECT_TRUE(map.shared().empty());
  EXPECT_NE(map.owner()(0, 0), no_triangle);
  EXPECT_NE(map.owner()(31, 31), no_triangle);
  EXPECT_EQ(map.owner()(16, 16), no_triangle);
  EXPECT_TRUE(map.affines()[0].wraps);
  EXPECT_LT(worst_centre_error(mesh, map), 1e-3);
}

TEST(TexelMap, WholeMapsAwayIsTheSame) {
  Mesh mesh = test::cube(2);
  const TexelMap here(mesh, 0, 96, 64);
  for (Vec2f& uv : mesh.uvs) uv += Vec2f(-3.0F, 2.0F);
  const TexelMap away(mesh, 0, 96, 64);
  EXPECT_FALSE(away.affines()[0].wraps);
  EXPECT_LT(worst_centre_error(mesh, away), 1e-2);
  EXPECT_NEAR(static_cast<double>(owned_count(away)), static_cast<double>(owned_count(here)), 8.0);
}

TEST(TexelMap, RepeatedTextureIsOwnedByBothHalvesOfTheQuad) {
  MeshBuilder builder;
  builder.quad(corner(0.0F, 10.0F), corner(10.0F, 10.0F), corner(10.0F, 0.0F), corner(0.0F, 0.0F));
  const TexelMap map(builder.finish(), 0, 64, 64);
  EXPECT_EQ(owned_count(map), 64U * 64U);
  // Each triangle also covers all; itself again is not a further triangle.
  EXPECT_EQ(map.shared().size(), 64U * 64U);
  EXPECT_TRUE(map.gutter().empty());
}

/// The largest repetition that is allowed, of triangles of every shape: what a texel stands for
/// lies in the triangle.
TEST(TexelMap, FindsARepetitionOfEveryTexel) {
  for (const Vec2f& apex : {Vec2f(0.0F, 0.0F), Vec2f(1000.0F, 3.0F), Vec2f(500.0F, 0.3F)}) {
    MeshBuilder builder;
    builder.triangle(corner(0.25F, 1000.0F), corner(1000.5F, 999.0F), corner(apex.x(), apex.y()));
    const Mesh mesh = builder.finish();
    const TexelMap map(mesh, 0, 16, 8);
    EXPECT_EQ(owned_count(map), 16U * 8U);
    EXPECT_LT(worst_centre_error(mesh, map), 0.02);
  }
}

TEST(TexelMap, PlacesOfTexelsBeyondTwoToThe31) {
  constexpr std::uint32_t index = 65535U * 65536U + 65533U;
  EXPECT_EQ(texel_place(index, 65536).x, 65533);
  EXPECT_EQ(texel_place(index, 65536).y, 65535);
}

TEST(TexelMap, MirroredHalvesShareEveryTexel) {
  const Mesh mesh = test::mirrored_pair(4);
  const TexelMap map(mesh, 0, 40, 40);
  EXPECT_EQ(owned_count(map), 1600U);
  ASSERT_EQ(map.shared().size(), 1600U);
  for (std::size_t i = 0; i < map.shared().size(); ++i) {
    EXPECT_EQ(map.shared()[i].texel, i);
    EXPECT_GE(map.shared()[i].triangle, 32U);
    EXPECT_LT(map.owner().data()[i], 32U);
  }
}

TEST(TexelMap, DegenerateAndForeignTrianglesOwnNothing) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  MeshBuilder builder;
  builder.triangle(corner(0.1F, 0.1F), corner(0.5F, 0.5F), corner(0.9F, 0.9F));
  builder.triangle(corner(0.5F, 0.5F), corner(0.5F, 0.5F), corner(0.5F, 0.5F));
  builder.triangle(corner(nan, 0.1F), corner(0.9F, 0.1F), corner(0.5F, 0.9F));
  builder.triangle(corner(1e30F, 0.1F), corner(0.9F, 0.1F), corner(0.5F, 0.9F));
  builder.quad(corner(0.0F, 0.5F), corner(0.5F, 0.5F), corner(0.5F, 0.0F), corner(0.0F, 0.0F));
  Mesh mesh = builder.finish();
  mesh.texture_sets[5] = 1;
  const TexelMap map(mesh, 0, 32, 32, 4);
  for (std::size_t t = 0; t < 4; ++t) EXPECT_TRUE(map.affines()[t].degenerate);
  EXPECT_FALSE(map.affines()[4].degenerate);
  EXPECT_TRUE(map.affines()[5].degenerate);
  EXPECT_NEAR(static_cast<double>(owned_count(map)), 128.0, 9.0);
  EXPECT_TRUE(map.shared().empty());
  for (const GutterTexel& g : map.gutter()) EXPECT_EQ(g.source.triangle, 4U);
}

TEST(TexelMap, OneTexel) {
  const Mesh mesh = test::plane_grid(2);
  const TexelMap map(mesh, 0, 1, 1);
  EXPECT_NE(map.owner()(0, 0), no_triangle);
  EXPECT_TRUE(map.shared().empty());
  const TexelMap tiny(test::cube(), 0, 1, 1);
  EXPECT_EQ(tiny.owner()(0, 0) != no_triangle ? 0U : 1U, tiny.gutter().size());
}

TEST(TexelMap, RefusesWhatCannotBe) {
  Mesh mesh = test::plane_grid(1);
  EXPECT_THROW(TexelMap(mesh, 0, 0, 5), InvalidInput);
  EXPECT_THROW(TexelMap(mesh, 0, 5, 100000), InvalidInput);
  EXPECT_THROW(TexelMap(mesh, 0, 5, 5, -1), InvalidInput);
  mesh.uvs.clear();
  EXPECT_THROW(TexelMap(mesh, 0, 5, 5), InvalidInput);
}

TEST(TexelMap, ThreadsDoNotMatter) {
  const Mesh mesh = test::uv_sphere(40, 20);
  const TexelMap all(mesh, 0, 301, 203);
  const ThreadLimit one(1);
  const TexelMap single(mesh, 0, 301, 203);
  EXPECT_TRUE(std::equal(all.owner().data(), all.owner().data() + all.owner().size(),
                         single.owner().data()));
  ASSERT_EQ(all.gutter().size(), single.gutter().size());
  for (std::size_t i = 0; i < all.gutter().size(); ++i) {
    EXPECT_EQ(all.gutter()[i].texel, single.gutter()[i].texel);
    EXPECT_EQ(all.gutter()[i].source.b1, single.gutter()[i].source.b1);
  }
}

TEST(TexelMap, RealHead) {
  const auto file = test::data_file("lee_perry_smith/LeePerrySmith.glb");
  if (!file) GTEST_SKIP() << "needs lee_perry_smith of the real data";
  const Mesh mesh = test::load_gltf_corners(*file);
  const TexelMap map(mesh, 0, 2048, 2048);
  const TexelUse use = texel_use(map);
  EXPECT_NEAR(use.coverage, 0.92, 0.01);
  EXPECT_LT(use.overlap, 0.001);
  EXPECT_LT(worst_centre_error(mesh, map), 0.02);
  for (const GutterTexel& g : map.gutter()) {
    EXPECT_EQ(map.owner().data()[g.texel], no_triangle);
    EXPECT_GE(std::min({g.source.b1, g.source.b2, 1.0F - g.source.b1 - g.source.b2}), -1e-6F);
  }
}

TEST(TexelMap, DamagedMeshesDoNoHarm) {
  Random random(99);
  const float strange[] = {std::numeric_limits<float>::quiet_NaN(), 1e30F, -1e30F, 1e-40F, 0.5F,
                           std::numeric_limits<float>::infinity()};
  for (int round = 0; round < 60; ++round) {
    Mesh mesh;
    mesh.texture_set_names = {"map"};
    const auto number = [&] {
      return random.next() % 40 == 0 ? strange[random.next() % 6] : random.uniform(-0.3F, 1.3F);
    };
    for (int i = 0; i < 12; ++i) mesh.positions.emplace_back(number(), number(), number());
    for (int t = 0; t < 40; ++t) {
      mesh.triangles.emplace_back(random.next() % 12, random.next() % 12, random.next() % 12);
      mesh.texture_sets.push_back(random.next() % 8 == 0 ? 1 : 0);
      for (int k = 0; k < 3; ++k) {
        mesh.uvs.emplace_back(std::round(number() * 8.0F) / 8.0F, number());
        mesh.normals.emplace_back(number(), number(), number());
      }
    }
    compute_tangents(mesh);
    const TexelMap map(mesh, 0, 37, 23, 6);
    for (const GutterTexel& g : map.gutter()) {
      EXPECT_TRUE(std::isfinite(g.source.b1) && std::isfinite(g.source.b2));
      EXPECT_TRUE(std::isfinite(g.owner_b1) && std::isfinite(g.owner_b2));
      EXPECT_LT(g.source.triangle, 40U);
      EXPECT_EQ(mesh.texture_sets[g.source.triangle], 0U);
    }
    for (const SharedTexel& s : map.shared()) {
      EXPECT_NE(map.owner().data()[s.texel], s.triangle);
      EXPECT_NE(map.owner().data()[s.texel], no_triangle);
    }
    EXPECT_EQ(find_seams(mesh).chart.size(), 40U);
  }
}

}  // namespace
}  // namespace normalshop
