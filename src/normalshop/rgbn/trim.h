#pragma once

#include <span>
#include <tuple>

#include "normalshop/core/image.h"
#include "normalshop/core/options.h"
#include "normalshop/rgbn/pen.h"
#include "normalshop/rgbn/stamp.h"

namespace normalshop {

struct TrimOptions {
  float width = 16.0F;
  float relief = 1.0F;
  float border = 0.0F;
  bool closed = false;
  bool smooth = true;
  bool pressure = true;

  static constexpr auto fields() {
    return std::tuple{
        field("width", &TrimOptions::width, "length", 0.0, 1e6,
              "Full width of the stroke, which the pattern's height fills; 0 draws nothing"),
        field("relief", &TrimOptions::relief, "1", -100.0, 100.0,
              "Multiplies the pattern's heights; negative digs; 0 flattens"),
        field("border", &TrimOptions::border, "1", 0.0, 0.5,
              "Part of the width over which the pattern fades out at both sides, and at the ends "
              "of an open stroke; 0 cuts it off"),
        field("closed", &TrimOptions::closed, "The stroke's end is joined to its start"),
        field("smooth", &TrimOptions::smooth,
              "Passes a smooth curve through the stroke's points instead of straight lines"),
        field("pressure", &TrimOptions::pressure,
              "The pressure of the stroke's points scales the width")};
  }
};

/// A pattern h(u, v) repeated along strokes (thesis 2.4.1): the patch's x runs along the stroke (v,
/// arc length) and repeats, its y, up, runs across (u, positive to the left as seen), so that its
/// height fills the width. `details` becomes the patch's slopes warped by phi(x, y) = (u, v),
///     w = h_u grad u + h_v grad v,
/// the gradient of h(phi), although h itself is not known; `coverage` its opacity (may be empty).
/// All of `region` is written; returns the rectangle outside of which both are 0.
///
/// - Heights grow with the width: the slopes of a straight stroke are the patch's own.
/// - The length of a repetition is stretched (by less than half) so that a whole number of them
///   fits the stroke: a closed stroke joins without a seam and an open one ends with the pattern.
/// - On the stroke's medial axis the pattern is cut. Where strokes meet, the one whose middle is
///   nearer (in widths) counts.
/// - Opacity and border scale slopes, not the unknown heights.
///
/// Throws InvalidInput like pen() and stamp().
Rect trim(SlopeSpan details, MaskSpan coverage, Rect region, std::span<const Stroke> strokes,
          const Patch& pattern, const TrimOptions& options);

/// Pixels around the strokes' points that trim() may change, as for pen().
int reach(const TrimOptions& options);

}  // namespace normalshop
