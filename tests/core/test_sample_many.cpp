#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "normalshop/core/color_map.h"
#include "normalshop/core/normal_map.h"
#include "normalshop/core/random.h"
#include "normalshop/core/sample.h"

namespace normalshop {
namespace {

RawImage codes_to_sample(int width, int height, int channels, CodeType type) {
  RawImage codes(width, height, channels, type);
  Random random(17);
  for (int y = 0; y < height; ++y) {
    for (int i = 0; i < width * channels; ++i) {
      if (type == CodeType::U8) codes.row<std::uint8_t>(y)[i] = random.next() & 255U;
      if (type == CodeType::U16) codes.row<std::uint16_t>(y)[i] = random.next() & 65535U;
      if (type == CodeType::F32) codes.row<float>(y)[i] = random.uniform();
    }
  }
  return codes;
}

/// Largest difference between reading one by one and many at once, for 1 to 40 places around
/// `center` and on all borders of the map.
template <class Map>
float largest_difference(const Map& map, float spread) {
  Random random(3);
  float largest = 0.0F;
  for (int count = 1; count < 40; ++count) {
    const auto size = static_cast<std::size_t>(count + sample_padding);
    std::vector<float> u(size, 0.0F);
    std::vector<float> v(size, 0.0F);
    std::vector<float> x(size);
    std::vector<float> y(size);
    std::vector<float> z(size);
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
      u[i] = 0.5F + spread * random.uniform(-1.0F, 1.0F);
      v[i] = 0.5F + spread * random.uniform(-1.0F, 1.0F);
    }
    if (count > 5 && spread > 1.0F) {
      u[0] = v[0] = 0.0F;
      u[1] = v[1] = 1.0F;
      u[2] = -1e-9F;
      u[3] = std::nanf("");
      u[4] = 1e30F;
    }
    map.sample(u.data(), v.data(), count, x.data(), y.data(), z.data());
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
      const Vec3f one = map.sample(Vec2f(u[i], v[i]));
      largest = std::max(largest, (one - Vec3f(x[i], y[i], z[i])).cwiseAbs().maxCoeff());
    }
  }
  return largest;
}

TEST(SampleMany, normals_are_those_read_one_by_one) {
  for (const int channels : {3, 4}) {
    for (const CodeType type : {CodeType::U8, CodeType::U16, CodeType::F32}) {
      NormalConvention convention;
      convention.green_down = channels == 4;
      NormalMap map(codes_to_sample(150, 91, channels, type), convention);
      for (const float spread : {0.03F, 0.5F, 3.0F}) {
        EXPECT_LT(largest_difference(map, spread), 2e-6F) << channels;
      }
      map.set_normal(75, 45, Vec3f(0, 0, 1));
      EXPECT_LT(largest_difference(map, 0.03F), 2e-6F) << "edited";
    }
  }
}

TEST(SampleMany, small_maps_and_two_channels) {
  for (const int size : {1, 2, 3}) {
    const NormalMap map(codes_to_sample(size, size, 3, CodeType::U8), {});
    EXPECT_LT(largest_difference(map, 2.0F), 2e-6F) << size;
  }
  NormalConvention convention;
  convention.two_channel = true;
  const NormalMap map(codes_to_sample(64, 64, 2, CodeType::U8), convention);
  EXPECT_LT(largest_difference(map, 2.0F), 2e-6F);
}

TEST(SampleMany, colors_are_those_read_one_by_one) {
  for (const int channels : {1, 3, 4}) {
    const ColorMap map(codes_to_sample(70, 130, channels, CodeType::U8), Vec3f(0.5F, 1.0F, 2.0F));
    EXPECT_LT(largest_difference(map, 0.3F), 2e-6F) << channels;
    EXPECT_LT(largest_difference(map, 3.0F), 2e-6F) << channels;
  }
  EXPECT_EQ(largest_difference(ColorMap(Vec3f(0.1F, 0.2F, 0.3F)), 2.0F), 0.0F);
}

TEST(FloorToInt, rounds_down_and_survives_anything) {
  EXPECT_EQ(floor_to_int(2.0F), 2);
  EXPECT_EQ(floor_to_int(2.9F), 2);
  EXPECT_EQ(floor_to_int(-2.0F), -2);
  EXPECT_EQ(floor_to_int(-2.1F), -3);
  EXPECT_EQ(floor_to_int(std::nanf("")), 0);
  EXPECT_EQ(floor_to_int(1e20F), 0);
}

}  // namespace
}  // namespace normalshop
