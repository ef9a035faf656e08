#pragma once

#include <array>
#include <cmath>
#include <complex>
#include <functional>
#include <vector>

#include "support/slope_fields.h"

#include "normalshop/core/border.h"
#include "normalshop/core/image.h"

/// Images for tests of linear filters.
namespace normalshop::test {

inline constexpr std::array borders = {Border::Clamp, Border::Mirror, Border::Wrap};

inline MaskImage noise_mask(int width, int height) {
  MaskImage image(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) image(x, y) = std::max(0.0F, noise(x, y, 3));
  }
  return image;
}

/// The image moved right and down, what leaves it coming in at the other side.
template <class T>
Image<T> rolled(const Image<T>& image, int dx, int dy) {
  Image<T> result(image.width(), image.height());
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      result((x + dx) % image.width(), (y + dy) % image.height()) = image(x, y);
    }
  }
  return result;
}

/// `copies` images on each side of the image, which what lies beyond its border goes on into.
inline SlopeImage surrounded(const SlopeImage& image, int copies, Border border) {
  const int w = image.width();
  const int h = image.height();
  SlopeImage result((2 * copies + 1) * w, (2 * copies + 1) * h);
  for (int y = 0; y < result.height(); ++y) {
    for (int x = 0; x < result.width(); ++x) {
      const BorderPixel px = border_pixel(x - copies * w, w, border);
      const BorderPixel py = border_pixel(y - copies * h, h, border);
      const Vec2f value = image(px.index, py.index);
      result(x, y) = {px.flipped ? -value.x() : value.x(), py.flipped ? -value.y() : value.y()};
    }
  }
  return result;
}

template <class T>
Image<T> cut(const Image<T>& image, const Rect& part) {
  Image<T> result(part.width(), part.height());
  for (int y = 0; y < part.height(); ++y) {
    for (int x = 0; x < part.width(); ++x) result(x, y) = image(part.x0 + x, part.y0 + y);
  }
  return result;
}

/// height = amplitude cos(kx x + ky y + phase), x to the right and y down, whole waves in the
/// image.
struct Wave {
  int across;
  int down;
  double amplitude;
  double phase;
};

inline const std::vector<Wave>& test_waves() {
  static const std::vector<Wave> waves = {
      {1, 0, 9.0, 0.3}, {0, 2, 5.0, 1.1},   {3, -2, 3.0, 2.0},   {7, 5, 1.5, 0.7},
      {13, 11, 0.8, 5}, {25, -9, 0.4, 4.0}, {40, 31, 0.25, 3.0}, {60, 2, 0.2, 0.1},
  };
  return waves;
}

/// What a filter makes of a wave of these angular frequencies per pixel.
using Response = std::function<std::complex<double>(double kx, double ky)>;

/// The slopes of the sum of the waves, each after the filter.
inline SlopeImage wave_slopes(int width, int height, const Response& response) {
  constexpr double turn = 6.283185307179586;
  SlopeImage image(width, height, Vec2f::Zero());
  for (const Wave& wave : test_waves()) {
    const double kx = turn * wave.across / width;
    const double ky = turn * wave.down / height;
    const std::complex<double> factor =
        wave.amplitude * std::polar(1.0, wave.phase) * response(kx, ky);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const double z = (factor * std::polar(1.0, kx * x + ky * y)).imag();
        image(x, y) += Vec2f(static_cast<float>(-kx * z), static_cast<float>(ky * z));  // y up
      }
    }
  }
  return image;
}

/// Largest minus smallest slope, over both components.
inline float slope_range(const SlopeImage& image) {
  float low = 1e30F;
  float high = -1e30F;
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      low = std::min(low, image(x, y).minCoeff());
      high = std::max(high, image(x, y).maxCoeff());
    }
  }
  return high - low;
}

/// Share of the energy at the waves' frequencies that is curl.
inline double wave_curl_share(const SlopeImage& image) {
  constexpr double turn = 6.283185307179586;
  double curl = 0.0;
  double all = 0.0;
  for (const Wave& wave : test_waves()) {
    const double kx = turn * wave.across / image.width();
    const double ky = -turn * wave.down / image.height();  // up
    std::complex<double> p = 0.0;
    std::complex<double> q = 0.0;
    for (int y = 0; y < image.height(); ++y) {
      for (int x = 0; x < image.width(); ++x) {
        const auto turned = std::polar(1.0, -(kx * x - ky * y));
        p += static_cast<double>(image(x, y).x()) * turned;
        q += static_cast<double>(image(x, y).y()) * turned;
      }
    }
    const double size = std::hypot(kx, ky);
    curl += std::norm((kx * q - ky * p) / size);
    all += std::norm(p) + std::norm(q);
  }
  return curl / all;
}

/// Response of a sampled Gaussian along one axis.
inline double gauss_response(double sigma, double k) {
  double sum = 1.0;
  double response = 1.0;
  for (int i = 1; i <= static_cast<int>(std::ceil(9.0 * sigma)); ++i) {
    const double weight = std::exp(-0.5 * i * i / (sigma * sigma));
    sum += 2.0 * weight;
    response += 2.0 * weight * std::cos(k * i);
  }
  return response / sum;
}

/// Response of a sampled second derivative of a Gaussian along one axis.
inline double bend_response(double sigma, double k) {
  double moment = 0.0;
  double response = 0.0;
  for (int i = 1; i <= static_cast<int>(std::ceil(9.0 * sigma)); ++i) {
    const double t = i * i / (sigma * sigma);
    const double weight = (t - 1.0) * std::exp(-0.5 * t);
    moment += i * i * weight;
    response += 2.0 * weight * (std::cos(k * i) - 1.0);
  }
  return response / moment;
}

}  // namespace normalshop::test
