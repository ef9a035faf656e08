#include <array>
#include <cmath>
#include <numbers>
#include <queue>

#include "support/meshes.h"
#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "normalshop/core/error.h"
#include "normalshop/surface/geodesic.h"
#include "normalshop/surface/nearest_point.h"
#include "normalshop/surface/shapes.h"
#include "normalshop/surface/subdivide.h"

namespace normalshop {
namespace {

constexpr double pi = std::numbers::pi;

SurfacePath path_between(const Mesh& mesh, std::initializer_list<Vec3f> places) {
  std::vector<SurfacePoint> points;
  for (const Vec3f& p : places) points.push_back(nearest_surface_point(mesh, p));
  return geodesic(mesh, make_topology(mesh), points);
}

/// A grid of quads whose point (i, j) lies at place(i, j).
template <class Place>
Mesh grid_mesh(int columns, int rows, const Place& place) {
  test::MeshBuilder builder;
  const auto corner = [&](int i, int j) {
    const Vec2f uv(static_cast<float>(i) / static_cast<float>(columns),
                   static_cast<float>(j) / static_cast<float>(rows));
    return test::MeshBuilder::Corner{place(i, j), Vec3f::UnitZ(), uv};
  };
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      builder.quad(corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1));
    }
  }
  return builder.finish();
}

/// A point of an exact circle of `count` corners, so that the last is the first.
Vec2f on_circle(int i, int count) {
  const double angle = 2.0 * pi * (i % count) / count;
  return {static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle))};
}

Mesh torus(int around, int across) {
  return grid_mesh(around, across, [&](int i, int j) {
    const Vec2f a = on_circle(i, around);
    const Vec2f b = on_circle(j, across);
    const float radius = 1.0F + 0.4F * b.x();
    return Vec3f(radius * a.x(), radius * a.y(), 0.4F * b.y());
  });
}

double between(const Vec3d& a, const Vec3d& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

/// The smaller of the angles on both sides of a path's point, pi wherever it is straight; sides
/// that an open border ends count as pi.
double least_angle(const Mesh& mesh, const Topology& topology, const SurfacePath& path,
                   std::size_t i) {
  const Vec3d here = path.positions[i];
  const Vec3d in = path.positions[i - 1] - here;
  const Vec3d out = path.positions[i + 1] - here;
  const auto at = [&](std::uint32_t corner) {
    return Vec3d(mesh.position(corner).cast<double>() - here);
  };
  const std::uint32_t from = path.points[i - 1].triangle;
  const std::uint32_t to = path.points[i].triangle;
  for (std::uint32_t corner = 3 * from; corner < 3 * from + 3; ++corner) {
    if (at(corner).norm() > 1e-6) continue;
    double least = pi;  // turns around the vertex both ways
    for (const bool left : {true, false}) {
      std::uint32_t edge = left ? corner : previous_corner(corner);
      Vec3d before = in;
      double sum = 0.0;
      bool open = from == to;
      while (!open) {
        const Vec3d spoke = at(left ? next_corner(edge) : edge);
        sum += between(before, spoke);
        before = spoke;
        const std::uint32_t across = topology.neighbor[edge];
        open = across == no_edge;
        if (open || across / 3 == to) break;
        edge = left ? next_corner(across) : previous_corner(across);
      }
      if (!open) least = std::min(least, sum + between(before, out));
    }
    return least;
  }
  for (std::uint32_t edge = 3 * from; edge < 3 * from + 3; ++edge) {
    const std::uint32_t across = topology.neighbor[edge];
    if (across == no_edge || across / 3 != to) continue;
    const Vec3d along = at(next_corner(edge)) - at(edge);
    const double sum = between(in, along) + between(along, out);
    return std::min(sum, 2.0 * pi - sum);
  }
  return 0.0;
}

double least_angle(const Mesh& mesh, const SurfacePath& path) {
  const Topology topology = make_topology(mesh);
  double least = pi;
  for (std::size_t i = 1; i + 1 < path.points.size(); ++i) {
    least = std::min(least, least_angle(mesh, topology, path, i));
  }
  return least;
}

/// Along edges, from the vertex at a to the vertex at b.
double dijkstra(const Mesh& mesh, const Vec3f& a, const Vec3f& b) {
  const Welding welding = weld_positions(mesh);
  const auto n = welding.vertex_count;
  std::vector<std::vector<std::pair<std::uint32_t, double>>> edges(n);
  std::vector<Vec3d> places(n);
  for (std::uint32_t c = 0; c < mesh.corner_count(); ++c) {
    const std::uint32_t v = welding.vertex[c];
    const std::uint32_t w = welding.vertex[next_corner(c)];
    places[v] = mesh.position(c).cast<double>();
    const double length = (mesh.position(next_corner(c)) - mesh.position(c)).cast<double>().norm();
    edges[v].emplace_back(w, length);
    edges[w].emplace_back(v, length);
  }
  const auto nearest = [&](const Vec3f& p) {
    std::uint32_t best = 0;
    for (std::uint32_t v = 0; v < n; ++v) {
      if ((places[v] - p.cast<double>()).norm() < (places[best] - p.cast<double>()).norm())
        best = v;
    }
    return best;
  };
  std::vector<double> cost(n, 1e30);
  std::priority_queue<std::pair<double, std::uint32_t>> open;
  cost[nearest(a)] = 0.0;
  open.emplace(0.0, nearest(a));
  while (!open.empty()) {
    const auto [negative, v] = open.top();
    open.pop();
    for (const auto& [w, length] : edges[v]) {
      if (!(cost[v] + length < cost[w])) continue;
      cost[w] = cost[v] + length;
      open.emplace(-cost[w], w);
    }
  }
  return cost[nearest(b)];
}

TEST(Geodesic, IsStraightOnAPlaneAndAcrossItsSeam) {
  const Mesh mesh = test::plane_two_charts(6);
  const SurfacePath path = path_between(mesh, {{0.07F, 0.12F, 0.0F}, {0.93F, 0.81F, 0.0F}});
  EXPECT_NEAR(path.length(), std::hypot(0.86, 0.69), 1e-6);
  ASSERT_GT(path.points.size(), 12U);
  for (std::size_t i = 0; i < path.points.size(); ++i) {
    const Vec3d& p = path.positions[i];
    EXPECT_NEAR((p.x() - 0.07) * 0.69 - (p.y() - 0.12) * 0.86, 0.0, 1e-6);
    EXPECT_LT((position_at(mesh, path.points[i]).cast<double>() - p).norm(), 1e-6);
    EXPECT_GT(path.lengths[i], i > 0 ? path.lengths[i - 1] : -1.0);
  }
}

TEST(Geodesic, StaysInsideOneTriangleAndAtOnePoint) {
  const Mesh mesh = test::plane_grid(1);
  const SurfacePath one = path_between(mesh, {{0.2F, 0.1F, 0.0F}});
  EXPECT_EQ(one.points.size(), 1U);
  EXPECT_EQ(one.length(), 0.0);
  EXPECT_EQ(path_between(mesh, {{0.2F, 0.1F, 0.0F}, {0.2F, 0.1F, 0.0F}}).points.size(), 1U);
  const SurfacePath inside = path_between(mesh, {{0.2F, 0.1F, 0.0F}, {0.8F, 0.5F, 0.0F}});
  EXPECT_EQ(inside.points.size(), 2U);
  EXPECT_NEAR(inside.length(), std::hypot(0.6, 0.4), 1e-6);
}

TEST(Geodesic, UnfoldsTheCube) {
  for (const int n : {1, 3, 4}) {
    const Mesh mesh = test::cube(n);
    const SurfacePath near = path_between(mesh, {{0.3F, 0.2F, 1.0F}, {1.0F, -0.4F, 0.1F}});
    EXPECT_NEAR(near.length(), std::hypot(0.7 + 0.9, 0.6), 1e-5) << n;
    const SurfacePath far = path_between(mesh, {{0.1F, 0.0F, 1.0F}, {0.1F, 0.0F, -1.0F}});
    EXPECT_LE(far.length(), 4.2 + 1e-5) << n;
    EXPECT_GE(least_angle(mesh, far), pi - 1e-5) << n;
  }
}

TEST(Geodesic, RollsOutTheCylinder) {
  const int count = 24;
  const Mesh mesh = grid_mesh(count, 10, [&](int i, int j) {
    const Vec2f p = on_circle(i, count);
    return Vec3f(p.x(), p.y(), 0.3F * static_cast<float>(j));
  });
  // A prism: every side is 2 sin(pi / n) wide.
  const double side_width = 2.0 * std::sin(pi / count);
  const Vec2f a = on_circle(1, count);
  const Vec2f b = on_circle(9, count);
  const SurfacePath path = path_between(mesh, {{a.x(), a.y(), 0.3F}, {b.x(), b.y(), 2.4F}});
  EXPECT_NEAR(path.length(), std::hypot(8.0 * side_width, 2.1), 1e-5);
  EXPECT_GE(least_angle(mesh, path), pi - 1e-5);
}

TEST(Geodesic, RollsOutTheCone) {
  // Six triangles of 40 degrees around the apex: 240 degrees in all.
  const int count = 6;
  const double apex_angle = 40.0 * pi / 180.0;
  const double rim = std::sin(apex_angle / 2.0) / std::sin(pi / count);
  const Mesh mesh = grid_mesh(count, 8, [&](int i, int j) {
    const double r = j / 8.0;
    const Vec2f p = on_circle(i, count);
    return Vec3f(static_cast<float>(r * rim) * p.x(), static_cast<float>(r * rim) * p.y(),
                 static_cast<float>(-r * std::sqrt(1.0 - rim * rim)));
  });
  const auto at = [&](int i, double r) {
    const Vec2f p = on_circle(i, count);
    return Vec3f(static_cast<float>(r * rim) * p.x(), static_cast<float>(r * rim) * p.y(),
                 static_cast<float>(-r * std::sqrt(1.0 - rim * rim)));
  };
  const SurfacePath path = path_between(mesh, {at(0, 0.9), at(3, 0.7)});
  const double expected = std::sqrt(0.81 + 0.49 - 2.0 * 0.63 * std::cos(3.0 * apex_angle));
  EXPECT_NEAR(path.length(), expected, 1e-5);
  EXPECT_GE(least_angle(mesh, path), pi - 1e-5);
}

TEST(Geodesic, FollowsGreatCirclesBetterOnFinerSpheres) {
  const Vec3f a = Vec3f(0.3F, 0.5F, 0.8F).normalized();
  const Vec3f b = Vec3f(-0.7F, -0.1F, -0.4F).normalized();
  const double expected = between(a.cast<double>(), b.cast<double>());
  double previous = 1.0;
  for (const int segments : {12, 24, 48, 96}) {
    const Mesh mesh = test::uv_sphere(segments, segments / 2);
    const SurfacePath path = path_between(mesh, {a, b});
    const double error = std::abs(path.length() - expected);
    EXPECT_LT(error, 0.5 * previous) << segments;
    EXPECT_GE(least_angle(mesh, path), pi - 1e-5) << segments;
    previous = error;
  }
  EXPECT_LT(previous, 2e-3);
}

TEST(Geodesic, IsLocallyShortestAndNoLongerThanAlongEdges) {
  const Mesh ring = torus(40, 20);
  const Mesh ball = cube_sphere(8, {}, "map");
  for (int k = 0; k < 12; ++k) {
    const Vec3f a(std::sin(1.0F + 3.0F * static_cast<float>(k)),
                  std::cos(2.3F * static_cast<float>(k)), 0.4F * std::sin(static_cast<float>(k)));
    const Vec3f b(std::cos(0.7F * static_cast<float>(k)), -std::sin(1.9F * static_cast<float>(k)),
                  0.3F);
    for (const Mesh* mesh : {&ring, &ball}) {
      // From vertices, so that both compare.
      const auto vertex = [&](const Vec3f& p) {
        return mesh->position(3 * nearest_surface_point(*mesh, p).triangle);
      };
      const SurfacePath path = path_between(*mesh, {vertex(a), vertex(b)});
      EXPECT_GE(least_angle(*mesh, path), pi - 1e-5) << k;
      EXPECT_LE(path.length(), dijkstra(*mesh, vertex(a), vertex(b)) + 1e-6) << k;
      EXPECT_NEAR(path.length(), path_between(*mesh, {vertex(b), vertex(a)}).length(), 0.05) << k;
    }
  }
}

TEST(Geodesic, BendsAroundHolesOnly) {
  // A square with a square hole in its middle third: round its corner.
  test::MeshBuilder builder;
  const auto corner = [](int i, int j) {
    const auto x = static_cast<float>(i);
    const auto y = static_cast<float>(j);
    return test::MeshBuilder::Corner{{x, y, 0.0F}, Vec3f::UnitZ(), {x / 9.0F, y / 9.0F}};
  };
  for (int j = 0; j < 9; ++j) {
    for (int i = 0; i < 9; ++i) {
      if (i / 3 == 1 && j / 3 == 1) continue;
      builder.quad(corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1));
    }
  }
  const Mesh mesh = builder.finish();
  const SurfacePath path = path_between(mesh, {{1.5F, 4.0F, 0.0F}, {7.5F, 4.0F, 0.0F}});
  EXPECT_NEAR(path.length(), 2.0 * std::hypot(1.5, 1.0) + 3.0, 1e-5);
}

TEST(Geodesic, PassesThroughTheGivenPoints) {
  const Mesh mesh = test::plane_grid(5);
  const SurfacePath path =
      path_between(mesh, {{0.1F, 0.1F, 0.0F}, {0.9F, 0.1F, 0.0F}, {0.9F, 0.7F, 0.0F}});
  ASSERT_EQ(path.given.size(), 3U);
  EXPECT_NEAR(path.lengths[path.given[1]], 0.8, 1e-6);
  EXPECT_NEAR(path.length(), 1.4, 1e-6);
  EXPECT_LT((path.positions[path.given[1]] - Vec3d(0.9, 0.1, 0.0)).norm(), 1e-6);
  // Every piece lies in the triangle of its first point.
  for (std::size_t i = 0; i + 1 < path.points.size(); ++i) {
    const std::uint32_t t = path.points[i].triangle;
    for (const Vec3d& end : {path.positions[i], path.positions[i + 1]}) {
      double inside = 0.0;
      for (std::uint32_t k = 0; k < 3; ++k) {
        const Vec3d p = mesh.position(3 * t + k).cast<double>() - end;
        const Vec3d q = mesh.position(3 * t + (k + 1) % 3).cast<double>() - end;
        inside += p.cross(q).norm();
      }
      EXPECT_NEAR(inside, 0.04, 1e-6) << i;
    }
  }
}

TEST(Geodesic, RefusesPartsThatDoNotHangTogether) {
  test::MeshBuilder builder;
  const auto corner = [](float x, float y) {
    return test::MeshBuilder::Corner{{x, y, 0.0F}, Vec3f::UnitZ(), {x, y}};
  };
  builder.triangle(corner(0.0F, 0.0F), corner(1.0F, 0.0F), corner(0.0F, 1.0F));
  builder.triangle(corner(3.0F, 0.0F), corner(4.0F, 0.0F), corner(3.0F, 1.0F));
  const Mesh mesh = builder.finish();
  try {
    path_between(mesh, {{0.1F, 0.1F, 0.0F}, {0.2F, 0.1F, 0.0F}, {3.1F, 0.1F, 0.0F}});
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("from point 1 to point 2"), std::string::npos);
  }
  EXPECT_THROW(geodesic(mesh, make_topology(mesh), {}), InvalidInput);
  EXPECT_THROW(nearest_surface_point(Mesh{}, Vec3f::Zero()), InvalidInput);
}

TEST(Geodesic, CrossesNoEdgeOfThreeTriangles) {
  test::MeshBuilder builder;
  const auto corner = [](float x, float y, float z) {
    return test::MeshBuilder::Corner{{x, y, z}, Vec3f::UnitZ(), {x, y}};
  };
  const auto a = corner(0.0F, 0.0F, 0.0F);
  const auto b = corner(0.0F, 1.0F, 0.0F);
  builder.triangle(a, corner(1.0F, 0.0F, 0.0F), b);
  builder.triangle(b, corner(-1.0F, 0.0F, 0.0F), a);
  builder.triangle(b, corner(0.0F, 0.5F, 1.0F), a);
  const Mesh mesh = builder.finish();
  EXPECT_THROW(path_between(mesh, {{0.3F, 0.2F, 0.0F}, {-0.3F, 0.2F, 0.0F}}), InvalidInput);
}

TEST(Geodesic, BearsNeedlesAndTrianglesWithoutArea) {
  // Columns so thin that rounding decides, and one of no width at all.
  const std::array<float, 6> columns{0.0F, 1.0F, 1.0F, 1.0000001F, 1.001F, 2.0F};
  const Mesh mesh = grid_mesh(5, 3, [&](int i, int j) {
    return Vec3f(columns[static_cast<std::size_t>(i)], static_cast<float>(j), 0.0F);
  });
  const SurfacePath path = path_between(mesh, {{0.2F, 0.3F, 0.0F}, {1.9F, 2.6F, 0.0F}});
  EXPECT_NEAR(path.length(), std::hypot(1.7, 2.3), 1e-4);
  for (const Vec3d& p : path.positions) EXPECT_TRUE(p.allFinite());
}

TEST(Geodesic, NearestPointSkipsWhatHasNoPlace) {
  Mesh mesh = test::plane_grid(2);
  mesh.positions[0].x() = std::nanf("");
  const SurfacePoint p = nearest_surface_point(mesh, {0.8F, 0.9F, 3.0F});
  EXPECT_LT((position_at(mesh, p) - Vec3f(0.8F, 0.9F, 0.0F)).norm(), 1e-6F);
}

}  // namespace
}  // namespace normalshop
