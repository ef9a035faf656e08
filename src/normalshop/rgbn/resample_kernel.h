#pragma once

#include "normalshop/rgbn/convolve.h"

namespace normalshop {

/// Longest side of what resample_kernel() makes: with more, a picture would take minutes.
inline constexpr int longest_resampled_kernel = 511;

/// A kernel whose pixels are `scale` of an image's pixels long, as one of that image's pixels.
/// Every weight is spread bilinearly, over tents as wide as two of its own pixels or two of the
/// image's, whichever is more, and none of it is lost: the sum is kept, also where it is 0, and so
/// is symmetry. Scale 1 leaves the kernel bit for bit; scale 0 gives the sum alone. The sides are
/// odd. Throws InvalidInput for a scale that is negative or not finite, for an even side, and for
/// a result with a side of more than longest_resampled_kernel.
Image<float> resample_kernel(KernelView kernel, float scale);

/// Pixels that a kernel of this radius reads beyond the region when it is resampled.
double resampled_reach(int radius, double scale);

}  // namespace normalshop
