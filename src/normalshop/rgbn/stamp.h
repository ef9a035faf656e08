#pragma once

#include <array>
#include <string_view>
#include <tuple>

#include "normalshop/core/image.h"
#include "normalshop/core/options.h"
#include "normalshop/rgbn/placement.h"

namespace normalshop {

/// A piece of an RGBN image. Images that are not empty have the size of `slopes`.
struct Patch {
  SlopeImage slopes;  ///< y up
  MaskImage opacity;  ///< 0 to 1; empty: 1
  ColorImage color;   ///< may be empty
};

/// What scale_x, scale_y and shear do to the patch's heights. (Its size changes both alike.)
enum class StampHeights {
  Keep,  ///< heights stay, so slopes get flatter where it is stretched (thesis 2.3)
  Grow,  ///< heights grow with the root of the area: a uniform scale keeps the slopes
};
constexpr auto names_of(StampHeights) { return std::array<std::string_view, 2>{"keep", "grow"}; }

struct StampOptions : Placement {
  float size = 0.0F;
  float relief = 1.0F;
  StampHeights heights = StampHeights::Keep;
  float border = 0.1F;

  static constexpr auto fields() {
    return std::tuple_cat(
        std::tuple{field("size", &StampOptions::size, "length", 0.0, 1e6,
                         "Width of the patch on the surface; 0 gives every pixel of the patch one "
                         "pixel of the chart"),
                   field("relief", &StampOptions::relief, "1", -100.0, 100.0,
                         "Multiplies the patch's heights; negative digs; 0 flattens")},
        placement_fields<StampOptions>(),
        std::tuple{field("heights", &StampOptions::heights,
                         "Whether heights keep or grow when the patch is scaled"),
                   field("border", &StampOptions::border, "1", 0.0, 0.5,
                         "Part of the patch's size over which it fades out at its border; 0 cuts "
                         "it off")});
  }
};

/// Lays the patch's centre on `center` (pixels, y down): details = opacity * A^-T slopes, with
/// gradients transformed by the inverse transpose of the placement A (thesis 2.3), and coverage =
/// opacity (may be empty). Both become 0 in the rest of `region`. Bicubic where the patch is
/// magnified, averaged over the pixel where it is minified; exact under quarter turns and mirrors
/// at size 0 with centres that fall on centres. Opacity scales slopes, not the unknown heights:
/// where it varies the result is not exactly the gradient of a height.
///
/// Returns the rectangle outside of which both are 0. Throws InvalidInput for an empty patch,
/// images of different sizes, and what placement_matrix() rejects.
Rect stamp(SlopeSpan details, MaskSpan coverage, Rect region, const Patch& patch,
           const Vec2f& center, const StampOptions& options = {});

/// The patch repeated without end, one copy's centre on `center`: stamp() without border, on all of
/// `region`. A patch that tiles shows no seam at any size; one that is averaged over more than 16
/// of its pixels (a copy under a 16th of them) is averaged over 16 x 16 places in each of the
/// chart's.
Rect stamp_repeated(SlopeSpan details, MaskSpan coverage, Rect region, const Patch& patch,
                    const Vec2f& center, const StampOptions& options = {});

/// The patch's colour laid over `color` (linear) with the same placement, by opacity.
Rect stamp_color(ColorSpan color, Rect region, const Patch& patch, const Vec2f& center,
                 const StampOptions& options = {});

/// Pixels around the centre that stamp() may change.
int reach(const StampOptions& options, const Patch& patch);

}  // namespace normalshop
