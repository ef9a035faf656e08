#pragma once

#include "normalshop/core/image.h"

/// Shapes made of the pixels whose weight is not 0; private to this floor. With `wraps` the image
/// repeats.
namespace normalshop {

struct ConnectedPixels {
  Image<int> labels;  ///< 0 to count - 1; -1: no pixel
  int count = 0;
};

/// Parts connected by the sides of pixels, numbered in the order of their first pixels.
ConnectedPixels connected_pixels(MaskView weights, bool wraps);

/// For each corner (one more than pixels each way) the distance to the nearest corner that does not
/// have pixels all around, at most `limit`.
Image<float> end_distance(MaskView weights, bool wraps, float limit);

}  // namespace normalshop
