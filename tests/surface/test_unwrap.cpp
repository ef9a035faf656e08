#include <cmath>
#include <limits>
#include <numbers>

#include "../support/atlas_check.h"
#include "../support/meshes.h"
#include "support/sanitized.h"
#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "normalshop/core/error.h"
#include "normalshop/core/parallel.h"
#include "normalshop/core/random.h"
#include "normalshop/surface/seams.h"
#include "normalshop/surface/unwrap.h"
#include "normalshop/surface/vertex_normals.h"

namespace normalshop::test {
namespace {

constexpr int atlas_points = 2048;

Mesh bare(Mesh mesh) {
  mesh.uvs.clear();
  mesh.tangents.clear();
  mesh.texture_sets.clear();
  mesh.texture_set_names.clear();
  return mesh;
}

/// columns x rows quads of place(s, t), s and t in 0..1; ones that wrap are welded.
template <class Place>
Mesh grid_of(int columns, int rows, const Place& place, bool wraps = false) {
  Mesh mesh;
  for (int j = 0; j <= rows; ++j) {
    for (int i = 0; i <= columns; ++i) {
      const int s = wraps ? i % columns : i;
      const int t = wraps ? j % rows : j;
      mesh.positions.push_back(place(static_cast<float>(s) / static_cast<float>(columns),
                                     static_cast<float>(t) / static_cast<float>(rows)));
    }
  }
  const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(j * (columns + 1) + i); };
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      mesh.triangles.emplace_back(at(i, j), at(i + 1, j), at(i + 1, j + 1));
      mesh.triangles.emplace_back(at(i, j), at(i + 1, j + 1), at(i, j + 1));
    }
  }
  compute_normals(mesh);
  return mesh;
}

Mesh torus() {
  const auto place = [](float s, float t) {
    const float a = 2.0F * std::numbers::pi_v<float> * s;
    const float b = 2.0F * std::numbers::pi_v<float> * t;
    const float r = 1.0F + 0.4F * std::cos(b);
    return Vec3f(r * std::cos(a), r * std::sin(a), 0.4F * std::sin(b));
  };
  return grid_of(64, 24, place, true);
}

/// A ramp that winds up around an axis: seen from above nothing is turned away, and it lies over
/// itself.
Mesh spiral_ramp(float turns) {
  return grid_of(160, 6, [turns](float s, float t) {
    const float a = 2.0F * std::numbers::pi_v<float> * turns * s;
    const float r = 1.5F - 0.5F * t;
    return Vec3f(r * std::cos(a), r * std::sin(a), 0.3F * turns * s);
  });
}

/// A sheet folded twice: three layers, closely above each other.
Mesh folded_sheet() {
  return grid_of(60, 10, [](float s, float t) {
    const float x = s < 1.0F / 3.0F   ? 3.0F * s
                    : s < 2.0F / 3.0F ? 2.0F - 3.0F * s
                                      : 3.0F * s - 2.0F;
    return Vec3f(x, t, 0.06F * s);
  });
}

Mesh bumpy_ball() {
  Mesh mesh = bare(uv_sphere(80, 40));
  for (Vec3f& p : mesh.positions) {
    p *= 1.0F + 0.1F * std::sin(9.0F * p.x()) * std::sin(9.0F * p.y()) * std::sin(8.0F * p.z());
  }
  compute_normals(mesh);
  return mesh;
}

/// What holds for every atlas, found without the library; the report says the same.
void expect_good_atlas(const Mesh& mesh, const UnwrapReport& report) {
  ASSERT_EQ(mesh.uvs.size(), mesh.corner_count());
  ASSERT_EQ(mesh.texture_sets.size(), mesh.triangle_count());
  ASSERT_EQ(mesh.texture_set_names.size(), 1U);
  for (const Vec2f& uv : mesh.uvs) {
    ASSERT_TRUE(uv.minCoeff() >= 0.0F && uv.maxCoeff() <= 1.0F) << uv.transpose();
  }
  double shown = 0.0;
  std::size_t turned = 0;
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    shown += atlas_area(mesh, t);
    if (surface_area(mesh, t) > 1e-9 && atlas_area(mesh, t) <= 0.0) ++turned;
  }
  const AtlasPicture picture = picture_of_atlas(mesh, atlas_points);
  EXPECT_EQ(picture.overlapping, 0U);
  EXPECT_EQ(turned, 0U);
  EXPECT_EQ(report.overlaps, 0U);
  EXPECT_EQ(report.turned_over, 0U);
  EXPECT_EQ(report.triangles, mesh.triangle_count());
  EXPECT_NEAR(report.coverage, shown, 1e-6);
  const double points = static_cast<double>(atlas_points) * atlas_points;
  EXPECT_NEAR(report.coverage, static_cast<double>(picture.covered) / points, 0.01);
  EXPECT_NEAR(report.mean_stretch, mean_area_stretch(mesh), 1e-4);
  EXPECT_LE(report.mean_stretch, 1.2);
  EXPECT_GE(report.largest_stretch, report.mean_stretch - 1e-9);
}

UnwrapReport unwrap_well(Mesh& mesh, const UnwrapOptions& options = {}) {
  const UnwrapReport report = unwrap(mesh, options);
  expect_good_atlas(mesh, report);
  return report;
}

std::vector<std::vector<std::uint32_t>> corners_of_charts(const Mesh& mesh) {
  const Seams seams = find_seams(mesh);
  std::vector<std::vector<std::uint32_t>> corners(seams.chart_count);
  for (std::uint32_t c = 0; c < mesh.corner_count(); ++c) {
    if (seams.chart[c / 3] != no_chart) corners[seams.chart[c / 3]].push_back(c);
  }
  return corners;
}

TEST(Unwrap, SphereHasFewCharts) {
  Mesh mesh = bare(uv_sphere(64, 32));
  const UnwrapReport report = unwrap_well(mesh);
  EXPECT_GE(report.charts, 3U);
  EXPECT_LE(report.charts, 8U);
  EXPECT_GE(report.coverage, 0.6);
  EXPECT_EQ(find_seams(mesh).chart_count, report.charts);
}

TEST(Unwrap, TorusAndBumpsKeepToTheBounds) {
  NORMALSHOP_SKIP_FIGURES();
  for (Mesh mesh : {torus(), bumpy_ball()}) {
    const UnwrapReport report = unwrap_well(mesh);
    EXPECT_LE(report.charts, 40U);
    EXPECT_GE(report.coverage, 0.55);
    EXPECT_LE(report.largest_stretch, 4.0);
    EXPECT_EQ(find_seams(mesh).chart_count, report.charts);
  }
}

TEST(Unwrap, HardEdgesAreBorders) {
  Mesh box = bare(cube(1));
  EXPECT_EQ(unwrap_well(box).charts, 6U);
  Mesh mesh = bare(cube(4));
  const UnwrapReport report = unwrap_well(mesh);
  EXPECT_EQ(report.charts, 6U);
  EXPECT_NEAR(report.mean_stretch, 1.0, 1e-5);
  EXPECT_NEAR(report.largest_stretch, 1.0, 1e-4);
  EXPECT_GE(report.coverage, 0.6);
  for (const auto& corners : corners_of_charts(mesh)) {
    for (const std::uint32_t c : corners) {
      EXPECT_EQ(mesh.normals[c], mesh.normals[corners.front()]);
    }
  }
}

TEST(Unwrap, ChartsRunAcrossHardEdgesOnWish) {
  Mesh mesh = bare(cube(4));
  UnwrapOptions options;
  options.across_hard_edges = true;
  EXPECT_LT(unwrap_well(mesh, options).charts, 6U);
  // Facets have hard edges all around, and are no charts each.
  Mesh facets = bare(uv_sphere(24, 12));
  compute_normals(facets, NormalsRule::Flat);
  EXPECT_LE(unwrap_well(facets).charts, 10U);
}

TEST(Unwrap, PatchStaysWhole) {
  Mesh mesh = bare(plane_grid(8));
  const UnwrapReport report = unwrap_well(mesh);
  EXPECT_EQ(report.charts, 1U);
  EXPECT_GE(report.coverage, 0.9);
  EXPECT_NEAR(report.mean_stretch, 1.0, 1e-5);
}

TEST(Unwrap, WhatLiesOverItselfIsSplit) {
  Mesh mesh = spiral_ramp(1.5F);
  // Seen from above, which everything faces, it overlaps: the check would see it.
  Mesh seen = mesh;
  for (std::size_t c = 0; c < seen.corner_count(); ++c) {
    seen.uvs.emplace_back(seen.position(c).x() / 4.0F + 0.5F, 0.5F - seen.position(c).y() / 4.0F);
  }
  for (std::size_t t = 0; t < seen.triangle_count(); ++t) ASSERT_NE(atlas_area(seen, t), 0.0);
  ASSERT_GT(picture_of_atlas(seen, atlas_points).overlapping, 1000U);
  EXPECT_EQ(unwrap_well(mesh).charts, 2U);
  Mesh less = spiral_ramp(0.8F);
  EXPECT_EQ(unwrap_well(less).charts, 1U);
}

TEST(Unwrap, FoldsAreCharts) {
  Mesh mesh = folded_sheet();
  const UnwrapReport report = unwrap_well(mesh);
  EXPECT_GE(report.charts, 3U);
  EXPECT_LE(report.charts, 5U);
}

TEST(Unwrap, EveryChartIsAParallelProjectionOfOneDensity) {
  Mesh mesh = bumpy_ball();
  const UnwrapReport report = unwrap_well(mesh);
  double all_shown = 0.0;
  double all_area = 0.0;
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    all_shown += atlas_area(mesh, t);
    all_area += surface_area(mesh, t);
  }
  const auto charts = corners_of_charts(mesh);
  ASSERT_EQ(charts.size(), report.charts);
  for (const auto& corners : charts) {
    double shown = 0.0;
    double area = 0.0;
    Eigen::MatrixXd places(static_cast<Eigen::Index>(corners.size()), 4);
    Eigen::MatrixXd uvs(static_cast<Eigen::Index>(corners.size()), 2);
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      places.row(row) << mesh.position(corners[i]).cast<double>().transpose(), 1.0;
      uvs.row(row) = mesh.uvs[corners[i]].cast<double>().transpose();
      shown += atlas_area(mesh, corners[i] / 3) / 3.0;
      area += surface_area(mesh, corners[i] / 3) / 3.0;
    }
    EXPECT_NEAR(shown / area, all_shown / all_area, 1e-3 * all_shown / all_area);
    if (corners.size() < 30) continue;
    const Eigen::MatrixXd map = places.colPivHouseholderQr().solve(uvs);
    EXPECT_LT((places * map - uvs).cwiseAbs().maxCoeff(), 1e-6);
    // Both axes of the picture are as long, and at right angles.
    const Vec3d u = map.col(0).head<3>();
    const Vec3d v = map.col(1).head<3>();
    EXPECT_NEAR(u.norm(), v.norm(), 1e-4 * u.norm());
    EXPECT_NEAR(u.dot(v), 0.0, 1e-4 * u.squaredNorm());
  }
}

TEST(Unwrap, GutterStaysFree) {
  Mesh mesh = bare(uv_sphere(48, 24));
  UnwrapOptions options;
  options.size = 512;
  options.gutter = 10;
  unwrap_well(mesh, options);
  const Seams seams = find_seams(mesh);
  std::vector<std::uint32_t> chart(std::size_t{512} * 512, no_chart);
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    for_each_point_inside(mesh, t, 512, [&](int x, int y) {
      chart[static_cast<std::size_t>(y * 512 + x)] = seams.chart[t];
    });
  }
  std::size_t near = 0;
  for (int y = 0; y < 512; ++y) {
    for (int x = 0; x < 512; ++x) {
      const std::uint32_t own = chart[static_cast<std::size_t>(y * 512 + x)];
      if (own == no_chart) continue;
      EXPECT_TRUE(x >= 4 && x < 508 && y >= 4 && y < 508) << x << " " << y;
      for (int other = x + 1; other <= std::min(511, x + 9); ++other) {
        const std::uint32_t beside = chart[static_cast<std::size_t>(y * 512 + other)];
        if (beside != no_chart && beside != own) ++near;
      }
      for (int other = y + 1; other <= std::min(511, y + 9); ++other) {
        const std::uint32_t below = chart[static_cast<std::size_t>(other * 512 + x)];
        if (below != no_chart && below != own) ++near;
      }
    }
  }
  EXPECT_EQ(near, 0U);
}

TEST(Unwrap, StretchAndAngleMakeMoreOrFewerCharts) {
  NORMALSHOP_SKIP_FIGURES();
  const auto charts = [](float stretch, float angle) {
    Mesh mesh = bumpy_ball();
    UnwrapOptions options;
    options.stretch = stretch;
    options.angle = angle;
    return unwrap_well(mesh, options).charts;
  };
  const std::size_t usual = charts(1.2F, 75.0F);
  EXPECT_GT(charts(1.02F, 75.0F), 2 * usual);
  EXPECT_GT(charts(1.2F, 35.0F), 2 * usual);
}

TEST(Unwrap, SameForAnyNumberOfThreads) {
  Mesh many = bumpy_ball();
  Mesh one = many;
  unwrap(many);
  {
    const ThreadLimit limit(1);
    unwrap(one);
  }
  EXPECT_TRUE(many.uvs == one.uvs);
}

TEST(Unwrap, DegenerateTrianglesGetSomePlace) {
  Mesh mesh = bare(plane_grid(3));
  const auto add = [&](const Vec3f& a, const Vec3f& b, const Vec3f& c) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), {a, b, c});
    mesh.triangles.emplace_back(first, first + 1, first + 2);
    mesh.normals.insert(mesh.normals.end(), 3, Vec3f(0.0F, 0.0F, 1.0F));
  };
  const Vec3f o(0.0F, 0.0F, 0.0F);
  const Vec3f x(1.0F, 0.0F, 0.0F);
  const Vec3f y(0.0F, 1.0F, 0.0F);
  add(o, o, o);
  add(o, x, x);
  add(o, 0.5F * x, x);
  add(Vec3f(5, 5, 5), Vec3f(5, 5, 5), Vec3f(6, 5, 5));
  const std::size_t without_area = 4;
  // A triangle of the plane again, the same from behind, and a fin on an edge of three.
  const Vec3f third = x / 3.0F;
  add(o, third, third + y / 3.0F);
  add(o, third + y / 3.0F, third);
  add(o, third, Vec3f(0.2F, 0.0F, 0.5F));
  const UnwrapReport report = unwrap_well(mesh);
  EXPECT_EQ(report.degenerate, without_area);
  EXPECT_GE(report.charts, 4U);
  EXPECT_LE(report.charts, 5U);
}

TEST(Unwrap, SoupOfTrianglesSurvives) {
  Random random(7);
  Mesh mesh;
  for (int i = 0; i < 60; ++i) {
    mesh.positions.emplace_back(random.uniform(), random.uniform(), random.uniform());
  }
  for (int i = 0; i < 200; ++i) {
    mesh.triangles.emplace_back(random.next() % 60, random.next() % 60, random.next() % 60);
  }
  compute_normals(mesh);
  const UnwrapReport report = unwrap(mesh);
  EXPECT_EQ(picture_of_atlas(mesh, atlas_points).overlapping, 0U);
  EXPECT_EQ(report.overlaps, 0U);
  EXPECT_EQ(report.turned_over, 0U);
  for (const Vec2f& uv : mesh.uvs) EXPECT_TRUE(uv.minCoeff() >= 0.0F && uv.maxCoeff() <= 1.0F);
}

TEST(Unwrap, NeedlesFit) {
  NORMALSHOP_SKIP_FIGURES();
  Mesh mesh;
  mesh.positions = {{0.0F, 0.0F, 0.0F}, {1.0F, 0.0F, 0.0F}, {1.0F, 1e-5F, 0.0F}};
  mesh.triangles = {{0, 1, 2}};
  UnwrapReport report = unwrap(mesh);
  EXPECT_EQ(report.charts, 1U);
  EXPECT_GT((mesh.uvs[1] - mesh.uvs[0]).norm(), 0.9F);
  // A thousand loose ones.
  mesh = {};
  for (int i = 0; i < 1000; ++i) {
    const auto y = static_cast<float>(i);
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), {Vec3f(0.0F, y, 0.0F), Vec3f(40.0F, y, 0.0F),
                                                 Vec3f(40.0F, y + 0.5F, 1.0F)});
    mesh.triangles.emplace_back(first, first + 1, first + 2);
  }
  report = unwrap(mesh);
  EXPECT_EQ(report.charts, 1000U);
  EXPECT_EQ(report.overlaps, 0U);
  EXPECT_EQ(picture_of_atlas(mesh, atlas_points).overlapping, 0U);
}

TEST(Unwrap, TangentsGoAndTheNameStays) {
  Mesh mesh = cube(2);
  ASSERT_FALSE(mesh.tangents.empty());
  unwrap(mesh);
  EXPECT_TRUE(mesh.tangents.empty());
  EXPECT_EQ(mesh.texture_set_names, std::vector<std::string>{"map"});
  EXPECT_EQ(mesh.normals, cube(2).normals);
  mesh.texture_set_names = {"a", "b"};
  unwrap(mesh);
  EXPECT_EQ(mesh.texture_set_names, std::vector<std::string>{"surface"});
}

void expect_refusal(Mesh mesh, const UnwrapOptions& options, const std::string& word) {
  const std::vector<Vec2f> before = mesh.uvs;
  try {
    unwrap(mesh, options);
    ADD_FAILURE() << word << " was accepted";
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
  }
  EXPECT_EQ(mesh.uvs, before);
}

TEST(Unwrap, RefusesWhatCannotBeUnwrapped) {
  expect_refusal({}, {}, "no triangles");
  Mesh line = bare(plane_grid(1));
  for (Vec3f& p : line.positions) p.y() = 0.0F;
  expect_refusal(line, {}, "area");
  Mesh index = plane_grid(1);
  index.triangles[0][1] = 77;
  expect_refusal(index, {}, "position");
  Mesh infinite = plane_grid(1);
  infinite.positions[2].x() = std::numeric_limits<float>::infinity();
  expect_refusal(infinite, {}, "finite");
  Mesh normals = plane_grid(1);
  normals.normals.pop_back();
  expect_refusal(normals, {}, "normals");
  UnwrapOptions options;
  options.angle = 90.0F;
  expect_refusal(plane_grid(1), options, "angle must be from 1 to 85");
  options = {};
  options.stretch = std::numeric_limits<float>::quiet_NaN();
  expect_refusal(plane_grid(1), options, "stretch");
  options = {};
  options.gutter = -1;
  expect_refusal(plane_grid(1), options, "gutter must be from 0 to 64");
  options.size = 64;
  options.gutter = 64;
  expect_refusal(cube(1), options, "6 charts do not fit");
}

TEST(Unwrap, CancelledLeavesTheMesh) {
  Mesh mesh = plane_grid(2);
  const std::vector<Vec2f> before = mesh.uvs;
  Progress progress;
  progress.report = [](double fraction, std::string_view) { return fraction < 0.8; };
  EXPECT_THROW(unwrap(mesh, {}, progress), Cancelled);
  EXPECT_EQ(mesh.uvs, before);
  EXPECT_FALSE(mesh.tangents.empty());
}

}  // namespace
}  // namespace normalshop::test
