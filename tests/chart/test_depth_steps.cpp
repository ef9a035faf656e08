#include <cmath>
#include <limits>

#include "support/meshes.h"
#include "support/step_agreement.h"
#include <gtest/gtest.h>

#include "normalshop/chart/depth_steps.h"
#include "normalshop/core/parallel.h"
#include "normalshop/core/random.h"

namespace normalshop {
namespace {

using namespace test;

/// Triangles of a few pixels at depths that mostly agree, some of them seen from behind.
EditingChart random_chart(int width, int height) {
  EditingChart chart;
  chart.grid.pixel = 0.5F;
  chart.grid.window = {0, 0, width, height};
  chart.ids.triangle.resize(width, height);
  chart.ids.depth.resize(width, height);
  chart.base_normal.resize(width, height);
  Random random(11);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const bool seen = random.uniform() > 0.15F;
      chart.ids.triangle(x, y) =
          seen ? static_cast<std::uint32_t>(4.0F * random.uniform()) : no_triangle;
      chart.ids.depth(x, y) =
          seen ? 2.0F * random.uniform() : -std::numeric_limits<float>::infinity();
      const Vec3f n(random.uniform(-1.0F, 1.0F), random.uniform(-1.0F, 1.0F),
                    random.uniform(-0.1F, 1.0F));
      chart.base_normal(x, y) = seen ? Vec3f(n.normalized()) : Vec3f(0.0F, 0.0F, 0.0F);
    }
  }
  return chart;
}

/// The definition, pixel by pixel.
bool is_step(const EditingChart& chart, float least, int x0, int y0, int x1, int y1) {
  if (chart.ids.triangle(x0, y0) == chart.ids.triangle(x1, y1)) return false;
  if (chart.ids.triangle(x0, y0) == no_triangle || chart.ids.triangle(x1, y1) == no_triangle) {
    return false;
  }
  const Vec3f& n0 = chart.base_normal(x0, y0);
  const Vec3f& n1 = chart.base_normal(x1, y1);
  if ((n0.z() > 0.0F) != (n1.z() > 0.0F)) return true;
  const auto rise = [&](const Vec3f& n) {
    return (y0 == y1 ? -n.x() : n.y()) / std::max(n.z(), 0.17F);
  };
  const float expected = 0.5F * (rise(n0) + rise(n1));
  const float found = (chart.ids.depth(x1, y1) - chart.ids.depth(x0, y0)) / chart.grid.pixel;
  const float steepness = std::abs(expected);
  const float gap = std::max(2.0F, least / chart.grid.pixel * (1.0F - 0.5F * steepness));
  return std::abs(found - expected) > gap + steepness;
}

Image<std::uint8_t> by_definition(const EditingChart& chart, float least) {
  const Rect all = chart.ids.triangle.rect();
  Image<std::uint8_t> steps(all.width(), all.height(), 0);
  for (int y = 0; y < all.height(); ++y) {
    for (int x = 0; x < all.width(); ++x) {
      for (const auto& [dx, dy] : {std::pair{1, 0}, {0, 1}}) {
        if (!all.contains(x + dx, y + dy) || !is_step(chart, least, x, y, x + dx, y + dy)) continue;
        steps(x, y) = steps(x + dx, y + dy) = 1;
      }
    }
  }
  return steps;
}

TEST(DepthSteps, are_those_of_the_definition_at_any_size) {
  for (const auto& [width, height] :
       {std::pair{1, 1}, {2, 1}, {1, 9}, {7, 5}, {15, 4}, {16, 3}, {17, 3}, {33, 2}, {131, 150}}) {
    const EditingChart chart = random_chart(width, height);
    for (const float least : {0.0F, 1.8F}) {
      const Image<std::uint8_t> expected = by_definition(chart, least);
      Image<std::uint8_t> steps;
      find_depth_steps(chart, least, steps);
      ASSERT_EQ(steps.rect(), expected.rect());
      EXPECT_TRUE(std::equal(steps.data(), steps.data() + steps.size(), expected.data()))
          << width << " x " << height;
    }
  }
}

TEST(DepthSteps, do_not_depend_on_threads) {
  const EditingChart chart = random_chart(200, 300);
  Image<std::uint8_t> many;
  find_depth_steps(chart, 0.0F, many);
  const ThreadLimit one(1);
  Image<std::uint8_t> alone;
  find_depth_steps(chart, 0.0F, alone);
  EXPECT_TRUE(std::equal(many.data(), many.data() + many.size(), alone.data()));
}

/// A square of side 1 at z = 0, and over its right half another at `gap`.
Mesh two_planes(float gap) {
  MeshBuilder builder;
  const auto plate = [&](float left, float z) {
    const auto corner = [&](float x, float y) {
      return MeshBuilder::Corner{{x, y, z}, {0, 0, 1}, {0.9F * x, 0.9F - 0.9F * y}};
    };
    builder.quad(corner(left, 0), corner(1, 0), corner(1, 1), corner(left, 1));
  };
  plate(0.0F, 0.0F);
  plate(0.5F, gap);
  return builder.finish();
}

/// Two squares that meet in an edge or a groove, both at that slope.
Mesh fold(float slope) {
  MeshBuilder builder;
  const auto plate = [&](float x0, float x1, float rise) {
    const Vec3f normal = Vec3f(-rise, 0, 1).normalized();
    const auto corner = [&](float x, float y) {
      return MeshBuilder::Corner{{x, y, rise * (x - 0.5F)}, normal, {0.9F * x, 0.9F - 0.9F * y}};
    };
    builder.quad(corner(x0, 0), corner(x1, 0), corner(x1, 1), corner(x0, 1));
  };
  plate(0.0F, 0.5F, slope);
  plate(0.5F, 1.0F, -slope);
  return builder.finish();
}

/// The unit square behind a sphere whose middle is `near` above it.
Mesh sphere_before_plane(float near) {
  Mesh mesh = uv_sphere(96, 48, 0.3F);
  for (Vec3f& p : mesh.positions) p += Vec3f(0.5F, 0.5F, near);
  const Mesh plane = two_planes(-1.0F);
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), plane.positions.begin(), plane.positions.end());
  for (const Vec3u& t : plane.triangles) mesh.triangles.push_back(t + Vec3u::Constant(first));
  const auto append = [](auto& to, const auto& from) {
    to.insert(to.end(), from.begin(), from.end());
  };
  append(mesh.uvs, plane.uvs);
  append(mesh.normals, plane.normals);
  append(mesh.tangents, plane.tangents);
  append(mesh.texture_sets, plane.texture_sets);
  return mesh;
}

/// Pixels from half of the least step on.
constexpr float least_step = 0.02F;

StepAgreement agreement(const Mesh& mesh, float pixel, float least = least_step) {
  const View view = make_view({0, 0, 1}, {0, 1, 0}, {0.5F, 0.5F, 0}, 1.2F, 1.2F);
  return step_agreement(mesh, make_grid(view, pixel), least);
}

TEST(DepthSteps, of_planes_are_the_same_at_two_resolutions) {
  for (const float pixel : {0.01F, 0.005F}) {
    const int side = static_cast<int>(std::lround(1.0F / pixel));
    for (const float gap : {0.004F, 0.008F, 0.015F, 0.019F, 0.021F, 0.03F, 0.1F}) {
      const StepAgreement a = agreement(two_planes(gap), pixel);
      EXPECT_EQ(a.coarse, gap > least_step ? 2 * side : 0) << gap;
      EXPECT_EQ(a.fine, 2 * a.coarse) << gap;
      EXPECT_EQ(a.coarse_only + a.fine_only, 0) << gap;
    }
  }
}

// Without a least step it is the pixels that decide.
TEST(DepthSteps, of_two_pixels_depend_on_these) {
  const StepAgreement a = agreement(two_planes(0.015F), 0.01F, 0.0F);
  EXPECT_EQ(a.coarse, 0);
  EXPECT_EQ(a.fine_only, 400);
}

TEST(DepthSteps, are_none_in_folds_at_any_resolution) {
  for (const float slope : {0.5F, 2.0F, 5.0F, 12.0F, -0.5F, -2.0F, -5.0F, -12.0F}) {
    const StepAgreement a = agreement(fold(slope), 0.01F);
    EXPECT_EQ(a.coarse + a.fine, 0) << slope;
  }
}

TEST(DepthSteps, around_a_sphere_are_the_same_at_two_resolutions) {
  for (const float pixel : {0.01F, 0.005F}) {
    const StepAgreement a = agreement(sphere_before_plane(0.31F), pixel);
    EXPECT_GT(static_cast<float>(a.coarse), 6.28F * 0.3F / pixel);
    EXPECT_NEAR(a.fine, 2 * a.coarse, a.coarse / 10);
    EXPECT_EQ(a.coarse_only + a.fine_only, 0);
  }
}

}  // namespace
}  // namespace normalshop
