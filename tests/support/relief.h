#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include <Eigen/Geometry>

#include "normalshop/core/image.h"
#include "normalshop/core/random.h"
#include "normalshop/core/slope.h"

/// Slopes full of creases and what noise makes of them: what filters that keep edges are judged by.
namespace normalshop::test {

/// Four quarters of a square: a pyramid and a dome on a plane, roof ridges, waves. Slopes up
/// to 1.4.
///
/// The scene of 192^2 is frozen. It was calibrated once by the ridges' spacing alone, until the
/// best Gaussian left 2.65 degrees of with_noise(.., 5): filters' parameters may be searched on it,
/// but neither it nor the noise may follow them.
inline SlopeImage relief(int size) {
  constexpr float ridge_period = 1.5F;
  SlopeImage slopes(size, size, Vec2f::Zero());
  const int half = size / 2;
  const auto fill = [&](int x0, int y0, const auto& slope_at) {
    for (int y = 0; y < half; ++y) {
      for (int x = 0; x < half; ++x) {
        // -1 to 1, y up.
        const float scale = 2.0F / static_cast<float>(half);
        slopes(x0 + x, y0 + y) = slope_at((static_cast<float>(x) + 0.5F) * scale - 1.0F,
                                          1.0F - (static_cast<float>(y) + 0.5F) * scale);
      }
    }
  };
  fill(0, 0, [](float x, float y) -> Vec2f {
    if (std::max(std::abs(x), std::abs(y)) > 0.8F) return {0.0F, 0.0F};
    if (std::abs(x) > std::abs(y)) return {x > 0.0F ? -0.7F : 0.7F, 0.0F};
    return {0.0F, y > 0.0F ? -0.7F : 0.7F};
  });
  fill(half, 0, [](float x, float y) -> Vec2f {
    const float square = x * x + y * y;
    if (square > 0.64F) return {0.0F, 0.0F};
    return Vec2f(-x, -y) / std::sqrt(1.0F - square);
  });
  fill(0, half, [](float x, float y) -> Vec2f {
    const Vec2f across(std::cos(0.5F), std::sin(0.5F));
    const float phase = across.dot(Vec2f(x, y)) / ridge_period;
    return across * (phase - std::floor(phase) < 0.5F ? 0.6F : -0.6F);
  });
  fill(half, half, [](float x, float y) -> Vec2f {
    return Vec2f(0.5F * std::cos(3.0F * std::numbers::pi_v<float> * x),
                 0.3F * std::cos(2.0F * std::numbers::pi_v<float> * y));
  });
  return slopes;
}

/// Noise of `degrees`: each of the two tangent components of the unit normal gets independent
/// Gaussian noise of standard deviation tan(degrees).
inline SlopeImage with_noise(const SlopeImage& slopes, float degrees, std::uint64_t seed) {
  Random random(seed);
  const float deviation = std::tan(degrees * std::numbers::pi_v<float> / 180.0F);
  SlopeImage noisy(slopes.width(), slopes.height());
  for (int y = 0; y < slopes.height(); ++y) {
    for (int x = 0; x < slopes.width(); ++x) {
      // Box and Muller: two independent numbers at once.
      const float radius = deviation * std::sqrt(-2.0F * std::log(1.0F - random.uniform()));
      const float angle = 2.0F * std::numbers::pi_v<float> * random.uniform();
      const Vec3f n = normal_from_slope(slopes(x, y));
      const Vec3f across = n.cross(Vec3f::UnitY()).normalized();
      const Vec3f along = n.cross(across);
      noisy(x, y) =
          slope_from_normal(n + radius * (std::cos(angle) * across + std::sin(angle) * along));
    }
  }
  return noisy;
}

/// Mean angle in degrees between the normals of two images.
inline double mean_error(const SlopeImage& a, const SlopeImage& b) {
  double sum = 0.0;
  for (int y = 0; y < a.height(); ++y) {
    for (int x = 0; x < a.width(); ++x) {
      sum += angle_degrees(normal_from_slope(a(x, y)), normal_from_slope(b(x, y)));
    }
  }
  return sum / static_cast<double>(a.width() * a.height());
}

/// What a filter(noisy slopes, slopes to fill) leaves of the noise on the scene, over two draws.
template <class Filter>
double error_left(float degrees, const Filter& filter) {
  const SlopeImage clean = relief(192);
  double sum = 0.0;
  for (const std::uint64_t seed : {7U, 8U}) {
    SlopeImage out(clean.width(), clean.height());
    filter(with_noise(clean, degrees, seed), out);
    sum += mean_error(clean, out);
  }
  return 0.5 * sum;
}

/// Numbers without order in [0, 1).
inline ColorImage random_colors(int width, int height) {
  ColorImage colors(width, height);
  Random random(18);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (float& c : colors(x, y)) c = random.uniform();
    }
  }
  return colors;
}

}  // namespace normalshop::test
