#pragma once

#include <array>
#include <string_view>
#include <tuple>

#include "normalshop/core/border.h"
#include "normalshop/core/image.h"
#include "normalshop/core/options.h"
#include "normalshop/core/progress.h"

namespace normalshop {

/// The height where pixels end: at the sides of the region and around pixels that don't count.
/// Free: it ends as it likes. Zero: it is 0 there, so that 0 may continue it.
enum class HeightEnds { Free, Zero };
constexpr auto names_of(HeightEnds) { return std::array<std::string_view, 2>{"free", "zero"}; }

struct ProjectOptions {
  Border border = Border::Clamp;
  HeightEnds ends = HeightEnds::Free;
  float fade = 0.0F;
  float tolerance = 1e-7F;

  static constexpr auto fields() {
    return std::tuple{
        field("border", &ProjectOptions::border,
              "Wrap lets the result tile as the source does; with clamp and mirror the height ends "
              "at the border"),
        field("ends", &ProjectOptions::ends,
              "Free, or brought to height 0 at the border and around pixels that don't count"),
        field("fade", &ProjectOptions::fade, "length", 0.0, 1e4,
              "Width along such ends over which the height is faded to 0, and with it the slopes; "
              "more than 0 brings the ends to 0; 0 does not fade"),
        field("tolerance", &ProjectOptions::tolerance, "1", 1e-9, 1e-2,
              "Error of the slopes over the slopes, root mean square")};
  }
};

/// What projections write; what is empty is not wanted.
struct ProjectionTarget {
  SlopeSpan slopes = {};
  MaskSpan height = {};  ///< in pixels, in the middle of each pixel
};

struct Projection {
  Rect written;
  double removed_share = 0.0;  ///< curl_share() of the source in the region (of rgbn/curl.h)
  int iterations = 0;
};

/// The nearest slopes (least squares, weighted by `validity`) that are slopes of a height, for all
/// of `region` at once: a part of it gives other pixels than the whole.
///
/// The height z lives on the corners of pixels, and a pixel's slopes are
///     z_x = mean of the differences along its upper and lower side,
///     z_y = mean of those along its left and right side (y up).
/// The heights in the middle of pixels (means of four corners) then fulfil for all neighbours
///     z_j - z_i = (g_i + g_j) / 2 along the step,
/// the usual model of integration, and slopes on a simply connected domain are slopes of such a
/// height exactly where curl() of rgbn/curl.h is 0. So this is an orthogonal projection: what it
/// returns has no curl, doing it again changes nothing, slopes of a height stay, and what it takes
/// away is orthogonal to all slopes of heights. All that holds to the tolerance; that the result
/// has no curl, to the rounding of its floats.
///
/// - Pixels with validity 0 or slopes that are not finite don't count and keep their slopes; their
///   height is not a number. The rest may have any shape, parts and holes. Around a hole the height
///   returns to itself too, which curl() alone does not tell.
/// - Border::Wrap: the mean slope of a tile that is tilted as a whole remains in the slopes and is
///   not in the height. `region` must be the whole image.
/// - Free ends: each part's mean height is 0 (parts: pixels connected by their sides).
/// - `fade` multiplies the height by a window that rises from 0 to 1: slopes w grad z + z grad w,
///   which still are slopes of a height, fall to 0 at the ends.
///
/// Source, targets and validity have one size; target.slopes may be source. Throws InvalidInput for
/// options out of range, Wrap in a part of the image, and Cancelled by `progress`; then nothing is
/// written. Needs about 70 bytes a pixel. Sources: thesis 2.4 and 3.6; Horn and Brooks 1986;
/// Simchony et al. 1990; conjugate gradients with a multigrid preconditioner.
Projection project_to_integrable(SlopeView source, MaskView validity,
                                 const ProjectionTarget& target, Rect region,
                                 const ProjectOptions& options = {}, const Progress& progress = {});

/// The height alone.
Projection integrate_height(SlopeView source, MaskView validity, MaskSpan height, Rect region,
                            const ProjectOptions& options = {}, const Progress& progress = {});

}  // namespace normalshop
