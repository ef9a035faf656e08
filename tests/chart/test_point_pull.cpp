#include <array>
#include <cmath>
#include <cstring>
#include <numbers>

#include "chart_fixtures.h"
#include "support/meshes.h"
#include "support/sanitized.h"
#include <gtest/gtest.h>

#include "normalshop/chart/nearest_fill.h"
#include "normalshop/chart/point_pull.h"
#include "normalshop/chart/update_storage.h"
#include "normalshop/core/parallel.h"
#include "normalshop/core/random.h"

namespace normalshop {
namespace {

using namespace test;

/// Around y, radii 1 and 0.4; the map once around both ways.
Mesh ring_torus(int around, int across) {
  const auto corner = [&](int i, int j) {
    const float u = static_cast<float>(i) / static_cast<float>(around);
    const float v = static_cast<float>(j) / static_cast<float>(across);
    const float a = 2.0F * std::numbers::pi_v<float> * u;
    const float b = 2.0F * std::numbers::pi_v<float> * v;
    const Vec3f out(std::sin(a), 0.0F, std::cos(a));
    const Vec3f normal = std::cos(b) * out - std::sin(b) * Vec3f::UnitY();
    return MeshBuilder::Corner{out + 0.4F * normal, normal, {u, v}};
  };
  MeshBuilder builder;
  for (int i = 0; i < around; ++i) {
    for (int j = 0; j < across; ++j) {
      builder.quad(corner(i, j + 1), corner(i + 1, j + 1), corner(i + 1, j), corner(i, j));
    }
  }
  return builder.finish();
}

struct ChartPair {
  EditingChart triangles;
  EditingChart points;
};

ChartPair both_charts(const Mesh& mesh, const StorageAtlas& storage, const View& view, int side) {
  const float pixel = std::max(view.width, view.height) / static_cast<float>(side);
  const ChartGrid grid = make_grid(view, pixel);
  ChartPair out{pull(mesh, storage, grid), pull_points(mesh, storage, grid)};
  find_texels(mesh, storage, out.triangles);
  EffectiveOptions effective;
  effective.step_falloff = 4.0F * pixel;
  compute_weight(out.triangles, effective);
  compute_weight(out.points, effective);
  return out;
}

/// How two charts of one view differ.
struct Difference {
  int both = 0;
  int holes = 0;        ///< pixels that only triangles see, not at the rim
  int outside = 0;      ///< pixels that only points see, more than a pixel away from any triangle
  int well = 0;         ///< pixels in the middle of the effective chart
  int far_texels = 0;   ///< of those: their texels are not neighbours
  double depth = 0.0;   ///< of those: largest difference in pixels
  double normal = 0.0;  ///< of those: mean angle of base normals
};

bool seen_around(const EditingChart& chart, int x, int y, bool all) {
  bool any = false;
  bool every = true;
  for (int j = y - 1; j <= y + 1; ++j) {
    for (int i = x - 1; i <= x + 1; ++i) {
      const bool seen =
          chart.ids.triangle.rect().contains(i, j) && chart.ids.triangle(i, j) != no_triangle;
      any = any || seen;
      every = every && seen;
    }
  }
  return all ? every : any;
}

/// On a map that repeats.
int texels_apart(std::uint32_t a, std::uint32_t b, int size) {
  const auto along = [&](int p, int q) {
    const int d = std::abs(p - q);
    return std::min(d, size - d);
  };
  const TexelPlace p = texel_place(a, size);
  const TexelPlace q = texel_place(b, size);
  return std::max(along(p.x, q.x), along(p.y, q.y));
}

Difference difference(const ChartPair& charts, int size) {
  Difference out;
  const EditingChart& a = charts.triangles;
  const EditingChart& b = charts.points;
  for (int y = 0; y < a.grid.height(); ++y) {
    for (int x = 0; x < a.grid.width(); ++x) {
      const bool in_a = a.ids.triangle(x, y) != no_triangle;
      const bool in_b = b.ids.triangle(x, y) != no_triangle;
      if (in_a && !in_b && seen_around(a, x, y, true)) ++out.holes;
      if (in_b && !in_a && !seen_around(a, x, y, false)) ++out.outside;
      if (!in_a || !in_b) continue;
      ++out.both;
      if (!(std::min(a.weight(x, y), b.weight(x, y)) > 0.5F)) continue;
      ++out.well;
      if (texels_apart(a.texel(x, y), b.texel(x, y), size) > 1) ++out.far_texels;
      const double apart = std::abs(a.ids.depth(x, y) - b.ids.depth(x, y)) / a.grid.pixel;
      out.depth = std::max(out.depth, apart);
      out.normal += angle_degrees(a.base_normal(x, y), b.base_normal(x, y));
    }
  }
  out.normal /= std::max(out.well, 1);
  return out;
}

StorageAtlas noisy(const Mesh& mesh, int size) {
  return storage_of(mesh, noise_map(size, CodeType::U16));
}

void expect_agreement(const Mesh& mesh, int size, const Vec3f& direction, double degrees) {
  const StorageAtlas storage = noisy(mesh, size);
  const ChartPair charts = both_charts(mesh, storage, framing_view(mesh, direction), 300);
  const Difference d = difference(charts, size);
  SCOPED_TRACE("map of " + std::to_string(size) + " from x " + std::to_string(direction.x()));
  EXPECT_GT(d.both, 20000);
  EXPECT_GT(2 * d.well, d.both);
  EXPECT_EQ(d.holes, 0);
  EXPECT_LE(d.outside, size < 100 ? 5 : 0) << "ids may reach half a texel past a silhouette";
  EXPECT_LT(d.far_texels, d.well / 40);
  EXPECT_LT(d.depth, size > 500 ? 0.6 : 2.5) << "planes leave the surface within large texels";
  EXPECT_LT(d.normal, degrees);
}

/// Texels of about 5 pixels (on the sphere and the torus up to 15), 1.2 (4) and 0.4 (1.2).
constexpr std::array<int, 3> map_sizes{64, 256, 800};

TEST(PointPull, plane_as_by_triangles) {
  for (const int size : map_sizes) {
    expect_agreement(plane_grid(8), size, {0, 0, 1}, 1e-3);
    expect_agreement(plane_grid(8), size, {0.5F, 0.3F, 0.8F}, 1e-3);
  }
}

TEST(PointPull, sphere_as_by_triangles) {
  for (const int size : map_sizes) {
    expect_agreement(smooth_sphere(96, 48), size, {0, 0, 1}, 120.0 / size);
    expect_agreement(smooth_sphere(96, 48), size, {0.5F, 0.3F, 0.8F}, 120.0 / size);
  }
}

TEST(PointPull, torus_as_by_triangles) {
  NORMALSHOP_SKIP_FIGURES();
  for (const int size : map_sizes) {
    expect_agreement(ring_torus(96, 48), size, {0.1F, 1, 0.2F}, 200.0 / size);
    expect_agreement(ring_torus(96, 48), size, {0.5F, 0.6F, 0.6F}, 200.0 / size);
  }
}

TEST(PointPull, ids_end_with_an_open_surface) {
  const Mesh mesh = hemisphere(48, 96);
  const StorageAtlas storage = noisy(mesh, 256);
  const ChartPair charts = both_charts(mesh, storage, framing_view(mesh, Vec3f::UnitZ()), 300);
  const Difference d = difference(charts, 256);
  EXPECT_GT(d.well, 30000);
  EXPECT_EQ(d.outside, 0);
  EXPECT_EQ(d.holes, 0);
}

TEST(PointPull, no_holes_at_seams) {
  NORMALSHOP_SKIP_FIGURES();
  const Mesh mesh = plane_two_charts(2);
  for (int size = 24; size < 44; ++size) {
    const StorageAtlas storage = noisy(mesh, size);  // texels of about 10 pixels
    const View view = framing_view(mesh, Vec3f::UnitZ());
    const Difference d = difference(both_charts(mesh, storage, view, 300), size);
    EXPECT_GT(d.both, 82000);
    EXPECT_LE(d.holes, 8) << size << ": in corners far from the next texel";
  }
}

/// Two parallel unit squares, the front one's texels coarser.
Mesh two_sheets(float front_part, float back_part) {
  MeshBuilder builder;
  const auto sheet = [&](float z, float u0, float part) {
    const auto corner = [&](float x, float y) {
      return MeshBuilder::Corner{{x, y, z}, Vec3f::UnitZ(), {u0 + part * x, part * (1.0F - y)}};
    };
    builder.quad(corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1));
  };
  sheet(0.0F, back_part + 0.02F, front_part);
  sheet(-0.03F, 0.01F, back_part);
  return builder.finish();
}

/// Only the front sheet (triangles 0 and 1) within two pixels.
bool inside_front(const EditingChart& chart, int x, int y) {
  for (int j = y - 2; j <= y + 2; ++j) {
    for (int i = x - 2; i <= x + 2; ++i) {
      if (!chart.ids.triangle.rect().contains(i, j) || chart.ids.triangle(i, j) > 1) return false;
    }
  }
  return true;
}

void expect_hidden(float front_part, float back_part, const Vec3f& direction) {
  const Mesh mesh = two_sheets(front_part, back_part);
  const StorageAtlas storage = noisy(mesh, 512);
  const View view = framing_view(mesh, direction);
  const ChartPair charts = both_charts(mesh, storage, view, 200);  // sheets 5 pixels apart
  int front = 0;
  int through = 0;
  for (int y = 0; y < charts.triangles.grid.height(); ++y) {
    for (int x = 0; x < charts.triangles.grid.width(); ++x) {
      if (!inside_front(charts.triangles, x, y)) continue;
      ++front;
      if (charts.points.ids.triangle(x, y) > 1) ++through;
    }
  }
  EXPECT_GT(front, 15000);
  EXPECT_EQ(through, 0) << "front part " << front_part << " from x " << direction.x();
}

TEST(PointPull, hidden_sheet_does_not_show) {
  for (const Vec3f& direction : {Vec3f(0, 0, 1), Vec3f(0.3F, 0.2F, 0.9F)}) {
    expect_hidden(0.08F, 0.75F, direction);  // front texels of 5 pixels, between which all hides
    expect_hidden(0.36F, 0.6F, direction);   // of 1.1 pixels: every pixel has a point of some sheet
  }
}

template <class T>
bool same_pixels(const Image<T>& a, const Image<T>& b) {
  return a.rect() == b.rect() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

TEST(PointPull, same_bits_for_any_number_of_threads) {
  const Mesh mesh = ring_torus(96, 48);
  const StorageAtlas storage = noisy(mesh, 300);
  const View view = framing_view(mesh, {0.5F, 0.6F, 0.6F});
  const ChartGrid grid = make_grid(view, view.width / 400.0F);
  const PullOptions options{.normals = true, .albedo = true};
  const EditingChart many = pull_points(mesh, storage, grid, options);
  const ThreadLimit limit(1);
  const EditingChart one = pull_points(mesh, storage, grid, options);
  EXPECT_TRUE(same_pixels(many.ids.triangle, one.ids.triangle));
  EXPECT_TRUE(same_pixels(many.ids.depth, one.ids.depth));
  EXPECT_TRUE(same_pixels(many.texel, one.texel));
  EXPECT_TRUE(same_pixels(many.base_normal, one.base_normal));
  EXPECT_TRUE(same_pixels(many.normal, one.normal));
  EXPECT_TRUE(same_pixels(many.albedo, one.albedo));
}

/// Largest angle between the chart's normals and those that their texels hold.
double worst_normal(const Mesh& mesh, const StorageAtlas& storage, const EditingChart& chart) {
  const TexelMap& map = storage.sets[0].texels;
  double worst = 0.0;
  for (int y = 0; y < chart.grid.height(); ++y) {
    for (int x = 0; x < chart.grid.width(); ++x) {
      const std::uint32_t triangle = chart.ids.triangle(x, y);
      if (triangle == no_triangle) continue;
      const TexelPlace at = texel_place(chart.texel(x, y), map.width());
      const Vec3f n =
          stored_normal(mesh, storage, at.x, at.y, map.surface_point(triangle, at.x, at.y));
      worst = std::max(worst, static_cast<double>(
                                  angle_degrees(chart.normal(x, y), chart.grid.view.to_chart(n))));
    }
  }
  return worst;
}

TEST(PointPull, normals_are_those_of_the_texels) {
  const Mesh mesh = smooth_sphere(48, 24);
  const View view = framing_view(mesh, {0.5F, 0.3F, 0.8F});
  for (const View& v : {view, mirrored(view, 0, 0.0F)}) {
    const ChartGrid grid = make_grid(v, v.width / 200.0F);
    const StorageAtlas tangent = noisy(mesh, 128);
    EXPECT_LT(worst_normal(mesh, tangent, pull_points(mesh, tangent, grid)), 0.05);
    const StorageAtlas object = storage_of(mesh, 128, NormalSpace::Object, [](const Vec3f& p) {
      return (p + 0.2F * Vec3f(p.y(), p.z(), p.x())).normalized();
    });
    EXPECT_LT(worst_normal(mesh, object, pull_points(mesh, object, grid)), 0.05);
  }
}

TEST(PointPull, mirrored_halves_share_texels) {
  const Mesh mesh = mirrored_pair(4);
  const StorageAtlas storage = noisy(mesh, 64);
  const View view = framing_view(mesh, Vec3f::UnitZ());
  const ChartPair charts = both_charts(mesh, storage, view, 200);
  const Difference d = difference(charts, 64);
  EXPECT_EQ(d.holes, 0);
  EXPECT_GT(d.well, 15000);
  EXPECT_EQ(d.far_texels, 0);
  EXPECT_LT(worst_normal(mesh, storage, charts.points), 0.05);
}

TEST(PointPull, holes_take_the_nearest_point) {
  constexpr int side = 60;
  Image<Shown> shown(side, side, Shown::Hole);
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      const std::uint32_t h = hash(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y), 3);
      if (h % 40 == 0) shown(x, y) = Shown::Point;
    }
  }
  const Image<std::int32_t> nearest = nearest_points(shown);
  const auto distance = [](int x, int y, int point) {
    return std::max(std::abs(point % side - x), std::abs(point / side - y));
  };
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      int least = side;
      for (int p = 0; p < side * side; ++p) {
        if (shown.data()[p] == Shown::Point) least = std::min(least, distance(x, y, p));
      }
      ASSERT_GE(nearest(x, y), 0);
      ASSERT_EQ(shown.data()[nearest(x, y)], Shown::Point);
      EXPECT_EQ(distance(x, y, nearest(x, y)), least) << x << " " << y;
    }
  }
}

TEST(PointPull, nothing_is_not_filled) {
  Image<Shown> shown(5, 1, Shown::Hole);
  shown(0, 0) = Shown::Point;
  shown(2, 0) = Shown::Nothing;
  const Image<std::int32_t> nearest = nearest_points(shown);
  EXPECT_EQ(nearest(0, 0), 0);
  EXPECT_EQ(nearest(1, 0), 0);
  EXPECT_EQ(nearest(2, 0), -1);
  EXPECT_EQ(nearest(3, 0), -1) << "no path through holes leads there";
}

}  // namespace
}  // namespace normalshop
