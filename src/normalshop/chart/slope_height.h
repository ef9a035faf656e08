#pragma once

#include <algorithm>
#include <cmath>

#include "normalshop/core/image.h"

namespace normalshop {

/// The height of slopes within part of a chart, in pixels: rgbn/project.h, on no more than `side`
/// pixels each way. Private to floor 4.
class SlopeHeight {
 public:
  /// Slopes count by `weight`, and where that shows no surface by a little, which holds the parts
  /// of the surface together.
  SlopeHeight(SlopeView slopes, MaskView weight, const Rect& region, int side);

  /// Between the pixels that were integrated: bilinear.
  float at(int x, int y) const;
  float largest() const;
  /// How many pixels were taken together, each way.
  int step() const { return step_; }
  /// Makes the mean 0 along those pixels of a rectangle's sides that count(x, y); along all when
  /// none does.
  template <class Counts>
  void level(const Rect& rect, const Counts& counts);

 private:
  float coarse(int x, int y) const {
    return height_(std::clamp(x, 0, height_.width() - 1), std::clamp(y, 0, height_.height() - 1));
  }

  Rect region_;
  int step_;
  float level_ = 0.0F;
  MaskImage height_;
};

template <class Counts>
void SlopeHeight::level(const Rect& rect, const Counts& counts) {
  double sums[2] = {0.0, 0.0};
  double numbers[2] = {0.0, 0.0};
  for (int y = rect.y0; y < rect.y1; ++y) {
    const bool whole_row = y == rect.y0 || y == rect.y1 - 1;
    const int step = whole_row ? 1 : std::max(1, rect.width() - 1);
    for (int x = rect.x0; x < rect.x1; x += step) {
      for (int k = counts(x, y) ? 0 : 1; k < 2; ++k) {
        sums[k] += static_cast<double>(at(x, y));
        numbers[k] += 1.0;
      }
    }
  }
  const int k = numbers[0] > 0.0 ? 0 : 1;
  if (numbers[k] > 0.0) level_ += static_cast<float>(sums[k] / numbers[k]);
}

}  // namespace normalshop
