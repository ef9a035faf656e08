#pragma once

#include <array>
#include <string_view>
#include <tuple>

#include "normalshop/core/border.h"
#include "normalshop/core/image.h"
#include "normalshop/core/options.h"

/// What is done with masks. All images of a call have one size and target may be a source, unless a
/// function says otherwise; each returns the pixels that it wrote: region within target.
namespace normalshop {

/// How a second mask changes the first one, m.
/// Add: max(m, other). Subtract: min(m, 1 - other). Intersect: min(m, other). Doing one twice does
/// no more than once, also where masks are soft.
enum class MaskOperation { Add, Subtract, Intersect };
constexpr auto names_of(MaskOperation) {
  return std::array<std::string_view, 3>{"add", "subtract", "intersect"};
}

Rect combine_masks(MaskView mask, MaskView other, MaskSpan target, Rect region,
                   MaskOperation operation);

/// The smallest rectangle around what is above 0.
Rect bounds(MaskView mask);

/// target = 1 - mask.
Rect invert_mask(MaskView mask, MaskSpan target, Rect region);

struct GrowMaskOptions {
  float distance = 0.0F;

  static constexpr auto fields() {
    return std::tuple{field("distance", &GrowMaskOptions::distance, "length", -1e5, 1e5,
                            "How far the border moves outwards; negative moves it inwards, 0 "
                            "leaves the mask as it is")};
  }
};

/// Moves the border of a mask by a Euclidean distance. The border runs half a pixel beside the
/// pixels of at least 0.5, so soft ones become firm where it comes from or goes to; the new border
/// is antialiased. Exact for borders along rows and columns, within half a pixel for others.
/// Growing leaves no pixel lower and shrinking none higher than it was. `distance` in pixels, the
/// time grows with it. target is another image than mask. Throws InvalidInput for a distance out of
/// its range. With Border::Wrap a mask goes on beyond its sides as a tile does, else it ends there.
Rect grow_mask(MaskView mask, MaskSpan target, Rect region, const GrowMaskOptions& options,
               Border border = Border::Clamp);
/// Pixels read beyond the region.
int reach(const GrowMaskOptions& options);

struct FeatherMaskOptions {
  float width = 0.0F;

  static constexpr auto fields() {
    return std::tuple{field("width", &FeatherMaskOptions::width, "length", 0.0, 1e5,
                            "Width of the falloff from 1 to 0, half of it on each side of the "
                            "border; 0 leaves the mask as it is")};
  }
};

/// Lets a mask fall off smoothly (3 t^2 - 2 t^3) with the Euclidean distance from its border, which
/// runs half a pixel beside the pixels of at least 0.5: 0.5 at the border, 1 from half the width
/// inside and 0 from half the width outside on. `width` in pixels, the time grows with it. target
/// is another image than mask. Throws InvalidInput for a width out of its range. `border` as above.
Rect feather_mask(MaskView mask, MaskSpan target, Rect region, const FeatherMaskOptions& options,
                  Border border = Border::Clamp);
/// Pixels read beyond the region.
int reach(const FeatherMaskOptions& options);

}  // namespace normalshop
