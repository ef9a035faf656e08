#pragma once

#include "normalshop/chart/edit_reach.h"
#include "normalshop/chart/texel_batch.h"

/// Which points of a batch the chart sees, private to floor 4.
namespace normalshop {

/// Fills batch.weight: the effective chart's weight around each point, read only from the pixels
/// that show the point's surface, namely those whose depth is what the triangle's plane has there,
/// within what the surface may bend over a pixel: as much as the steeper of the plane and of the
/// base normal at the point is steep, and a pixel more. 0 where no pixel around the point does
/// (something nearer hides it), where the base surface is seen at a grazing angle, and in blocks of
/// pixels that the edit does not reach. False when no point is of the front and in a marked
/// block, where all are 0.
bool read_visible_weight(const EditReach& reach, TexelBatch& batch);

}  // namespace normalshop
