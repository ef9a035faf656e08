#pragma once

#include "normalshop/core/border.h"
#include "normalshop/core/image.h"

namespace normalshop {

/// The pixels `region` of smooth(), as an image of the region's size; private to this floor. sigma
/// > 0; the region lies in the source and is not empty.
SlopeImage gaussian(SlopeView source, MaskView validity, const Rect& region, float sigma,
                    Border border);
/// Likewise -sigma^2 times the Laplacian of the smoothed slopes. Pixels that are not valid count as
/// the Gaussian mean of those that are.
SlopeImage laplacian(SlopeView source, MaskView validity, const Rect& region, float sigma,
                     Border border);

/// Pixels that they read beyond the region.
int gaussian_reach(float sigma);
int laplacian_reach(float sigma);

}  // namespace normalshop
