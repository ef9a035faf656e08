#pragma once

#include "normalshop/chart/texel_batch.h"
#include "normalshop/core/image.h"

/// What an edit changes at the points of a batch, private to floor 4.
namespace normalshop {

/// Fills change_x and change_y of the batch's points: weight times the change, bicubic; 0 where the
/// weight is 0. Pixels outside the region count as 0, and the image's border continues within it.
void read_change(SlopeView change, const Rect& region, TexelBatch& batch);

}  // namespace normalshop
