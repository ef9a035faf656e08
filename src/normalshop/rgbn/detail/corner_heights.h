#pragma once

#include <optional>

#include "normalshop/core/image.h"
#include "normalshop/core/progress.h"
#include "normalshop/rgbn/detail/multigrid.h"

/// Heights at the corners of pixels whose slopes are nearest to given ones; private to this floor.
/// The model is described in rgbn/project.h.
namespace normalshop {

/// What happens where pixels end.
enum class Ends { Free, Zero };

/// Pixels with weights, prepared for solving.
class CornerHeights {
 public:
  /// Weights are 0 (no pixel) to 1. With `wraps` the image repeats; its sides are then even and at
  /// least 8.
  CornerHeights(MaskView weights, bool wraps, Ends ends);

  struct Options {
    double tolerance = 1e-7;  ///< error of the slopes over the slopes, root mean square
    int most_iterations = 300;
  };
  struct Solution {
    Image<double> heights;  ///< at corners: one more than pixels each way; 0 without pixels
    int iterations = 0;
  };
  /// Slopes where the weight is 0 are not read.
  Solution solve(SlopeView slopes, const Options& options, const Progress& progress);

 private:
  struct Right;

  const float* pixels(int y) const { return weights_.row(y); }
  Stencil stencil() const;
  Right right_side(SlopeView slopes) const;
  double apply(const GridField<double>& x, GridField<double>& out) const;
  void odd_row(const GridField<double>& x, int y, double* out) const;
  Image<double> corners(const GridField<double>& even, const Right& right) const;

  Rect size_;
  GridShape shape_;            ///< of the even rows of corners; the odd ones have the same
  GridField<float> weights_;   ///< of pixels; pixel (x, y) lies right of and below corner (x, y)
  GridField<double> inverse_;  ///< odd rows: 1 / (sum of the weights around), 0: not free
  GridField<float> free_;      ///< even rows: 1 where the height is looked for
  std::optional<Multigrid> preconditioner_;
};

/// Slopes of the pixel whose upper left corner is (x, y).
inline Vec2d slope_at(const Image<double>& heights, int x, int y) {
  const double fall = heights(x + 1, y + 1) - heights(x, y);
  const double rise = heights(x + 1, y) - heights(x, y + 1);
  return {0.5 * (rise + fall), 0.5 * (rise - fall)};
}

/// Height in the middle of the pixel.
inline double height_at(const Image<double>& heights, int x, int y) {
  return 0.25 * ((heights(x, y) + heights(x + 1, y + 1)) + (heights(x + 1, y) + heights(x, y + 1)));
}

}  // namespace normalshop
