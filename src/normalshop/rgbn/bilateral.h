#pragma once

#include <tuple>

#include "normalshop/core/border.h"
#include "normalshop/core/options.h"
#include "normalshop/rgbn/rgbn_image.h"

namespace normalshop {

struct BilateralOptions {
  float sigma_space = 3.5F;
  float sigma_color = 0.1F;
  float sigma_normal = 0.2F;
  float guide_sigma = 0.6F;
  Border border = Border::Clamp;

  static constexpr auto fields() {
    return std::tuple{
        field("sigma_space", &BilateralOptions::sigma_space, "length", 0.0, 1e6,
              "Standard deviation in the image, at most 100 pixels; 0 leaves the input as it is"),
        field("sigma_color", &BilateralOptions::sigma_color, "1", 0.0, 1e6,
              "Colours this far apart in linear RGB hardly mix; 0 ignores colour"),
        field("sigma_normal", &BilateralOptions::sigma_normal, "1", 0.0, 1e6,
              "Unit normals this far apart hardly mix: 0.2 is 11 degrees, below 0.005 is 0.005; 0 "
              "ignores normals"),
        field("guide_sigma", &BilateralOptions::guide_sigma, "length", 0.0, 1e6,
              "Gaussian that takes noise out of what is compared; 0 compares the input itself"),
        field("border", &BilateralOptions::border, "What is read beyond the image")};
  }
};

/// The bilateral filter of RGBN images in six dimensions (thesis 2.2 and 2.5; Toler-Franklin et al.
/// 2007): every pixel in `region` becomes the mean of those in the disk of radius
/// ceil(2 sigma_space) - 1 around it, weighed by their validity and by
///     exp(-|x_i - x_j|^2 / 2 sigma_space^2 - |c_i - c_j|^2 / 2 sigma_color^2
///         - |n_i - n_j|^2 / 2 sigma_normal^2),
/// with x in pixels, linear colours c and unit normals n. Slopes and colours are averaged; slopes
/// count as at most 20. A pixel keeps its bits where nothing in reach differs from it, and where
/// its validity is 0 or it is not finite.
///
/// c and n are those of the source, or of `guide` where there is one, blurred by guide_sigma.
/// Without colour sigma_color is ignored; colours may be up to 1e9. The result need not be the
/// slopes of any height.
///
/// All images have one size; target.color needs source.color; target may be source. A region gives
/// the bits of the whole image while guide_sigma is at most 8 pixels. Returns the pixels that it
/// wrote: region within target. Throws InvalidInput for options outside their ranges.
///
/// Range weights are within 0.013 of exact ones (a power instead of the exponential); that moves
/// normals by less than 0.1 degrees in the mean.
Rect bilateral(const RgbnView& source, const RgbnSpan& target, Rect region,
               const BilateralOptions& options = {});
/// Joint: the range weights compare pixels of `guide`.
Rect bilateral(const RgbnView& source, const RgbnView& guide, const RgbnSpan& target, Rect region,
               const BilateralOptions& options = {});
/// Pixels read beyond the region.
int reach(const BilateralOptions& options);

/// The same by the formula, in double precision and plain loops: what bilateral() is measured
/// against.
Rect bilateral_exact(const RgbnView& source, const RgbnView& guide, const RgbnSpan& target,
                     Rect region, const BilateralOptions& options = {});

}  // namespace normalshop
