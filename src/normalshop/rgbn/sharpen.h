#pragma once

#include <tuple>

#include "normalshop/core/border.h"
#include "normalshop/core/image.h"
#include "normalshop/core/options.h"

namespace normalshop {

struct SharpenOptions {
  float sigma = 4.0F;
  float amount = 1.0F;
  float noise_sigma = 0.0F;

  static constexpr auto fields() {
    return std::tuple{
        field("sigma", &SharpenOptions::sigma, "length", 0.0, 1e6,
              "Details smaller than about this are enhanced; 0 leaves the input as it is"),
        field("amount", &SharpenOptions::amount, "1", -1.0, 100.0,
              "How much of the details is added; 0 leaves the input as it is, -1 smooths"),
        field("noise_sigma", &SharpenOptions::noise_sigma, "length", 0.0, 1e6,
              "Details smaller than this count as noise and are not enhanced; 0 enhances them all; "
              "below sigma")};
  }
};

/// All-pass plus high-pass (unsharp mask), or with noise_sigma > 0 all-pass plus band-pass (edge
/// enhancement), in slope space (thesis 2.2):
///     target = source + amount * (source * g(noise_sigma) - source * g(sigma)).
/// Sizes, validity, borders and aliasing as for smooth(); pixels with validity 0 keep their slopes.
/// Throws InvalidInput unless 0 <= noise_sigma < sigma (or both are 0).
Rect sharpen(SlopeView source, MaskView validity, SlopeSpan target, Rect region,
             const SharpenOptions& options = {}, Border border = Border::Clamp);
/// Pixels read beyond the region.
int reach(const SharpenOptions& options);

}  // namespace normalshop
