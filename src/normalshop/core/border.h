#pragma once

#include <algorithm>
#include <array>
#include <string_view>

namespace normalshop {

/// What an operator reads beyond an image.
/// Clamp: the border pixel continues. Mirror: the height is mirrored at the outer edge of the
/// border pixels, so the slope across the border changes its sign. Wrap: the image repeats; what
/// tiles keeps tiling.
enum class Border { Clamp, Mirror, Wrap };
constexpr auto names_of(Border) {
  return std::array<std::string_view, 3>{"clamp", "mirror", "wrap"};
}

/// The pixel that stands for `i` in a row of n > 0 pixels.
struct BorderPixel {
  int index;
  bool flipped;  ///< Mirror, an odd number of reflections: the slope along this axis is negated
};

inline BorderPixel border_pixel(int i, int n, Border border) {
  if (i >= 0 && i < n) return {i, false};
  if (border == Border::Clamp) return {std::clamp(i, 0, n - 1), false};
  const int period = border == Border::Wrap ? n : 2 * n;
  const int place = ((i % period) + period) % period;
  return place < n ? BorderPixel{place, false} : BorderPixel{2 * n - 1 - place, true};
}

}  // namespace normalshop
