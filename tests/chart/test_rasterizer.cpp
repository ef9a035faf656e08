#include <cmath>

#include <gtest/gtest.h>

#include "normalshop/chart/rasterizer.h"
#include "normalshop/core/parallel.h"
#include "normalshop/core/random.h"

namespace normalshop {
namespace {

constexpr double nothing = -1e300;

/// A view along -z with pixels of 1: lattice pixel (i, j) has its centre at (i + 0.5, -j - 0.5).
ChartGrid unit_grid(const Rect& window) {
  ChartGrid grid;
  grid.view.width = static_cast<float>(window.width());
  grid.view.height = static_cast<float>(window.height());
  grid.window = window;
  return grid;
}

/// On the rasteriser's lattice of 1/256 pixels, so that the reference sees the same vertices.
float snapped(float v) { return std::round(256.0F * v) / 256.0F; }

void add(Mesh& mesh, const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (const Vec3f& p : {a, b, c}) {
    mesh.positions.emplace_back(snapped(p.x()), snapped(p.y()), p.z());
  }
  mesh.triangles.emplace_back(first, first + 1, first + 2);
}

/// Depth of triangle t at a pixel centre, or `nothing`: exact coverage by the top-left rule.
double depth_at(const Mesh& mesh, std::size_t t, double x, double y) {
  std::array<Vec3d, 3> p;
  for (std::size_t k = 0; k < 3; ++k) p[k] = mesh.position(3 * t + k).cast<double>();
  // Image axes, y down, clockwise or not.
  for (Vec3d& v : p) v.y() = -v.y();
  const auto cross = [](const Vec3d& a, const Vec3d& b, double px, double py) {
    return (b.x() - a.x()) * (py - a.y()) - (b.y() - a.y()) * (px - a.x());
  };
  double area = cross(p[0], p[1], p[2].x(), p[2].y());
  if (area == 0.0) return nothing;
  if (area < 0.0) {
    std::swap(p[1], p[2]);
    area = -area;
  }
  std::array<double, 3> e{};
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3d& a = p[k];
    const Vec3d& b = p[(k + 1) % 3];
    e[k] = cross(a, b, x, -y);
    const bool top_left = b.y() < a.y() || (b.y() == a.y() && b.x() > a.x());
    if (e[k] < 0.0 || (e[k] == 0.0 && !top_left)) return nothing;
  }
  return (e[1] * p[0].z() + e[2] * p[1].z() + e[0] * p[2].z()) / area;
}

struct Mistakes {
  int coverage = 0;  ///< surface where there is none, or the other way round
  int hidden = 0;    ///< a triangle that is not the nearest
  int depth = 0;
};

Mistakes compare(const Mesh& mesh, const ChartGrid& grid, const IdBuffer& ids, double tolerance) {
  Mistakes out;
  for (int j = 0; j < grid.height(); ++j) {
    for (int i = 0; i < grid.width(); ++i) {
      const double x = grid.window.x0 + i + 0.5;
      const double y = -(grid.window.y0 + j + 0.5);
      double nearest = nothing;
      for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
        nearest = std::max(nearest, depth_at(mesh, t, x, y));
      }
      const std::uint32_t id = ids.triangle(i, j);
      if ((id == no_triangle) != (nearest == nothing)) {
        ++out.coverage;
      } else if (id == no_triangle) {
        out.depth += std::isinf(ids.depth(i, j)) ? 0 : 1;
      } else {
        out.hidden += depth_at(mesh, id, x, y) >= nearest - tolerance ? 0 : 1;
        out.depth += std::abs(double(ids.depth(i, j)) - nearest) <= tolerance ? 0 : 1;
      }
    }
  }
  return out;
}

void expect_none(const Mistakes& m) {
  EXPECT_EQ(m.coverage, 0);
  EXPECT_EQ(m.hidden, 0);
  EXPECT_EQ(m.depth, 0);
}

Vec3f random_point(Random& random, float reach) {
  return {random.uniform(-reach, reach), random.uniform(-reach, reach), random.uniform(0, 10)};
}

TEST(Rasterizer, random_triangles_match_a_reference) {
  Random random(7);
  Mesh mesh;
  for (int i = 0; i < 40; ++i) {  // of all sizes, many beyond the window
    const float reach = i % 4 == 0 ? 400.0F : i % 4 == 1 ? 90.0F : 60.0F;
    add(mesh, random_point(random, reach), random_point(random, reach),
        random_point(random, reach));
  }
  for (int i = 0; i < 200; ++i) {  // small
    const Vec3f at = random_point(random, 80.0F);
    add(mesh, at + random_point(random, 4), at + random_point(random, 4),
        at + random_point(random, 4));
  }
  const ChartGrid grid = unit_grid({-77, -70, 74, 69});
  IdBuffer ids;
  Rasterizer().rasterize(mesh, grid, ids);
  expect_none(compare(mesh, grid, ids, 1e-3));
}

TEST(Rasterizer, slivers_match_a_reference) {
  Random random(8);
  Mesh mesh;
  for (int i = 0; i < 150; ++i) {
    const Vec3f a = random_point(random, 70.0F);
    const Vec3f b = random_point(random, 70.0F);
    const Vec3f off(random.uniform(-0.05F, 0.05F), random.uniform(-0.05F, 0.05F), 0.0F);
    add(mesh, a, b, 0.5F * (a + b) + off);
  }
  const ChartGrid grid = unit_grid({-64, -64, 64, 64});
  IdBuffer ids;
  Rasterizer().rasterize(mesh, grid, ids);
  const Mistakes m = compare(mesh, grid, ids, 0.5);  // planes of slivers are steep
  EXPECT_EQ(m.coverage, 0);
  EXPECT_EQ(m.hidden, 0);
}

/// A jittered grid: every pixel centre belongs to exactly one triangle.
TEST(Rasterizer, neighbours_leave_no_hole_and_share_no_pixel) {
  Random random(3);
  constexpr int n = 24;
  std::vector<Vec3f> p;
  for (int j = 0; j <= n; ++j) {
    for (int i = 0; i <= n; ++i) {
      // Some vertices exactly on pixel centres.
      const bool on_centre = (i + j) % 3 == 0;
      const auto jitter = [&] { return on_centre ? 0.5F : random.uniform(-1.4F, 1.4F); };
      p.emplace_back(static_cast<float>(4 * i - 48) + jitter(),
                     static_cast<float>(4 * j - 48) + jitter(), 0.0F);
    }
  }
  Mesh mesh;
  const auto at = [&](int i, int j) { return p[static_cast<std::size_t>(j * (n + 1) + i)]; };
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      add(mesh, at(i, j), at(i + 1, j), at(i + 1, j + 1));
      add(mesh, at(i, j), at(i + 1, j + 1), at(i, j + 1));
    }
  }
  const ChartGrid grid = unit_grid({-44, -44, 44, 44});
  IdBuffer ids;
  Rasterizer().rasterize(mesh, grid, ids);
  for (int j = 0; j < grid.height(); ++j) {
    for (int i = 0; i < grid.width(); ++i) {
      int owners = 0;
      std::uint32_t owner = no_triangle;
      for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
        if (depth_at(mesh, t, grid.window.x0 + i + 0.5, -(grid.window.y0 + j + 0.5)) == nothing) {
          continue;
        }
        ++owners;
        owner = static_cast<std::uint32_t>(t);
      }
      ASSERT_EQ(owners, 1);
      ASSERT_EQ(ids.triangle(i, j), owner);
    }
  }
}

TEST(Rasterizer, equally_near_triangles_go_by_face_then_order) {
  Mesh mesh;
  const Vec3f a(-9, -9, 1);
  const Vec3f b(9, -9, 1);
  const Vec3f c(0, 9, 1);
  add(mesh, a, c, b);  // turned away
  add(mesh, a, b, c);  // faces the viewer
  add(mesh, a, b, c);
  const ChartGrid grid = unit_grid({-10, -10, 10, 10});
  IdBuffer ids;
  Rasterizer().rasterize(mesh, grid, ids);
  EXPECT_EQ(ids.triangle(10, 10), 1U);
  mesh.positions[0].z() = mesh.positions[1].z() = mesh.positions[2].z() = 2.0F;
  Rasterizer().rasterize(mesh, grid, ids);
  EXPECT_EQ(ids.triangle(10, 10), 0U) << "a nearer back face hides";
}

Mesh random_soup(int count) {
  Random random(21);
  Mesh mesh;
  for (int i = 0; i < count; ++i) {
    const Vec3f at = random_point(random, 300.0F);
    add(mesh, at, at + random_point(random, 20), at + random_point(random, 20));
  }
  return mesh;
}

TEST(Rasterizer, threads_change_nothing) {
  const Mesh mesh = random_soup(40000);
  const ChartGrid grid = unit_grid({-200, -190, 210, 180});
  IdBuffer many;
  IdBuffer one;
  Rasterizer().rasterize(mesh, grid, many);
  const ThreadLimit limit(1);
  Rasterizer().rasterize(mesh, grid, one);
  for (int y = 0; y < grid.height(); ++y) {
    for (int x = 0; x < grid.width(); ++x) {
      ASSERT_EQ(many.triangle(x, y), one.triangle(x, y));
      ASSERT_EQ(many.depth(x, y), one.depth(x, y));
    }
  }
}

TEST(Rasterizer, a_window_shows_what_the_whole_shows) {
  const Mesh mesh = random_soup(3000);
  const ChartGrid whole = unit_grid({-200, -200, 200, 200});
  const ChartGrid part = unit_grid({-37, -90, 101, 3});
  Rasterizer rasterizer;  // also: buffers are reused
  IdBuffer a;
  IdBuffer b;
  rasterizer.rasterize(mesh, whole, a);
  rasterizer.rasterize(mesh, part, b);
  int different = 0;
  for (int y = 0; y < part.height(); ++y) {
    for (int x = 0; x < part.width(); ++x) {
      different += a.triangle(x + 163, y + 110) == b.triangle(x, y) ? 0 : 1;
    }
  }
  EXPECT_EQ(different, 0);
}

TEST(Rasterizer, one_pixel_and_empty_meshes) {
  Mesh mesh;
  const ChartGrid grid = unit_grid({0, 0, 1, 1});
  IdBuffer ids;
  Rasterizer rasterizer;
  rasterizer.rasterize(mesh, grid, ids);
  EXPECT_EQ(ids.triangle(0, 0), no_triangle);
  EXPECT_TRUE(std::isinf(ids.depth(0, 0)) && ids.depth(0, 0) < 0);
  add(mesh, {-1e6F, -1e6F, 2}, {1e6F, -1e6F, 2}, {0, 1e6F, 2});
  add(mesh, {5, 5, 3}, {5, 5, 3}, {5, 5, 3});
  rasterizer.rasterize(mesh, grid, ids);
  EXPECT_EQ(ids.triangle(0, 0), 0U);
  EXPECT_FLOAT_EQ(ids.depth(0, 0), 2.0F);
}

}  // namespace
}  // namespace normalshop
