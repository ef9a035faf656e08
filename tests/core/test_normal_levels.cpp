#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "normalshop/core/error.h"
#include "normalshop/core/normal_levels.h"
#include "normalshop/core/parallel.h"
#include "normalshop/core/slope.h"

namespace normalshop {
namespace {

constexpr float tau = 6.2831853F;

/// Slopes of a place, in any pattern.
Vec2f rough_slope(int x, int y) {
  return {0.4F * std::sin(0.7F * static_cast<float>(x) + 0.3F * static_cast<float>(y * y % 17)),
          0.3F * std::cos(1.1F * static_cast<float>(y)) - 0.1F};
}

NormalMap rough_map(int columns, int rows, NormalSpace space = NormalSpace::Tangent) {
  NormalConvention convention;
  convention.space = space;
  convention.signed_float = true;
  RawImage codes(columns, rows, 3, CodeType::F32);
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) {
      const Vec3f n = normal_from_slope(rough_slope(x, y));
      std::memcpy(codes.row<float>(y) + 3 * x, n.data(), sizeof n);
    }
  }
  return {std::move(codes), convention};
}

/// Share of [first, first + size) that lies in texel i.
double overlap(double first, double size, int i) {
  return std::max(0.0, std::min(first + size, i + 1.0) - std::max(first, double(i)));
}

bool same_levels(const NormalLevels& a, const NormalLevels& b) {
  for (int level = 1; level <= a.last(); ++level) {
    for (int y = 0; y < a.height(level); ++y) {
      for (int x = 0; x < a.width(level); ++x) {
        const SlopeVariance va = a.variance(level, x, y);
        const SlopeVariance vb = b.variance(level, x, y);
        if (a.normal(level, x, y) != b.normal(level, x, y) || va.xx != vb.xx || va.xy != vb.xy ||
            va.yy != vb.yy || a.coverage(level, x, y) != b.coverage(level, x, y)) {
          return false;
        }
      }
    }
  }
  return true;
}

/// Mean slope and second moments of the texels of a level, in double.
struct Moments {
  int columns;
  int rows;
  std::vector<Vec2d> mean;
  std::vector<Eigen::Matrix2d> square;
};

Moments level_above(const Moments& below) {
  Moments out{std::max(1, below.columns / 2), std::max(1, below.rows / 2), {}, {}};
  const double across = double(below.columns) / out.columns;
  const double down = double(below.rows) / out.rows;
  for (int y = 0; y < out.rows; ++y) {
    for (int x = 0; x < out.columns; ++x) {
      Vec2d mean(0.0, 0.0);
      Eigen::Matrix2d square = Eigen::Matrix2d::Zero();
      for (int j = 0; j < below.rows; ++j) {
        for (int i = 0; i < below.columns; ++i) {
          const auto k = static_cast<std::size_t>(j * below.columns + i);
          const double part = overlap(x * across, across, i) * overlap(y * down, down, j);
          mean += part / (across * down) * below.mean[k];
          square += part / (across * down) * below.square[k];
        }
      }
      out.mean.push_back(mean);
      out.square.push_back(square);
    }
  }
  return out;
}

TEST(NormalLevels, are_means_over_areas_at_any_size) {
  Moments truth{45, 22, {}, {}};
  for (int y = 0; y < truth.rows; ++y) {
    for (int x = 0; x < truth.columns; ++x) {
      const Vec2d slope = rough_slope(x, y).cast<double>();
      truth.mean.push_back(slope);
      truth.square.emplace_back(slope * slope.transpose());
    }
  }
  const NormalLevels levels(rough_map(truth.columns, truth.rows));
  ASSERT_EQ(levels.last(), 5);
  EXPECT_EQ(levels.width(2), 11);
  EXPECT_EQ(levels.height(5), 1);
  for (int level = 1; level <= levels.last(); ++level) {
    truth = level_above(truth);
    for (int y = 0; y < levels.height(level); ++y) {
      for (int x = 0; x < levels.width(level); ++x) {
        const auto k = static_cast<std::size_t>(y * truth.columns + x);
        const Eigen::Matrix2d moment = truth.square[k] - truth.mean[k] * truth.mean[k].transpose();
        const Vec2d got = slope_from_normal(levels.normal(level, x, y)).cast<double>();
        const SlopeVariance variance = levels.variance(level, x, y);
        EXPECT_LT((got - truth.mean[k]).norm(), 2e-6);
        EXPECT_NEAR(double(variance.xx), moment(0, 0), 2e-6);
        EXPECT_NEAR(double(variance.xy), moment(0, 1), 2e-6);
        EXPECT_NEAR(double(variance.yy), moment(1, 1), 2e-6);
        EXPECT_NEAR(double(levels.coverage(level, x, y)), 1.0, 1e-6);
      }
    }
  }
}

/// What lies between charts is steep here, and no level may show any of it.
TEST(NormalLevels, keep_the_background_out) {
  const int columns = 61;
  const int rows = 40;
  const Vec3f chart = normal_from_slope({0.2F, -0.1F});
  NormalMap map = rough_map(columns, rows);
  const auto inside = [](int x, int y) { return x >= 7 && x < 30 && y >= 5 && y < 23; };
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) {
      map.set_normal(x, y, inside(x, y) ? chart : normal_from_slope({9.0F, 30.0F}));
    }
  }
  const CoverageReader covered = [&](int x, int count, int y, float* out) {
    for (int i = 0; i < count; ++i) out[i] = inside(x + i, y) ? 1.0F : 0.0F;
  };
  const NormalLevels levels(map, covered);
  const int top = levels.last();
  EXPECT_NEAR(levels.coverage(top, 0, 0), 23.0F * 18.0F / (61.0F * 40.0F), 1e-5F);
  for (int level = 1; level <= top; ++level) {
    for (int y = 0; y < levels.height(level); ++y) {
      for (int x = 0; x < levels.width(level); ++x) {
        ASSERT_LT(angle_degrees(levels.normal(level, x, y), chart), 1e-3) << level;
        ASSERT_LT(levels.variance(level, x, y).xx, 1e-9F);
      }
    }
  }
}

TEST(NormalLevels, follow_a_changed_rectangle_to_the_same_bits) {
  for (const auto& [columns, rows] : {std::pair(128, 128), {129, 67}, {1, 300}, {601, 33}}) {
    for (const NormalSpace space : {NormalSpace::Tangent, NormalSpace::Object}) {
      NormalMap map = rough_map(columns, rows, space);
      NormalLevels levels(map);
      for (const Rect& changed : {Rect{5, 3, 6, 4}, {64, 0, 128, 64}, {columns - 1, 20, 700, 30}}) {
        const Rect r = intersect(changed, {0, 0, columns, rows});
        for (int y = r.y0; y < r.y1; ++y) {
          for (int x = r.x0; x < r.x1; ++x) map.set_normal(x, y, normal_from_slope({0.9F, 0.5F}));
        }
        levels.update(map, changed);
      }
      EXPECT_TRUE(same_levels(levels, NormalLevels(map))) << columns << " x " << rows;
    }
  }
}

TEST(NormalLevels, are_the_same_on_one_thread) {
  const NormalMap map = rough_map(300, 301);
  const NormalLevels many(map);
  const ThreadLimit one(1);
  EXPECT_TRUE(same_levels(many, NormalLevels(map)));
}

TEST(NormalLevels, average_vectors_in_object_space) {
  const NormalMap map = rough_map(64, 64, NormalSpace::Object);
  const NormalLevels levels(map);
  Vec3d sum(0.0, 0.0, 0.0);
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) sum += map.normal(x, y).cast<double>() / 4096.0;
  }
  EXPECT_LT(angle_degrees(levels.normal(6, 0, 0), sum.cast<float>()), 1e-3);
  EXPECT_NEAR(double(levels.variance(6, 0, 0).xx), (1.0 - sum.norm()) / sum.norm(), 1e-5);
}

TEST(NormalLevels, leave_out_what_has_no_direction) {
  NormalConvention convention;
  convention.signed_float = true;
  RawImage codes(2, 2, 3, CodeType::F32);
  const float none = std::numeric_limits<float>::quiet_NaN();
  const std::array<float, 6> upper{0.0F, 0.6F, 0.8F, none, 0.0F, 1.0F};
  const std::array<float, 6> lower{0.0F, 0.0F, 0.0F, 1e30F, 0.0F, 0.0F};
  std::memcpy(codes.row<float>(0), upper.data(), sizeof upper);
  std::memcpy(codes.row<float>(1), lower.data(), sizeof lower);
  const NormalMap map(std::move(codes), convention);
  const NormalLevels levels(map);
  EXPECT_LT(angle_degrees(levels.normal(1, 0, 0), {0.0F, 0.6F, 0.8F}), 1e-3);
  EXPECT_FLOAT_EQ(levels.coverage(1, 0, 0), 0.25F);
  const CoverageReader nothing = [](int, int count, int, float* out) {
    std::fill_n(out, count, 0.0F);
  };
  const NormalLevels empty(map, nothing);
  EXPECT_TRUE(empty.normal(1, 0, 0).isZero());
  EXPECT_EQ(empty.variance(1, 0, 0).xx, 0.0F);
}

/// Whole waves under every texel of the level: the variance is half the squared amplitude.
TEST(NormalLevels, roughness_of_a_ripple) {
  const float amplitude = 0.3F;
  NormalMap map = flat_normal_map(256, 64, CodeType::F32);
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 256; ++x) {
      const float slope = amplitude * std::sin(tau * (static_cast<float>(x) + 0.5F) / 16.0F);
      map.set_normal(x, y, normal_from_slope({slope, 0.0F}));
    }
  }
  const NormalLevels levels(map);
  const float variance = 0.5F * amplitude * amplitude;
  EXPECT_NEAR(levels.variance(4, 3, 1).xx, variance, 1e-6F);
  EXPECT_NEAR(levels.variance(4, 3, 1).yy, 0.0F, 1e-6F);
  const float base = 0.4F;
  const float expected = std::pow(std::pow(base, 4.0F) + variance, 0.25F);
  const RawImage image = roughness_map(levels, 4, base, CodeType::U16);
  EXPECT_EQ(image.width(), 16);
  EXPECT_NEAR(image.code(3, 1, 0) / 65535.0F, expected, 2e-5F);
  EXPECT_FLOAT_EQ(widened_roughness(base, {}), base);
  EXPECT_EQ(widened_roughness(1.0F, {0.5F, 0.0F, 0.5F}), 1.0F);
  EXPECT_THROW(roughness_map(levels, 0, base, CodeType::U8), InvalidInput);
  EXPECT_THROW(roughness_map(levels, 9, base, CodeType::U8), InvalidInput);
  EXPECT_THROW(roughness_map(levels, 1, 1.5F, CodeType::U8), InvalidInput);
}

TEST(NormalLevels, are_written_in_the_maps_convention) {
  const NormalMap map = rough_map(64, 48);
  const NormalLevels levels(map);
  NormalConvention down;
  down.green_down = true;
  const NormalMap written(levels.encode(2, CodeType::U16, down), down);
  EXPECT_EQ(written.width(), 16);
  EXPECT_LT(angle_degrees(written.normal(5, 7), levels.normal(2, 5, 7)), 0.01);
  EXPECT_THROW(NormalLevels(NormalMap{}), InvalidInput);
  EXPECT_EQ(NormalLevels(rough_map(1, 1)).last(), 0);
  EXPECT_LE(levels.size_bytes(), std::size_t{64 * 48 * 24 / 3 + 24 * 8});
}

}  // namespace
}  // namespace normalshop
