#pragma once

#include <tuple>

#include "normalshop/core/border.h"
#include "normalshop/core/image.h"
#include "normalshop/core/options.h"

namespace normalshop {

struct SmoothOptions {
  float sigma = 4.0F;

  static constexpr auto fields() {
    return std::tuple{field("sigma", &SmoothOptions::sigma, "length", 0.0, 1e6,
                            "Standard deviation of the Gaussian; 0 leaves the input as it is")};
  }
};

/// Gaussian in slope space: target = source * g in `region` (thesis 2.2: the smoothed slopes are
/// those of the smoothed height). Normalised by `validity` (0 to 1, empty: all valid): pixels with
/// 0 don't count, and where nothing valid is in reach the source is kept. Constant slopes stay
/// exactly as they are, unless a border mirrors them. The kernel's error is below 3e-4 of its peak,
/// that of a wave below 1e-4 of its amplitude.
///
/// All images have one size; target may be source. sigma in pixels, 0.3 to 500 sensible. Returns
/// the pixels that it wrote: region within target. Throws InvalidInput for a sigma that is negative
/// or not finite. Up to sigma 4 by the kernel itself, above by way of a lattice of points, as the
/// pyramid of Burt and Adelson (1983) with Gaussians, for which that is nearly exact.
Rect smooth(SlopeView source, MaskView validity, SlopeSpan target, Rect region,
            const SmoothOptions& options = {}, Border border = Border::Clamp);
/// The same for one number per pixel: masks, heights. A mirror does not turn their signs.
Rect smooth(MaskView source, MaskView validity, MaskSpan target, Rect region,
            const SmoothOptions& options = {}, Border border = Border::Clamp);
/// The same for linear colours.
Rect smooth(ColorView source, MaskView validity, ColorSpan target, Rect region,
            const SmoothOptions& options = {}, Border border = Border::Clamp);
/// Pixels read beyond the region.
int reach(const SmoothOptions& options);

}  // namespace normalshop
