#pragma once

#include <array>
#include <string_view>
#include <tuple>

#include "normalshop/core/image.h"
#include "normalshop/core/options.h"

namespace normalshop {

/// How details meet the base under them. t: the base's normal, u: that of the details.
enum class CombineModel {
  Linear,      ///< slopes add up: displacement along the view (thesis 2.3)
  Rotation,    ///< the base turns as u is turned away from the view (thesis 2.5)
  Reoriented,  ///< u, turned by the shortest arc from the view to t (Barré-Brisebois, Hill 2012)
  Whiteout,    ///< (t.xy + u.xy, t.z u.z)
  Udn,         ///< (t.xy + u.xy, t.z)
  Overlay,     ///< colours overlaid; for comparison: flat details flatten the base
};
constexpr auto names_of(CombineModel) {
  return std::array<std::string_view, 6>{"linear",   "rotation", "reoriented",
                                         "whiteout", "udn",      "overlay"};
}

struct CombineOptions {
  CombineModel model = CombineModel::Linear;
  float strength = 1.0F;

  static constexpr auto fields() {
    return std::tuple{field("model", &CombineOptions::model, "How details meet what is below them"),
                      field("strength", &CombineOptions::strength, "1", -100.0, 100.0,
                            "Multiplies the details' slopes; 0 leaves the base as it is")};
  }
};

/// target = model(base, strength * mask * details) in `region`: strength and mask scale the
/// details' slopes, so that a mask that falls to 0 leaves no border. Overlay, which has no neutral
/// details, goes from the base's slopes to the overlaid ones by strength * mask instead. Normals
/// that would point below the horizon stop at it (core/slope.h) with their azimuth kept. Slopes
/// that are no number stay or become so in their own pixel, details only where strength * mask is
/// not 0. All images have one size; target may be base. Returns the region that it wrote. Throws
/// InvalidInput for a strength that is not a number.
///
/// A detail of 10 degrees on a base of 60 keeps a tilt from it of 3.9 degrees with Linear, 7.7 with
/// Whiteout and Udn, 10 with Reoriented and Rotation. Only Linear keeps integrability, and only
/// with it the order of details does not matter.
Rect combine(SlopeView base, SlopeView details, MaskView mask, SlopeSpan target, Rect region,
             const CombineOptions& options = {});

/// The linear model alone (thesis 2.3): target = base + strength * mask * details. It keeps
/// integrability and every frequency that the details don't have.
Rect combine_linear(SlopeView base, SlopeView details, MaskView mask, float strength,
                    SlopeSpan target, Rect region);

/// The rotation model alone (thesis 2.5), which displaces along the normals of `smooth`, the base
/// without its fine frequencies. In every pixel with the normals a of base, n of smooth and u of
/// strength * mask * details: u, read in the tangent frame of n (turned there by the shortest arc
/// from the view), is the direction b; a is turned by the rotation that takes n to b, along their
/// great arc, and so keeps the frequencies that n lacks. Where b would dip below the horizon the
/// rotation stops on the arc at z = min_cosine. With smooth = base, which is what combine() takes,
/// the result is b: Reoriented with another saturation.
Rect combine_rotation(SlopeView base, SlopeView smooth, SlopeView details, MaskView mask,
                      float strength, SlopeSpan target, Rect region);

}  // namespace normalshop
