#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>

#include "normalshop/core/border.h"
#include "normalshop/core/image.h"

/// Reading images between pixel centres. Pixel (i, j) has its centre at (i, j) here.
namespace normalshop {

template <class T>
T zero() {
  if constexpr (std::is_arithmetic_v<T>) {
    return T{0};
  } else {
    return T::Zero();
  }
}

/// The position that is read for x in a row of n > 0 pixels: in [0, n - 1], or in [0, n] where the
/// image repeats. What is no number reads the first pixel.
template <Border border>
float position_inside(float x, int n) {
  static_assert(border != Border::Mirror, "the mirror image of a slope has another sign");
  const auto size = static_cast<float>(n);
  if constexpr (border == Border::Clamp) return x > 0.0F ? std::min(x, size - 1.0F) : 0.0F;
  return std::abs(x) < 1e9F ? std::clamp(x - size * std::floor(x / size), 0.0F, size) : 0.0F;
}

/// Bilinear; outside the image the border pixel continues, or the image repeats.
template <class T, Border border = Border::Clamp>
T sample_bilinear(const ImageView<T>& image, float x, float y) {
  const float cx = position_inside<border>(x, image.width());
  const float cy = position_inside<border>(y, image.height());
  const int left = static_cast<int>(cx);
  const int upper = static_cast<int>(cy);
  const float fx = cx - static_cast<float>(left);
  const float fy = cy - static_cast<float>(upper);
  const int x0 = border_pixel(left, image.width(), border).index;
  const int y0 = border_pixel(upper, image.height(), border).index;
  const int x1 = border_pixel(left + 1, image.width(), border).index;
  const int y1 = border_pixel(upper + 1, image.height(), border).index;
  const T top = image(x0, y0) * (1.0F - fx) + image(x1, y0) * fx;
  const T bottom = image(x0, y1) * (1.0F - fx) + image(x1, y1) * fx;
  return top * (1.0F - fy) + bottom * fy;
}

/// Arrays of places and results that are read many at once have this many entries more, in which
/// anything may be left.
inline constexpr int sample_padding = 16;

/// The largest integer not above x, for |x| below 1e9; 0 for anything else.
inline int floor_to_int(float x) {
  if (!(std::abs(x) < 1e9F)) return 0;
  const int i = static_cast<int>(x);
  return i - (static_cast<float>(i) > x ? 1 : 0);
}

/// The four texels around a point of a repeating texture and the weights of the second ones. uv (0,
/// 0) is the corner of the first texel and (1, 1) that of the last.
struct WrappedTaps {
  int x0;
  int y0;
  int x1;
  int y1;
  float fx;
  float fy;

  WrappedTaps(const Vec2f& uv, int width, int height) {
    split(uv.x(), width, x0, x1, fx);
    split(uv.y(), height, y0, y1, fy);
  }

 private:
  static void split(float u, int size, int& first, int& second, float& fraction) {
    const float inside = std::abs(u) < 1e9F ? u - static_cast<float>(floor_to_int(u)) : 0.0F;
    const float at = inside * static_cast<float>(size) - 0.5F;
    const int left = floor_to_int(at);
    fraction = std::clamp(at - static_cast<float>(left), 0.0F, 1.0F);
    first = left < 0 ? size - 1 : std::min(left, size - 1);
    second = left + 1 >= size ? 0 : left + 1;
  }
};

/// Weights of the four pixels around fraction t in [0, 1) for the Catmull-Rom cubic (Keys 1981).
inline std::array<float, 4> cubic_weights(float t) {
  const float t2 = t * t;
  const float t3 = t2 * t;
  return {-0.5F * t3 + t2 - 0.5F * t, 1.5F * t3 - 2.5F * t2 + 1.0F,
          -1.5F * t3 + 2.0F * t2 + 0.5F * t, 0.5F * t3 - 0.5F * t2};
}

/// Catmull-Rom bicubic; outside the image the border pixel continues, or the image repeats. Exact
/// for quadratics inside.
template <class T, Border border = Border::Clamp>
T sample_bicubic(const ImageView<T>& image, float x, float y) {
  const float cx = position_inside<border>(x, image.width());
  const float cy = position_inside<border>(y, image.height());
  const int x0 = static_cast<int>(cx);
  const int y0 = static_cast<int>(cy);
  const std::array<float, 4> wx = cubic_weights(cx - static_cast<float>(x0));
  const std::array<float, 4> wy = cubic_weights(cy - static_cast<float>(y0));
  T sum = zero<T>();
  for (int j = 0; j < 4; ++j) {
    const T* row = image.row(border_pixel(y0 + j - 1, image.height(), border).index);
    T line = zero<T>();
    for (int i = 0; i < 4; ++i) {
      const int xi = border_pixel(x0 + i - 1, image.width(), border).index;
      line += row[xi] * wx[static_cast<std::size_t>(i)];
    }
    sum += line * wy[static_cast<std::size_t>(j)];
  }
  return sum;
}

/// 0 at or below `low`, 1 at or above `high`, smooth between. low < high.
inline float smoothstep(float low, float high, float x) {
  const float t = std::clamp((x - low) / (high - low), 0.0F, 1.0F);
  return t * t * (3.0F - 2.0F * t);
}

}  // namespace normalshop
