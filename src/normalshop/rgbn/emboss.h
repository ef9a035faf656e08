#pragma once

#include <tuple>
#include <vector>

#include "normalshop/core/image.h"
#include "normalshop/core/options.h"
#include "normalshop/rgbn/placement.h"

namespace normalshop {

/// Closed polygons, the last point is joined to the first; y UP, em = 1. Inside is where the
/// winding number is not 0.
using Outline = std::vector<std::vector<Vec2f>>;

/// Moves the middle of the outline's bounding box to the origin.
Outline centered(Outline outline);

struct EmbossOptions : Placement {
  float size = 32.0F;
  float height = 2.0F;
  float bevel = 4.0F;

  static constexpr auto fields() {
    return std::tuple_cat(
        std::tuple{field("size", &EmbossOptions::size, "length", 0.0, 1e6,
                         "Size of the letters (one em); 0 draws nothing"),
                   field("height", &EmbossOptions::height, "length", -1e6, 1e6,
                         "How far the letters rise; negative imprints them; 0 draws nothing"),
                   field("bevel", &EmbossOptions::bevel, "length", 0.0, 1e6,
                         "Width of the slope at the letters' edges; at least 2 pixels are used")},
        placement_fields<EmbossOptions>());
  }
};

/// Letters (any outline) as relief: details = slopes (y up) of height * step(signed distance to the
/// outline / half the bevel), coverage = 1 inside falling to 0 over the bevel (may be empty). The
/// outline's origin comes to lie on `origin` (pixels, y down). Distances are measured after the
/// placement, so a stretched letter keeps its bevel. All of `region` is written; returns the
/// rectangle outside of which both are 0.
///
/// Throws InvalidInput for points or numbers that are not finite, a contour with fewer than 3
/// points, and what placement_matrix() rejects.
Rect emboss(SlopeSpan details, MaskSpan coverage, Rect region, const Outline& outline, Vec2f origin,
            const EmbossOptions& options = {});

/// Pixels around the origin that emboss() may change.
int reach(const EmbossOptions& options, const Outline& outline);

}  // namespace normalshop
