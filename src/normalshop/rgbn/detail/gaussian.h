#pragma once

#include "normalshop/core/border.h"
#include "normalshop/core/image.h"

namespace normalshop {

/// The pixels `region` of smooth(), as an image of the region's size; private to this floor. sigma
/// > 0; the region lies in the source and is not empty.
SlopeImage gaussian(SlopeView source, MaskView validity, const Rect& region, float sigma,
                    Border border);

/// Pixels that a Gaussian reads beyond its region.
int gaussian_reach(float sigma);

}  // namespace normalshop
