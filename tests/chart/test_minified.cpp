#include <cmath>

#include "chart_fixtures.h"
#include "support/meshes.h"
#include "support/nan.h"
#include <gtest/gtest.h>

#include "normalshop/core/for_pixels.h"
#include "normalshop/core/parallel.h"
#include "normalshop/core/slope.h"

namespace normalshop {
namespace {

using namespace test;

constexpr float two_pi = 6.28318531F;

/// amplitude * sin(2 pi * waves * x) along x of the unit square.
struct Wave {
  float amplitude;
  float waves;
  float at(float x) const { return amplitude * std::sin(two_pi * waves * x); }
  /// Mean over an interval of that length around x.
  float mean(float x, float length) const {
    const float half = 0.5F * two_pi * waves * length;
    return at(x) * std::sin(half) / half;
  }
};

constexpr Wave coarse{0.2F, 6.0F};  // 22 pixels
constexpr Wave fine{0.6F, 157.0F};  // 2.4 texels, 0.8 pixels: seen as a wave of 4 pixels
constexpr int map_side = 384;
constexpr int chart_side = 128;

/// Float map of the unit square whose slopes are both waves, along x.
StorageAtlas wavy_square(const Mesh& mesh) {
  return storage_of(mesh, map_side, NormalSpace::Tangent, [](const Vec3f& p) {
    return normal_from_slope({coarse.at(p.x()) + fine.at(p.x()), 0.0F});
  });
}

/// Root mean square of the chart's slopes less the mean slopes under its pixels.
double aliasing(const Mesh& mesh, const StorageAtlas& storage, bool means) {
  const View view = make_view({0, 0, 1}, {0, 1, 0}, {0.5F, 0.5F, 0.0F}, 1.0F, 1.0F);
  const EditingChart chart =
      pull(mesh, storage, make_grid(view, 1.0F / chart_side), {.means = means});
  double sum = 0.0;
  int count = 0;
  for (int y = 4; y < chart_side - 4; ++y) {
    for (int x = 4; x < chart_side - 4; ++x) {
      const float px = (static_cast<float>(x) + 0.5F) / chart_side;
      const Vec2f slope = slope_from_normal(chart.normal(x, y));
      const Vec2f truth(coarse.mean(px, 1.0F / chart_side) + fine.mean(px, 1.0F / chart_side),
                        0.0F);
      sum += static_cast<double>((slope - truth).squaredNorm());
      ++count;
    }
  }
  return std::sqrt(sum / count);
}

/// Slopes of 0.6 whose waves are shorter than a pixel show as 4-pixel waves of 0.3 without means.
TEST(Minified, waves_shorter_than_a_pixel_have_no_aliasing) {
  const Mesh mesh = plane_grid(4);
  const StorageAtlas storage = wavy_square(mesh);
  EXPECT_GT(aliasing(mesh, storage, false), 0.4);
  EXPECT_LT(aliasing(mesh, storage, true), 0.04);
}

/// Triangles smaller than pixels: the mean goes on over their neighbours.
TEST(Minified, triangles_may_be_smaller_than_pixels) {
  const Mesh mesh = plane_grid(160);
  const StorageAtlas storage = wavy_square(mesh);
  EXPECT_LT(aliasing(mesh, storage, true), 0.05);
}

/// Mean degrees between a hemisphere's base normals and what a chart with pixels of 2.4 texels
/// shows of waves about as long as a pixel.
double turned_by_fine_waves(NormalSpace space, bool means) {
  const Mesh mesh = hemisphere(24, 48);
  const StorageAtlas storage = storage_of(mesh, 256, space, [](const Vec3f& p) {
    const Vec3f n = p.normalized();
    const Vec3f wave(std::sin(180.0F * n.x()), std::sin(180.0F * n.y()), 0.0F);
    return (n + 0.4F * (wave - wave.dot(n) * n)).normalized();
  });
  const View view = framing_view(mesh, {0, 0, 1});
  const EditingChart chart = pull(mesh, storage, make_grid(view, 2.0F / 60), {.means = means});
  double sum = 0.0;
  int count = 0;
  for (int y = 0; y < chart.grid.height(); ++y) {
    for (int x = 0; x < chart.grid.width(); ++x) {
      if (!(chart.base_normal(x, y).z() > 0.5F)) continue;
      sum += angle_degrees(chart.normal(x, y), chart.base_normal(x, y));
      ++count;
    }
  }
  return sum / count;
}

TEST(Minified, both_spaces_have_no_aliasing_on_a_hemisphere) {
  for (const NormalSpace space : {NormalSpace::Tangent, NormalSpace::Object}) {
    const double before = turned_by_fine_waves(space, false);
    const double after = turned_by_fine_waves(space, true);
    EXPECT_GT(before, 10.0);
    EXPECT_LT(after, 0.25 * before);
  }
}

/// Two charts whose surroundings in the map lean the other way, from the second texel on.
TEST(Minified, nothing_beside_a_chart_is_read) {
  const Mesh mesh = plane_two_charts(4);
  const Vec3f tilt = Vec3f(0.4F, 0.2F, 0.9F).normalized();
  StorageAtlas storage =
      storage_of(mesh, 512, NormalSpace::Tangent, [&](const Vec3f&) { return tilt; });
  const Image<std::uint32_t>& owner = storage.sets[0].texels.owner();
  for (int y = 0; y < 512; ++y) {
    for (int x = 0; x < 512; ++x) {
      bool beside = false;
      for_pixels(intersect(owner.rect(), {x - 1, y - 1, x + 2, y + 2}),
                 [&](int i, int j) { beside = beside || owner(i, j) != no_triangle; });
      if (!beside) storage.sets[0].normals.set_normal(x, y, {-0.6F, -0.6F, 0.53F});
    }
  }
  for (const float side : {24.0F, 100.0F}) {
    const View view = framing_view(mesh, {0.1F, 0.2F, 1.0F});
    const EditingChart chart = pull(mesh, storage, make_grid(view, 1.0F / side));
    double worst = 0.0;
    for (int y = 0; y < chart.grid.height(); ++y) {
      for (int x = 0; x < chart.grid.width(); ++x) {
        if (chart.ids.triangle(x, y) == no_triangle) continue;
        worst = std::max(worst, angle_degrees(chart.normal(x, y), view.to_chart(tilt)));
      }
    }
    EXPECT_LT(worst, 0.02);
  }
}

TEST(Minified, pixels_of_few_texels_stay_bit_for_bit) {
  const Mesh mesh = plane_grid(4);
  const StorageAtlas storage = storage_of(mesh, noise_map(128, CodeType::U16));
  const View view = make_view({0, 0, 1}, {0, 1, 0}, {0.5F, 0.5F, 0.0F}, 1.0F, 1.0F);
  for (const int side : {90, 300}) {
    const ChartGrid grid = make_grid(view, 1.0F / static_cast<float>(side));
    const EditingChart means = pull(mesh, storage, grid);
    const EditingChart points = pull(mesh, storage, grid, {.means = false});
    EXPECT_TRUE(std::equal(means.normal.data(), means.normal.data() + means.normal.size(),
                           points.normal.data()));
  }
}

/// Stripes of one black and one white texel.
TEST(Minified, colours_are_means_of_light) {
  const Mesh mesh = plane_grid(4);
  StorageAtlas storage = storage_of(mesh, flat_normal_map(32, 32, CodeType::U8));
  RawImage stripes(96, 96, 3, CodeType::U8);
  for (int y = 0; y < 96; ++y) {
    for (int x = 0; x < 3 * 96; ++x) {
      stripes.row<std::uint8_t>(y)[x] = x / 3 % 2 == 0 ? 255 : std::uint8_t{0};
    }
  }
  storage.sets[0].albedo = ColorMap(std::move(stripes));
  const View view = make_view({0, 0, 1}, {0, 1, 0}, {0.5F, 0.5F, 0.0F}, 1.0F, 1.0F);
  const ChartGrid grid = make_grid(view, 1.0F / 24);
  const EditingChart chart = pull(mesh, storage, grid, {.albedo = true});
  for (int x = 0; x < 24; ++x) EXPECT_NEAR(chart.albedo(x, 12).y(), 0.5F, 1e-3F);
}

/// A map repeated a thousand times with texels that are no numbers, on slivers too.
TEST(Minified, slivers_and_broken_codes_give_numbers) {
  const auto corner = [](float x, float y, float scale) {
    return MeshBuilder::Corner{{x, y, 0.0F}, {0, 0, 1}, {scale * x, scale * y}};
  };
  MeshBuilder builder;
  builder.quad(corner(0, 0, 1000), corner(1, 0, 1000), corner(1, 1, 1000), corner(0, 1, 1000));
  for (const float thin : {1e-3F, 1e-20F, 1e-38F}) {
    MeshBuilder::Corner off = corner(1.5F, 1.0F, 1e6F);
    off.position.y() = thin;
    builder.triangle(corner(1, 0, 1), corner(2, 0, 1e8F), off);
  }
  const Mesh mesh = builder.finish();
  RawImage codes(64, 64, 3, CodeType::F32);
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      const bool broken = (x + y) % 5 == 0;
      Eigen::Map<Vec3f>(codes.row<float>(y) + 3 * x) =
          broken ? Vec3f::Constant(test::nan) : Vec3f(0.2F, 0.1F, 0.9F);
    }
  }
  NormalConvention convention;
  convention.signed_float = true;
  const StorageAtlas storage = storage_of(mesh, NormalMap(std::move(codes), convention));
  const View view = make_view({0, 0, 1}, {0, 1, 0}, {1.0F, 0.5F, 0.0F}, 2.0F, 1.2F);
  const EditingChart chart = pull(mesh, storage, make_grid(view, 0.02F));
  for (int y = 0; y < chart.grid.height(); ++y) {
    for (int x = 0; x < chart.grid.width(); ++x) {
      ASSERT_TRUE(chart.normal(x, y).allFinite()) << x << ", " << y;
    }
  }
}

TEST(Minified, threads_change_nothing) {
  const Mesh mesh = uv_sphere(64, 32);
  const StorageAtlas storage = storage_of(mesh, noise_map(512, CodeType::U8));
  const EditingChart many = chart_from(mesh, storage, {1, 0.4F, 0.5F}, 100);
  const ThreadLimit limit(1);
  const EditingChart one = chart_from(mesh, storage, {1, 0.4F, 0.5F}, 100);
  EXPECT_TRUE(
      std::equal(many.normal.data(), many.normal.data() + many.normal.size(), one.normal.data()));
}

}  // namespace
}  // namespace normalshop
