#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "support/nan.h"

#include "normalshop/core/image.h"
#include "normalshop/core/random.h"
#include "normalshop/rgbn/project.h"

/// Slopes and masks that tests share, and what compares them.
namespace normalshop::test {

inline float noise(int x, int y, std::uint32_t seed) {
  const auto bits = hash(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y), seed);
  return static_cast<float>(bits >> 8U) * 0x1p-23F - 1.0F;
}

inline SlopeImage noise_image(int width, int height, std::uint32_t seed = 1) {
  SlopeImage image(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) image(x, y) = {noise(x, y, seed), noise(x, y, seed + 1)};
  }
  return image;
}

/// Slopes of heights at corners, z(x, y) for corners 0..width, 0..height: the model of project.h.
template <class Height>
SlopeImage slopes_of(int width, int height, const Height& z) {
  SlopeImage image(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double nw = z(x, y);
      const double ne = z(x + 1, y);
      const double sw = z(x, y + 1);
      const double se = z(x + 1, y + 1);
      image(x, y) = {static_cast<float>(0.5 * ((ne - nw) + (se - sw))),
                     static_cast<float>(0.5 * ((nw - sw) + (ne - se)))};
    }
  }
  return image;
}

inline double hills(int x, int y) {
  return 9.0 * std::sin(0.05 * x) * std::cos(0.04 * y) + 3.0 * std::cos(0.11 * (x + 2 * y)) +
         static_cast<double>(noise(x, y, 77));
}

inline MaskImage disc(int size) {
  MaskImage mask(size, size);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const double r = std::hypot(x + 0.5 - 0.5 * size, y + 0.5 - 0.5 * size);
      mask(x, y) = r < 0.48 * size ? 1.0F : 0.0F;
    }
  }
  return mask;
}

/// A meander of 16 turns with 20 holes in each.
inline MaskImage snakes(int size) {
  MaskImage mask(size, size);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const double u = (x + 0.5) / size;
      const double turn = (y + 0.5) / size * 16.0;
      const double f = turn - std::floor(turn);
      const bool end = static_cast<int>(turn) % 2 == 1 ? u > 0.95 : u < 0.05;
      const bool wall = f < 0.15 && turn > 1.0 && !end;
      const double h = u * 20.0 - std::floor(u * 20.0) - 0.5;
      mask(x, y) = wall || std::hypot(0.8 * h, f - 0.6) < 0.18 ? 0.0F : 1.0F;
    }
  }
  return mask;
}

inline SlopeImage projected(const SlopeImage& source, const MaskImage& valid,
                            const ProjectOptions& options = {}) {
  SlopeImage out(source.width(), source.height());
  project_to_integrable(source, valid, {.slopes = out}, out.rect(), options);
  return out;
}

/// Pixels that a mask covers.
inline double area(const MaskImage& mask) {
  double sum = 0.0;
  for (std::size_t i = 0; i < mask.size(); ++i) sum += static_cast<double>(mask.data()[i]);
  return sum;
}

/// Equal as numbers are: 0 and -0 are the same, and nothing is the same as NaN.
template <class T>
bool same(const Image<T>& a, const Image<T>& b) {
  if (a.rect() != b.rect()) return false;
  for (int y = 0; y < a.height(); ++y) {
    for (int x = 0; x < a.width(); ++x) {
      if (a(x, y) != b(x, y)) return false;
    }
  }
  return true;
}

template <class T>
bool same_bits(const Image<T>& a, const Image<T>& b) {
  return a.rect() == b.rect() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

/// The largest distance between slopes, where the mask is not 0. NaN if one of them is.
inline float largest_difference(const SlopeImage& a, const SlopeImage& b,
                                const MaskImage& valid = {}) {
  float largest = 0.0F;
  for (int y = 0; y < a.height(); ++y) {
    for (int x = 0; x < a.width(); ++x) {
      if (!valid.empty() && valid(x, y) == 0.0F) continue;
      const float apart = (a(x, y) - b(x, y)).norm();
      if (std::isnan(apart)) return apart;
      largest = std::max(largest, apart);
    }
  }
  return largest;
}

}  // namespace normalshop::test
