#pragma once

#include <cstddef>
#include <tuple>

#include "normalshop/core/image.h"
#include "normalshop/core/options.h"

/// Turning, flattening and mending normals. Directions are in chart axes: x right, y up, z towards
/// the viewer. All images of a call have one size and target may be source. Masks are 0 to 1 and
/// scale what is done; where they are 0, and at slopes that are not finite, the source is kept.
/// Each function returns the pixels that it wrote: region within target.
namespace normalshop {

/// Unit vector at `tilt` degrees from the viewing direction, leaning towards `azimuth` degrees (0
/// right, 90 up).
Vec3f direction_from_angles(float azimuth, float tilt);

struct PaintDirectionOptions {
  float azimuth = 0.0F;
  float tilt = 0.0F;
  float strength = 1.0F;

  static constexpr auto fields() {
    return std::tuple{field("azimuth", &PaintDirectionOptions::azimuth, "degrees", -360.0, 360.0,
                            "Where normals lean to: 0 right, 90 up"),
                      field("tilt", &PaintDirectionOptions::tilt, "degrees", 0.0, 180.0,
                            "Angle from the viewing direction; 0 faces the viewer"),
                      field("strength", &PaintDirectionOptions::strength, "1", 0.0, 1.0,
                            "Part of the way; 0 leaves the input as it is, 1 goes all the way")};
  }
};

/// Turns normals along the great arc towards a direction (thesis 2.5), by strength * mask of the
/// way. Where the arc would leave for below the horizon (core/slope.h), the normal stops there. One
/// that points exactly away from the direction is kept. `direction` need not be unit. Throws
/// InvalidInput for options out of their range and for a direction that is zero or not finite.
Rect paint_direction(SlopeView source, MaskView mask, SlopeSpan target, Rect region,
                     const Vec3f& direction, float strength = 1.0F);
Rect paint_direction(SlopeView source, MaskView mask, SlopeSpan target, Rect region,
                     const PaintDirectionOptions& options);

struct RotateNormalsOptions {
  float azimuth = 0.0F;
  float tilt = 0.0F;
  float angle = 0.0F;

  static constexpr auto fields() {
    return std::tuple{
        field("azimuth", &RotateNormalsOptions::azimuth, "degrees", -360.0, 360.0,
              "Where the axis leans to: 0 right, 90 up"),
        field("tilt", &RotateNormalsOptions::tilt, "degrees", 0.0, 180.0,
              "Angle of the axis from the viewing direction: 0 turns normals in the picture, 90 "
              "about an axis in its plane"),
        field("angle", &RotateNormalsOptions::angle, "degrees", -180.0, 180.0,
              "Counterclockwise, the axis pointing to the viewer; 0 leaves the input as it is")};
  }
};

/// Turns normals about an axis by angle * mask, counterclockwise where the axis points at the
/// viewer. A normal that would turn below the horizon (core/slope.h) stops there. `axis` need not
/// be unit. Throws like paint_direction.
Rect rotate_normals(SlopeView source, MaskView mask, SlopeSpan target, Rect region,
                    const Vec3f& axis, float angle);
Rect rotate_normals(SlopeView source, MaskView mask, SlopeSpan target, Rect region,
                    const RotateNormalsOptions& options);

struct FlattenOptions {
  Vec2f slope = {0.0F, 0.0F};
  float strength = 1.0F;

  static constexpr auto fields() {
    return std::tuple{field("slope", &FlattenOptions::slope, "1", -50.0, 50.0,
                            "Slopes of the plane, to the right and up; 0 0 faces the viewer"),
                      field("strength", &FlattenOptions::strength, "1", 0.0, 1.0,
                            "How flat; 0 leaves the input as it is, 1 gives the plane")};
  }
};

/// target = source + strength * mask * (plane - source): heights approach those of the plane.
/// Throws InvalidInput for options out of their range.
Rect flatten(SlopeView source, MaskView mask, SlopeSpan target, Rect region,
             const FlattenOptions& options = {});
/// The same towards the slopes of `base` instead of a plane.
Rect flatten_to(SlopeView base, SlopeView source, MaskView mask, SlopeSpan target, Rect region,
                float strength = 1.0F);

/// Mean of the slopes, weighted by the mask; 0 where nothing counts. Slopes that are not finite
/// don't count.
Vec2d mean_slope(SlopeView source, MaskView mask);

/// target = source - mask * c, c being such that the mean slope in the whole mask becomes 0: the
/// mean itself where the mask is 0 or 1. `region` tells only what is written.
Rect balance_mean(SlopeView source, MaskView mask, SlopeSpan target, Rect region);

/// Lengths this close to 1 count as 1.
inline constexpr double unit_tolerance = 1e-6;

struct NormalizeReport {
  Rect written;
  std::size_t not_unit = 0;    ///< of another length: normalised
  std::size_t zero = 0;        ///< kept
  std::size_t not_finite = 0;  ///< made zero, "no direction"
};

/// Gives vectors length 1; those that have it keep their bits.
NormalizeReport normalize_vectors(ImageView<Vec3f> source, ImageSpan<Vec3f> target, Rect region);

/// Negates y: what a normal map with green down takes to have it up, and back.
Rect flip_green(SlopeView source, SlopeSpan target, Rect region);
Rect flip_green(ImageView<Vec3f> source, ImageSpan<Vec3f> target, Rect region);
/// Exchanges x and y.
Rect swap_red_green(SlopeView source, SlopeSpan target, Rect region);
Rect swap_red_green(ImageView<Vec3f> source, ImageSpan<Vec3f> target, Rect region);

}  // namespace normalshop
