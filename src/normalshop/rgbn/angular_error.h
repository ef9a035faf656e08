#pragma once

#include <cstddef>

#include "normalshop/core/image.h"

namespace normalshop {

/// Statistics of the angles between two normal images, in degrees. All 0 for no pixels.
struct AngularError {
  std::size_t pixels = 0;
  double mean = 0.0;
  double median = 0.0;
  double p99 = 0.0;
  double largest = 0.0;
};

/// Angle per pixel in degrees where mask > 0 (empty: everywhere) and both normals are not zero,
/// else NaN. All images have one size.
void angles_between(ImageView<Vec3f> a, ImageView<Vec3f> b, MaskView mask, MaskSpan degrees);

/// Statistics of angles_between()'s result; NaN is left out. Percentiles by nearest rank.
AngularError summarize(MaskView degrees);

}  // namespace normalshop
