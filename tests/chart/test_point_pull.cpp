#include <cmath>
#include <numbers>

#include "chart_fixtures.h"
#include "support/meshes.h"
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
  compute_weight(out.triangles, {});
  compute_weight(out.points, {});
  return out;
}

/// How two charts of one view differ.
struct Difference {
  int both = 0;
  int holes = 0;        ///< pixels that only triangles see, not at the rim
  int outside = 0;      ///< pixels that only points see and that are no triangle's neighbours
  int far_texels = 0;   ///< pixels whose texels are not neighbours
  int front = 0;        ///< pixels that face the viewer within 70 degrees
  double depth = 0.0;   ///< largest difference in pixels, of those
  double normal = 0.0;  ///< mean angle of base normals
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

Difference difference(const ChartPair& charts, int size, int reach) {
  Difference out;
  const EditingChart& a = charts.triangles;
  const EditingChart& b = charts.points;
  for (int y = 0; y < a.grid.height(); ++y) {
    for (int x = 0; x < a.grid.width(); ++x) {
      const bool in_a = a.ids.triangle(x, y) != no_triangle;
      const bool in_b = b.ids.triangle(x, y) != no_triangle;
      if (in_a && !in_b && seen_around(a, x, y, true)) {++out.holes; if (std::getenv("LEAK") != nullptr) std::printf("hole %d %d tri %u texel %u,%u z %.2f\n", x, y, a.ids.triangle(x,y), a.texel(x,y)%size, a.texel(x,y)/size, a.base_normal(x,y).z());}
      if (in_b && !in_a && !seen_around(a, x, y, false)) ++out.outside;
      if (!in_a || !in_b) continue;
      ++out.both;
      if (!(a.base_normal(x, y).z() > 0.34F)) continue;
      ++out.front;
      if (texels_apart(a.texel(x, y), b.texel(x, y), size) > reach) ++out.far_texels;
      const double apart = std::abs(a.ids.depth(x, y) - b.ids.depth(x, y)) / a.grid.pixel;
      out.depth = std::max(out.depth, apart);
      if (std::getenv("LEAK") != nullptr && apart > 5) std::printf("leak %d %d apart %.1f tri %u / %u texel %u,%u / %u,%u z %.2f pz %.2f\n", x, y, apart, a.ids.triangle(x,y), b.ids.triangle(x,y), a.texel(x,y)%size, a.texel(x,y)/size, b.texel(x,y)%size,b.texel(x,y)/size, a.base_normal(x,y).z(), b.base_normal(x,y).z());
      out.normal += angle_degrees(a.base_normal(x, y), b.base_normal(x, y));
    }
  }
  out.normal /= std::max(out.front, 1);
  return out;
}

StorageAtlas noisy(const Mesh& mesh, int size) {
  return storage_of(mesh, noise_map(size, CodeType::U16));
}

void dump(const char* what, const Difference& d) {
  std::printf("%s: both %d holes %d outside %d far %d front %d depth %.3f normal %.4f\n", what,
              d.both, d.holes, d.outside, d.far_texels, d.front, d.depth, d.normal);
}

TEST(PointPull, explore) {
  const Mesh plane = plane_grid(8);
  const Mesh sphere = smooth_sphere(96, 48);
  const Mesh torus = ring_torus(96, 48);
  for (const int size : {64, 256, 512, 1024}) {
    for (const Vec3f& direction : {Vec3f(0, 0, 1), Vec3f(0.5F, 0.3F, 0.8F)}) {
      std::printf("size %d\n", size);
      const auto go = [&](const char* what, const Mesh& mesh) {
        const StorageAtlas storage = noisy(mesh, size);
        const ChartPair charts = both_charts(mesh, storage, framing_view(mesh, direction), 300);
        dump(what, difference(charts, size, 1));
      };
      go("plane", plane);
      go("sphere", sphere);
      go("torus", torus);
    }
  }
}

}  // namespace
}  // namespace normalshop
