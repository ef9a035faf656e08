#pragma once

#include <span>
#include <tuple>

#include "normalshop/core/border.h"
#include "normalshop/core/image.h"
#include "normalshop/core/options.h"
#include "normalshop/core/progress.h"

/// Whether slopes are those of a surface: the curl, its share of the slopes' energy, and what a
/// path climbs (thesis 2.4 and 3.6).
namespace normalshop {

struct CurlOptions {
  Border border = Border::Clamp;

  static constexpr auto fields() {
    return std::tuple{field("border", &CurlOptions::border,
                            "Wrap: the image repeats; clamp and mirror: it ends at its border")};
  }
};

/// Curl d z_y / d x - d z_x / d y (x right, y up): what the height gains on the way around the
/// square between the centres of pixels (x, y), (x + 1, y), (x, y + 1) and (x + 1, y + 1), against
/// the clock as seen, stepping by the mean slope of two neighbours. Written to pixel (x, y), so it
/// lies half a pixel to the right and below. Exactly 0 (to the rounding of the slopes) for what
/// project_to_integrable() returns; of order (pixel / feature size)^2 for slopes sampled from a
/// smooth surface.
///
/// Squares with a pixel whose validity is 0 or whose slopes are not finite have no number (NaN),
/// squares that leave the image 0 (as for a height that is mirrored there), unless it wraps. One
/// size. Returns the pixels that it wrote: region within target.
Rect curl(SlopeView slopes, MaskView validity, MaskSpan target, Rect region,
          const CurlOptions& options = {});
/// Pixels read beyond the region.
int reach(const CurlOptions& options);

/// |curl| as colours (rgbn/heatmap.h), `maximum` > 0 the brightest; grey where there is none.
void curl_heatmap(SlopeView slopes, MaskView validity, float maximum, ColorSpan target,
                  const CurlOptions& options = {});

/// The part of the slopes' energy that no height has, 0 to 1: sum |g - grad z|^2 / sum |g - mean|^2
/// with the nearest height z of rgbn/project.h, weighted by validity; 0 for constant slopes. Errors
/// are about 1e-10. Solves for z: seconds for large images. Throws Cancelled by `progress`.
double curl_share(SlopeView slopes, MaskView validity, const CurlOptions& options = {},
                  const Progress& progress = {});

/// The same at once, from the curl alone: sum (a - b)^2 / (2 sum (a^2 + b^2)) over all squares with
/// a = d z_y / d x and b = d z_x / d y; 0 if these are 0. Here each wave counts by the square of
/// its frequency, so fine structures count more than in curl_share(), and what goes wrong around
/// holes is not seen. Both are 0 for slopes of a height, 1/2 for noise and 1 for a rotation.
double curl_share_of_derivatives(SlopeView slopes, MaskView validity,
                                 const CurlOptions& options = {});

/// What the height gains along a path: the integral of the slopes, in pixels. Points are positions
/// in pixels, y DOWN like the rows (as in Stroke). Slopes are read bilinearly and integrated
/// exactly along each straight piece. 0 around closed paths (last point = first) for slopes of a
/// height: to rounding along rows and columns of pixels, else to order (pixel / feature size)^2. An
/// open path between two places outside an edit tells whether it changes the level (thesis 2.4.1).
/// Beyond the image options.border counts. Not a number where slopes are none. 0 for fewer than two
/// points. Throws InvalidInput for points that are not finite or beyond 1e6, or an empty image.
double level_change(SlopeView slopes, std::span<const Vec2f> path, const CurlOptions& options = {});

}  // namespace normalshop
