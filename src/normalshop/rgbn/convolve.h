#pragma once

#include <tuple>

#include "normalshop/core/border.h"
#include "normalshop/core/image.h"
#include "normalshop/core/options.h"

namespace normalshop {

/// Weights of a filter: sides of an odd number of pixels, the middle one for the pixel itself. Rows
/// run down as those of images.
using KernelView = ImageView<float>;

struct ConvolveOptions {
  bool normalize = false;
  Border border = Border::Clamp;

  static constexpr auto fields() {
    return std::tuple{
        field("normalize", &ConvolveOptions::normalize,
              "Whether the kernel is divided by its sum first, so that constants stay as they are"),
        field("border", &ConvolveOptions::border, "What is read beyond the image")};
  }
};

/// Convolution with any kernel (thesis 2.2: the filtered slopes are those of the height filtered
/// with that kernel):
///     target(x) = sum over o of kernel(o) source(x - o),
/// so that a single pixel of 1 becomes the kernel. Kernels that are a column times a row are taken
/// apart, which saves time.
///
/// Validity (0 to 1, empty: all valid): pixels that do not count are replaced by the mean of those
/// that do, weighed by |kernel|; for kernels without negative weights that is normalised
/// convolution. Where nothing valid is in reach the source is kept.
///
/// All images have one size; target may be source. A kernel with one weight, the middle one, of 1
/// leaves the input bit for bit. Returns the pixels that it wrote: region within target. Throws
/// InvalidInput for a kernel with an even side or with weights that are not finite, and to
/// normalise one whose sum is 0 (1e-6 of its weights' sizes at most).
Rect convolve(SlopeView source, MaskView validity, KernelView kernel, SlopeSpan target, Rect region,
              const ConvolveOptions& options = {});
/// The same for one number per pixel: masks, heights.
Rect convolve(MaskView source, MaskView validity, KernelView kernel, MaskSpan target, Rect region,
              const ConvolveOptions& options = {});
/// Pixels read beyond the region.
int reach(KernelView kernel);

}  // namespace normalshop
