#include <algorithm>
#include <array>
#include <cmath>

#include "support/meshes.h"
#include <gtest/gtest.h>

#include "normalshop/surface/seams.h"
#include "normalshop/surface/texel_map.h"

namespace normalshop {
namespace {

/// Squared distance in texels from a place to the nearest point of a triangle's outline.
double distance_to_triangle(const Mesh& mesh, std::uint32_t t, const Vec2d& p, const Vec2d& size) {
  double best = 1e30;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec2d a = mesh.uvs[3 * t + k].cast<double>().cwiseProduct(size);
    const Vec2d d = mesh.uvs[3 * t + (k + 1) % 3].cast<double>().cwiseProduct(size) - a;
    const double s = std::clamp((p - a).dot(d) / d.squaredNorm(), 0.0, 1.0);
    best = std::min(best, (p - a - s * d).norm());
  }
  return best;
}

Vec2d centre(const GutterTexel& g, const TexelMap& map) {
  const auto width = static_cast<std::uint32_t>(map.width());
  return {g.texel % width + 0.5, g.texel / width + 0.5};
}

TEST(Gutter, HoldsExactlyTheUnownedTexelsInReach) {
  const Mesh mesh = test::cube(3);
  const TexelMap map(mesh, 0, 150, 100, 3);
  const Vec2d size(150.0, 100.0);
  auto next = map.gutter().begin();
  for (std::uint32_t texel = 0; texel < 15000; ++texel) {
    if (map.owner().data()[texel] != no_triangle) continue;
    const Vec2d p(texel % 150 + 0.5, texel / 150 + 0.5);
    double nearest = 1e30;
    for (std::uint32_t t = 0; t < mesh.triangle_count(); ++t) {
      nearest = std::min(nearest, distance_to_triangle(mesh, t, p, size));
    }
    const bool listed = next != map.gutter().end() && next->texel == texel;
    EXPECT_EQ(listed, nearest <= 3.0) << texel << " at " << nearest;
    if (!listed) continue;
    EXPECT_NEAR(distance_to_triangle(mesh, next->owner, p, size), nearest, 1e-9);
    ++next;
  }
  EXPECT_TRUE(next == map.gutter().end());
}

TEST(Gutter, ContinuesThePlaneIntoTheTurnedChart) {
  for (const int n : {1, 4, 40}) {
    const Mesh mesh = test::plane_two_charts(n);
    const TexelMap map(mesh, 0, 512, 512, 6);
    const auto left_triangles = static_cast<std::uint32_t>(2 * n * n);
    double worst = 0.0;
    int across = 0;
    for (const GutterTexel& g : map.gutter()) {
      const Vec2d uv = centre(g, map) / 512.0;
      const bool left = g.owner < left_triangles;
      const Vec2d truth = left ? Vec2d(0.5 * (uv.x() - 0.1) / 0.4, (0.9 - uv.y()) / 0.8)
                               : Vec2d(0.5 + 0.5 * (uv.y() - 0.2) / 0.15, (uv.x() - 0.6) / 0.3);
      if (truth.x() < 0.0 || truth.x() > 1.0 || truth.y() < 0.0 || truth.y() > 1.0) continue;
      ++across;
      EXPECT_EQ(left, g.source.triangle >= left_triangles);
      const Vec3f found = position_at(mesh, g.source);
      worst = std::max(worst, (found.head<2>().cast<double>() - truth).norm());
    }
    EXPECT_GT(across, 3000);
    EXPECT_LT(worst, 1e-5) << n;
  }
}

TEST(Gutter, StopsAtOpenBorders) {
  Mesh mesh = test::plane_grid(5);
  for (Vec2f& uv : mesh.uvs) uv = 0.5F * uv + Vec2f(0.25F, 0.25F);
  const TexelMap map(mesh, 0, 200, 200, 5);
  EXPECT_GT(map.gutter().size(), 2000U);
  for (const GutterTexel& g : map.gutter()) {
    const Vec2d p = centre(g, map) / 200.0;
    const Vec2d truth((std::clamp(p.x(), 0.25, 0.75) - 0.25) * 2.0,
                      (0.75 - std::clamp(p.y(), 0.25, 0.75)) * 2.0);
    EXPECT_LT((position_at(mesh, g.source).head<2>().cast<double>() - truth).norm(), 1e-6);
    EXPECT_EQ(g.source.triangle, g.owner);
  }
}

TEST(Gutter, UnfoldsTheCubeAroundItsEdges) {
  const Mesh mesh = test::cube(7);
  const TexelMap map(mesh, 0, 600, 400, 8);
  double worst = 0.0;
  for (const GutterTexel& g : map.gutter()) {
    const std::size_t face = g.owner / 98;
    const Vec3f normal = mesh.normals[3 * static_cast<std::size_t>(g.owner)];
    const Vec2d origin(static_cast<double>(face % 3) / 3.0 + 0.04,
                       static_cast<double>(face / 3) / 2.0 + 0.04);
    const Vec2d uv = centre(g, map).cwiseQuotient(Vec2d(600.0, 400.0)) - origin;
    const Vec2d st = uv.cwiseQuotient(Vec2d(1.0 / 3.0 - 0.08, 0.5 - 0.08));
    const Vec2d out = (st - Vec2d(0.5, 0.5)).cwiseAbs() - Vec2d(0.5, 0.5);
    const Vec3d found = position_at(mesh, g.source).cast<double>();
    EXPECT_NEAR(found.cwiseAbs().maxCoeff(), 1.0, 1e-6);
    if (out.x() > 0.0 && out.y() > 0.0) continue;  // beyond a corner: three faces meet
    // The excess goes down along the neighbouring face.
    const double depth = 2.0 * std::max(out.x(), out.y());
    EXPECT_NE(g.source.triangle / 98, face);
    worst = std::max(worst, std::abs(found.dot(normal.cast<double>()) - (1.0 - depth)));
  }
  EXPECT_LT(worst, 1e-5);
}

TEST(Gutter, MarksHardEdgesAlone) {
  for (const Mesh& smooth : {test::plane_two_charts(4), test::uv_sphere(24, 12)}) {
    const TexelMap map(smooth, 0, 256, 256, 6);
    for (const GutterTexel& g : map.gutter()) ASSERT_FALSE(g.hard_edge);
  }
  const Mesh mesh = test::cube(3);
  const TexelMap map(mesh, 0, 300, 200, 6);
  EXPECT_GT(map.gutter().size(), 1000U);
  for (const GutterTexel& g : map.gutter()) {
    ASSERT_TRUE(g.hard_edge);
    // The border's nearest point is the owner's, and less than the texel's reach away.
    const Vec3f border = position_at(mesh, {g.owner, g.border_b1, g.border_b2});
    EXPECT_EQ((border.cwiseAbs().array() > 0.99999F).count() >= 2, true);
    const std::size_t c = 3 * static_cast<std::size_t>(g.owner);
    const Vec2f uv =
        interpolate<Vec2f>(mesh.uvs[c], mesh.uvs[c + 1], mesh.uvs[c + 2], g.border_b1, g.border_b2);
    EXPECT_LE((uv.cast<double>().cwiseProduct(Vec2d(300.0, 200.0)) - centre(g, map)).norm(), 6.001);
  }
}

TEST(Gutter, OwnerWeightsExtrapolateTheTexelsCentre) {
  const Mesh mesh = test::plane_two_charts(1);
  const TexelMap map(mesh, 0, 256, 256, 4);
  for (const GutterTexel& g : map.gutter()) {
    const std::size_t c = 3 * static_cast<std::size_t>(g.owner);
    const Vec2f uv =
        interpolate<Vec2f>(mesh.uvs[c], mesh.uvs[c + 1], mesh.uvs[c + 2], g.owner_b1, g.owner_b2);
    EXPECT_LT((uv.cast<double>() * 256.0 - centre(g, map)).norm(), 1e-3);
  }
}

TEST(Gutter, OwnerWeightsStopWhereFramesMeanNothing) {
  const Mesh mesh = test::plane_two_charts(100);
  const TexelMap map(mesh, 0, 128, 128, 8);
  EXPECT_FALSE(map.gutter().empty());
  for (const GutterTexel& g : map.gutter()) {
    EXPECT_GE(std::min({g.owner_b1, g.owner_b2, 1.0F - g.owner_b1 - g.owner_b2}), -1.0001F);
  }
}

TEST(Gutter, WrapsAroundTheMap) {
  Mesh mesh = test::plane_grid(2);
  for (Vec2f& uv : mesh.uvs) uv = Vec2f(0.5F * uv.x(), 0.25F + 0.5F * uv.y());
  const TexelMap map(mesh, 0, 64, 64, 2);
  // Left of column 0 is column 63.
  const auto found = std::find_if(map.gutter().begin(), map.gutter().end(),
                                  [](const GutterTexel& g) { return g.texel == 32 * 64 + 63; });
  ASSERT_NE(found, map.gutter().end());
  EXPECT_NEAR(position_at(mesh, found->source).x(), 0.0, 1e-6);
}

TEST(Gutter, EndsWithAMapThatDoesNotRepeat) {
  Mesh mesh = test::plane_grid(2);
  for (Vec2f& uv : mesh.uvs) uv = Vec2f(0.5F + 0.5F * uv.x(), 0.2F + 0.5F * uv.y());
  const auto beyond = [&] {
    const TexelMap map(mesh, 0, 64, 64, 4);
    return std::count_if(map.gutter().begin(), map.gutter().end(),
                         [](const GutterTexel& g) { return g.texel % 64 < 20; });
  };
  EXPECT_GT(beyond(), 100);
  mesh.single_maps = {1};
  EXPECT_EQ(beyond(), 0);
  EXPECT_EQ(reading_place(mesh, 0, {0.5F, 0.25F}, 64, 64), Vec2f(0.5F, 0.25F));
  EXPECT_GT(reading_place(mesh, 0, {0.0F, 0.5F}, 64, 64).x(), 0.5F / 64);
  EXPECT_LT(reading_place(mesh, 0, {1.0F, 0.5F}, 64, 64).x(), 1.0F - 0.5F / 64);
}

TEST(Gutter, FoldedChartsAreBordersToo) {
  // Both halves hang together in the atlas at u = 0.5 but lie on each other left of it.
  Mesh mesh = test::mirrored_pair(3);
  for (Vec2f& uv : mesh.uvs) uv = Vec2f(0.5F - 0.4F * uv.x(), 0.1F + 0.8F * uv.y());
  const TexelMap map(mesh, 0, 100, 100, 3);
  std::array<int, 2> right{};  // as either half's gutter
  for (const GutterTexel& g : map.gutter()) {
    const Vec2d p = centre(g, map) / 100.0;
    if (p.x() < 0.5 || p.y() < 0.1 || p.y() > 0.9) continue;
    ++right[g.owner < 18 ? 0 : 1];
    EXPECT_NE(g.source.triangle < 18, g.owner < 18);
    const double x = std::abs(static_cast<double>(position_at(mesh, g.source).x()));
    EXPECT_NEAR(x, (p.x() - 0.5) / 0.4, 1e-5);
  }
  EXPECT_EQ(right, (std::array<int, 2>{3 * 80, 3 * 80}));
}

TEST(Gutter, IsSharedByChartsThatLieOnEachOther) {
  Mesh mesh = test::mirrored_pair(3);
  for (Vec2f& uv : mesh.uvs) uv = Vec2f(0.1F, 0.1F) + 0.8F * uv;
  // The other half a whole map further on.
  for (std::size_t c = 3 * 18; c < mesh.corner_count(); ++c) mesh.uvs[c].x() += 1.0F;
  const TexelMap map(mesh, 0, 96, 96, 6);
  const auto& gutter = map.gutter();
  EXPECT_GT(gutter.size(), 3000U);
  ASSERT_EQ(gutter.size() % 2, 0U);
  for (std::size_t i = 0; i < gutter.size(); i += 2) {
    const GutterTexel& first = gutter[i];
    const GutterTexel& second = gutter[i + 1];
    ASSERT_EQ(first.texel, second.texel);
    EXPECT_NE(first.owner < 18, second.owner < 18);
    const Vec3f a = position_at(mesh, {first.owner, first.border_b1, first.border_b2});
    const Vec3f b = position_at(mesh, {second.owner, second.border_b1, second.border_b2});
    EXPECT_LT((a - Vec3f(-b.x(), b.y(), b.z())).norm(), 1e-4F);
    if (i > 0) {
      EXPECT_LT(gutter[i - 1].texel, first.texel);
    }
  }
}

TEST(Gutter, ChartsSideBySideShareNothing) {
  // Two charts 4 texels apart: those in the middle are as near to the one as to the other.
  Mesh mesh = test::plane_two_charts(2);
  for (std::size_t c = 0; c < mesh.corner_count(); ++c) {
    const Vec3f& p = mesh.position(c);
    mesh.uvs[c] =
        Vec2f((p.x() < 0.5F || c < 24 ? 10.0F : 14.0F) + 40.0F * p.x(), 10.0F + 40.0F * p.y()) /
        64.0F;
  }
  mesh.triangles.push_back(mesh.triangles[0]);  // overlaps, so that further borders are looked for
  mesh.texture_sets.push_back(0);
  for (std::size_t c = 0; c < 3; ++c) {
    mesh.uvs.push_back(mesh.uvs[c]);
    mesh.normals.push_back(mesh.normals[c]);
    mesh.tangents.push_back(mesh.tangents[c]);
  }
  const TexelMap map(mesh, 0, 64, 64, 4);
  EXPECT_FALSE(map.shared().empty());
  int between = 0;
  std::uint32_t last = no_triangle;
  for (const GutterTexel& g : map.gutter()) {
    const Vec2d p = centre(g, map);
    if (p.x() < 30.0 || p.x() > 34.0 || p.y() < 11.0 || p.y() > 49.0) continue;
    ++between;
    EXPECT_NE(g.texel, last);
    last = g.texel;
  }
  EXPECT_EQ(between, 4 * 38);
}

TEST(Seams, CubeHasTwelveSeamsAndSixCharts) {
  const Mesh mesh = test::cube(4);
  const Seams seams = find_seams(mesh);
  EXPECT_EQ(seams.chart_count, 6U);
  EXPECT_EQ(seams.edges.size(), 48U);
  EXPECT_TRUE(seams.open_edges.empty());
  EXPECT_TRUE(seams.irregular_edges.empty());
  for (const SeamEdge& e : seams.edges) {
    EXPECT_EQ(mesh.position(e.a0), mesh.position(e.b0));
    EXPECT_EQ(mesh.position(e.a1), mesh.position(e.b1));
    EXPECT_LT(e.triangle_a, e.triangle_b);
    EXPECT_EQ(e.a0 / 3, e.triangle_a);
    EXPECT_EQ(e.b1 / 3, e.triangle_b);
    EXPECT_EQ(e.a1, next_corner(e.a0));
    EXPECT_EQ(e.b0, next_corner(e.b1));
    EXPECT_NE(seams.chart[e.triangle_a], seams.chart[e.triangle_b]);
  }
}

TEST(Seams, SphereIsClosedWithOneSeam) {
  const Seams seams = find_seams(test::uv_sphere(12, 8));
  EXPECT_EQ(seams.chart_count, 1U);
  EXPECT_TRUE(seams.open_edges.empty());
  EXPECT_TRUE(seams.irregular_edges.empty());
  // The meridian, and at each pole the sides of the triangles, whose pole corners differ in u.
  EXPECT_GE(seams.edges.size(), 8U);
}

TEST(Seams, OpenEdgesAndTextureSets) {
  Mesh mesh = test::plane_grid(3);
  EXPECT_EQ(find_seams(mesh).open_edges.size(), 12U);
  EXPECT_TRUE(find_seams(mesh).edges.empty());
  mesh.texture_sets[8] = 1;  // the middle quad's first triangle
  const Seams seams = find_seams(mesh);
  EXPECT_EQ(seams.edges.size(), 3U);
  EXPECT_EQ(seams.chart_count, 2U);
}

TEST(Seams, NonManifoldEdgesAreReported) {
  Mesh mesh = test::plane_grid(1);
  const Vec3f far(0.5F, 0.5F, 1.0F);
  // A third triangle on the diagonal.
  mesh.positions.push_back(far);
  const auto last = static_cast<std::uint32_t>(mesh.positions.size() - 1);
  mesh.triangles.emplace_back(mesh.triangles[0][0], mesh.triangles[0][2], last);
  for (int k = 0; k < 3; ++k) {
    mesh.uvs.emplace_back(0.1F * static_cast<float>(k), 0.2F);
    mesh.normals.emplace_back(0.0F, 0.0F, 1.0F);
  }
  mesh.texture_sets.push_back(0);
  const Seams seams = find_seams(mesh);
  EXPECT_EQ(seams.irregular_edges.size(), 3U);
  // The two that share their UVs stay together.
  EXPECT_EQ(seams.chart[0], seams.chart[1]);
  EXPECT_EQ(seams.chart_count, 2U);
}

}  // namespace
}  // namespace normalshop
