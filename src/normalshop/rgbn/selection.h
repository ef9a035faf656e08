#pragma once

#include <cstdint>
#include <span>
#include <tuple>

#include "normalshop/core/border.h"
#include "normalshop/core/options.h"
#include "normalshop/rgbn/rgbn_image.h"

/// Masks made by picking in the picture: 1 selected, 0 not. All images of a call have one size.
namespace normalshop {

/// mask = 1 where the label (of segment(), say) is one of `chosen`. Returns the pixels that it
/// wrote: region within mask.
Rect select_labels(ImageView<std::uint32_t> labels, std::span<const std::uint32_t> chosen,
                   MaskSpan mask, Rect region);

struct WandOptions {
  float color_tolerance = 0.1F;
  float angle_tolerance = 15.0F;
  bool contiguous = true;

  static constexpr auto fields() {
    return std::tuple{
        field("color_tolerance", &WandOptions::color_tolerance, "1", 0.0, 1e6,
              "Largest distance between linear colours; 0 selects equal ones, 1e6 all"),
        field("angle_tolerance", &WandOptions::angle_tolerance, "degrees", 0.0, 180.0,
              "Largest angle between normals; 0 selects equal ones, 180 all"),
        field("contiguous", &WandOptions::contiguous,
              "Only what hangs together with the seed (side by side), not all of the picture")};
  }
};

/// Magic wand: the pixels whose colour and normal both differ from those of pixel `seed` (column,
/// row) by no more than the tolerances. Without colours, normals alone count. Pixels with validity
/// 0, or of which a number is not finite, are not selected; a seed of that kind, or outside the
/// image, selects nothing. Writes the whole mask and returns the smallest rectangle around what it
/// selected. With Border::Wrap, pixels on opposite sides hang together. Throws InvalidInput for
/// options out of their range.
Rect select_alike(const RgbnView& image, const Vec2i& seed, MaskSpan mask,
                  const WandOptions& options = {}, Border border = Border::Clamp);

/// Lasso: how much of each pixel lies inside the polygon, where its winding number is not 0,
/// whatever the direction. Points in pixels, (i, j) the centre of pixel (i, j), rows down; the last
/// one is joined to the first. Exact along rows and from 16 lines a pixel across them: off by less
/// than 1/16, far less along edges that cross the pixel. Returns the pixels that it wrote: region
/// within mask. Less than 3 points select nothing. Throws InvalidInput for points that are not
/// finite.
Rect select_polygon(std::span<const Vec2f> polygon, MaskSpan mask, Rect region);

}  // namespace normalshop
