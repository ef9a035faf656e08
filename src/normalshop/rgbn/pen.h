#pragma once

#include <array>
#include <span>
#include <string_view>
#include <tuple>

#include "normalshop/core/curve.h"
#include "normalshop/core/image.h"
#include "normalshop/core/options.h"
#include "normalshop/core/pixel_blocks.h"
#include "normalshop/rgbn/profile.h"
#include "normalshop/rgbn/stroke.h"

namespace normalshop {

/// What the pressure of a stroke's points scales.
enum class PressureTo { None, Width, Height, Both };
constexpr auto names_of(PressureTo) {
  return std::array<std::string_view, 4>{"none", "width", "height", "both"};
}

struct PenOptions {
  ProfileShape profile = ProfileShape::Crease;
  Curve curve;
  float width = 16.0F;
  float height = 2.0F;
  bool closed = false;
  float taper = 0.0F;
  PressureTo pressure = PressureTo::Both;
  bool smooth = true;

  static constexpr auto fields() {
    return std::tuple{
        field("profile", &PenOptions::profile, "Height across the stroke"),
        field("curve", &PenOptions::curve,
              "Points (u, height) of the custom profile, u from -1 (right, outside) to 1"),
        field("width", &PenOptions::width, "length", 0.0, 1e6,
              "Full width of the stroke; 0 draws nothing"),
        field("height", &PenOptions::height, "length", -1e6, 1e6,
              "How far a bump or step rises and a crease or scratch digs in; negative turns the "
              "profile upside down; 0 draws nothing"),
        field("closed", &PenOptions::closed, "The stroke's end is joined to its start"),
        field("taper", &PenOptions::taper, "length", 0.0, 1e6,
              "Length over which width and height fade in and out at the ends of an open stroke; 0 "
              "gives round ends"),
        field("pressure", &PenOptions::pressure, "What the pressure of the stroke's points scales"),
        field("smooth", &PenOptions::smooth,
              "Passes a smooth curve through the stroke's points instead of straight lines")};
  }
};

/// Profile sketched along strokes (thesis 2.4.1, 4.8): `details` becomes the slopes (y up) of the
/// height field h(distance to the stroke / half width), exactly 0 away from the strokes, and
/// `coverage` how far details that exist below it count as replaced (1 on the stroke, falling
/// smoothly to 0 at its border; may be empty). All of `region` is written; returns the rectangle
/// outside of which both are 0. details and coverage have one size.
///
/// - Distance to the polyline with round joints and ends, to the nearest segment. Slopes are the
///   exact gradient of one height, also where pressure and taper change it along the stroke, except
///   on the stroke's medial axis. A closed stroke that changes the level keeps its height: there
///   pressure scales the width alone.
/// - A crease's bottom, where its slope jumps, is spread over 1.5 pixels on both sides
///   (an eighth of the width at most).
/// - Where strokes meet, the one with the larger |height| counts: they join, they don't add up.
/// - Closed strokes: inside is where the winding number is not 0, whatever the direction. Inside a
///   step the level is constant: slopes and coverage are 0 except along the stroke.
/// - Strokes narrower than 4 pixels are averaged over 3 x 3 positions in a pixel.
///
/// Throws InvalidInput for an open step, a closed stroke with fewer than 3 points, numbers that are
/// not finite, and what Profile rejects. Empty strokes are skipped.
Rect pen(SlopeSpan details, MaskSpan coverage, Rect region, std::span<const Stroke> strokes,
         const PenOptions& options);

/// Makes what pen() drew along `before`, in these images and with these options, what it draws
/// along `strokes` in drawn.region(): only what may have become different is written, whole blocks,
/// which are marked. Throws as pen(), before anything is written.
void redraw_pen(SlopeSpan details, MaskSpan coverage, std::span<const Stroke> before,
                std::span<const Stroke> strokes, const PenOptions& options, PixelBlocks& drawn);

/// The height in pixels whose slopes pen() gives, the raised inside included.
Rect pen_height(MaskSpan height, Rect region, std::span<const Stroke> strokes,
                const PenOptions& options);

/// Pixels around the strokes' points that pen() may change (smoothed strokes may swing out a little
/// further between points; the returned rectangle says how far).
int reach(const PenOptions& options);

/// Centripetal Catmull-Rom curve through the stroke's points, as points about `spacing` pixels
/// apart (at most 1000 from one point to the next); pressure follows a curve too. A closed one
/// returns to its first point without repeating it. Throws InvalidInput unless spacing > 0.
enum class StrokeEnds { Open, Closed };
Stroke smooth_stroke(const Stroke& stroke, float spacing, StrokeEnds ends = StrokeEnds::Open);

}  // namespace normalshop
