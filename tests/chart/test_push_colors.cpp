#include <cmath>
#include <cstring>

#include "chart_fixtures.h"
#include "support/meshes.h"
#include <gtest/gtest.h>

#include "normalshop/chart/push_colors.h"
#include "normalshop/chart/resolution.h"
#include "normalshop/core/parallel.h"

namespace normalshop::test {
namespace {

/// Bytes of pseudo-random colours, alpha included.
RawImage color_noise(int size) {
  RawImage codes(size, size, 4, CodeType::U8);
  for (std::size_t i = 0; i < codes.size_bytes(); ++i) {
    codes.data()[i] = static_cast<std::uint8_t>(64U + (i * 2654435761U >> 20U) % 64U);
  }
  return codes;
}

StorageAtlas colored(const Mesh& mesh, int size, int color_size) {
  StorageAtlas storage = storage_of(mesh, flat_normal_map(size, size, CodeType::U8));
  storage.sets[0].albedo = ColorMap(color_noise(color_size));
  return storage;
}

struct PushedColors {
  ColorPushResult result;
  RawImage codes;
};

PushedColors push_constant(const Mesh& mesh, StorageAtlas& storage, const EditingChart& chart,
                           const Vec3f& change) {
  const ColorImage everywhere(chart.grid.width(), chart.grid.height(), change);
  PushedColors out;
  out.result = push_colors(mesh, chart, {everywhere, everywhere.rect()}, storage);
  out.codes = storage.sets[0].albedo.encode();
  return out;
}

float linear_at(const RawImage& codes, int x, int y, int channel) {
  return srgb_to_linear(codes.code(x, y, channel) / RawImage::full_code(codes.type()));
}

/// Texels that hold `change` more than before, within half a code.
std::size_t texels_with(const RawImage& before, const RawImage& after, const Vec3f& change) {
  std::size_t count = 0;
  for (int y = 0; y < before.height(); ++y) {
    for (int x = 0; x < before.width(); ++x) {
      bool fits = before.code(x, y, 3) == after.code(x, y, 3);
      for (int c = 0; c < 3; ++c) {
        const float wanted = 255.0F * linear_to_srgb(linear_at(before, x, y, c) + change[c]);
        fits = fits && std::abs(after.code(x, y, c) - wanted) < 0.6F;
      }
      if (fits) ++count;
    }
  }
  return count;
}

TEST(PushColors, reach_texels_of_another_size_too) {
  const Mesh mesh = plane_grid(3);
  const Vec3f change(0.02F, -0.01F, 0.03F);
  for (const int color_size : {64, 50, 200}) {
    StorageAtlas storage = colored(mesh, 64, color_size);
    const RawImage before = storage.sets[0].albedo.codes();
    const EditingChart chart = chart_from(mesh, storage, {0.2F, 0.1F, 1}, 220);
    const auto all = static_cast<std::size_t>(color_size * color_size);
    const PushedColors pushed = push_constant(mesh, storage, chart, change);
    EXPECT_EQ(pushed.result.changed, all);
    EXPECT_EQ(texels_with(before, pushed.codes, change), all) << color_size;
    EXPECT_FALSE(storage.sets[0].normals.has_edits());
  }
}

TEST(PushColors, of_blue_alone_are_seen) {
  const Mesh mesh = plane_grid(1);
  StorageAtlas storage = colored(mesh, 32, 32);
  const RawImage before = storage.sets[0].albedo.codes();
  const EditingChart chart = chart_from(mesh, storage, {0, 0, 1}, 60);
  const PushedColors pushed = push_constant(mesh, storage, chart, {0, 0, 0.05F});
  EXPECT_EQ(texels_with(before, pushed.codes, {0, 0, 0.05F}), 1024U);
}

TEST(PushColors, of_nothing_change_no_code) {
  const Mesh mesh = uv_sphere(32, 16);
  StorageAtlas storage = colored(mesh, 96, 96);
  const EditingChart chart = chart_from(mesh, storage, {0.3F, 0.2F, 1}, 150);
  const PushedColors pushed = push_constant(mesh, storage, chart, Vec3f::Zero());
  EXPECT_EQ(pushed.result.changed, 0U);
  EXPECT_FALSE(storage.sets[0].albedo.has_edits());
  const RawImage noise = color_noise(96);
  EXPECT_EQ(std::memcmp(pushed.codes.data(), noise.data(), noise.size_bytes()), 0);
}

/// Texels of the back keep their codes; those of the front's middle take all of it.
TEST(PushColors, change_only_what_the_chart_sees) {
  const Mesh mesh = smooth_sphere(64, 32);
  StorageAtlas storage = colored(mesh, 128, 160);
  const RawImage before = storage.sets[0].albedo.codes();
  const Vec3f toward(0, 0, 1);
  const EditingChart chart = chart_from(mesh, storage, toward, 300);
  const Vec3f change(0.02F, 0.02F, 0.02F);
  const RawImage after = push_constant(mesh, storage, chart, change).codes;
  const TexelMap& texels = storage.sets[0].albedo_texels;
  ASSERT_EQ(texels.width(), 160);
  std::size_t front = 0;
  for (int y = 0; y < 160; ++y) {
    for (int x = 0; x < 160; ++x) {
      const std::uint32_t owner = texels.owner()(x, y);
      if (owner == no_triangle) continue;
      const float facing =
          position_at(mesh, texels.surface_point(owner, x, y)).normalized().dot(toward);
      const float grown = linear_at(after, x, y, 0) - linear_at(before, x, y, 0);
      if (facing < 0.05F) {
        EXPECT_EQ(after.code(x, y, 0), before.code(x, y, 0));
      }
      if (facing > 0.8F) {
        EXPECT_NEAR(grown, 0.02F, 0.003F);
      }
      front += facing > 0.8F ? 1 : 0;
    }
  }
  EXPECT_GT(front, 1000U);
}

/// Overlapping charts: the texel takes the edit once, and the gutter takes it too.
TEST(PushColors, come_once_to_shared_texels_and_to_the_gutter) {
  for (const Mesh& mesh : {mirrored_pair(2), plane_two_charts(3)}) {
    StorageAtlas storage = colored(mesh, 100, 100);
    const RawImage before = storage.sets[0].albedo.codes();
    const EditingChart chart = chart_from(mesh, storage, {0, 0, 1}, 300);
    const Vec3f change(0.01F, 0.02F, 0.03F);
    const RawImage after = push_constant(mesh, storage, chart, change).codes;
    const TexelMap& texels = storage.sets[0].texels;
    std::size_t owned = 0;
    for (int y = 0; y < 100; ++y) {
      for (int x = 0; x < 100; ++x) owned += texels.owner()(x, y) != no_triangle ? 1 : 0;
    }
    std::size_t gutter = 0;
    for (std::size_t i = 0; i < texels.gutter().size(); ++i) {
      gutter += i == 0 || texels.gutter()[i - 1].texel != texels.gutter()[i].texel ? 1 : 0;
    }
    EXPECT_EQ(texels_with(before, after, change), owned + gutter);
  }
}

TEST(PushColors, threads_change_nothing) {
  const Mesh mesh = smooth_sphere(48, 24);
  StorageAtlas one = colored(mesh, 128, 200);
  StorageAtlas many = one;
  const EditingChart chart = chart_from(mesh, one, {0.3F, 0.2F, 1}, 300);
  const Vec3f change(0.02F, -0.02F, 0.01F);
  const RawImage alone = [&] {
    const ThreadLimit limit(1);
    return push_constant(mesh, one, chart, change).codes;
  }();
  const RawImage together = push_constant(mesh, many, chart, change).codes;
  EXPECT_EQ(std::memcmp(alone.data(), together.data(), alone.size_bytes()), 0);
}

TEST(PushColors, leave_a_constant_colour) {
  const Mesh mesh = plane_grid(1);
  StorageAtlas storage = storage_of(mesh, flat_normal_map(32, 32, CodeType::U8));
  const EditingChart chart = chart_from(mesh, storage, {0, 0, 1}, 60);
  const ColorImage change(chart.grid.width(), chart.grid.height(), Vec3f::Ones());
  EXPECT_EQ(push_colors(mesh, chart, {change, change.rect()}, storage).visited, 0U);
  EXPECT_EQ(storage.sets[0].albedo.sample({0.5F, 0.5F}), Vec3f::Constant(0.5F));
}

TEST(PushColors, have_charts_as_fine_as_the_finer_map) {
  const Mesh mesh = plane_grid(1);
  const StorageAtlas storage = colored(mesh, 64, 256);
  const View view = framing_view(mesh, {0, 0, 1});
  const auto pixel = [&](CountedTexels counted) {
    return texel_pixel_size(mesh, storage, view, {-1, -1}, {1, 1}, counted);
  };
  EXPECT_NEAR(pixel(CountedTexels::Normals), 1.0F / 64, 1e-6F);
  EXPECT_NEAR(pixel(CountedTexels::All), 1.0F / 256, 1e-6F);
}

}  // namespace
}  // namespace normalshop::test
