#pragma once

#include <span>

#include "normalshop/document/tile_plan.h"
#include "normalshop/surface/seam_mismatch.h"

namespace normalshop {

/// An edit in one view whose chart is cut into tiles, which are there one after the other: texels
/// keep their resolution, and memory goes with one tile. Texels get what they would from the chart
/// in one piece, up to rounding: pixels of different windows have coordinates that round
/// differently, and weights at the borders of the surface what lies within a tile's margin.
/// `seams` are those of the whole mesh. Throws as prepare_edit(), before anything changes.
EditReport apply_in_tiles(const Edit& edit, const CoverView& view, const ChartPlan& plan,
                          const TilePlan& tiles, const Mesh& mesh, std::span<const SeamEdge> seams,
                          StorageAtlas& storage);

}  // namespace normalshop
