#pragma once

#include "normalshop/chart/pull.h"

namespace normalshop {

/// Builds the chart of points instead of triangles (thesis 5.3.2): every texel of the storage atlas
/// is a point of the surface with its own normals and colour, and so is each further place that a
/// shared texel stands for. chart.texel is filled.
///
/// A pixel takes the nearest point that falls into it (of points whose depths at its centre differ
/// by less than half a pixel the one nearest to the centre), unless the splats around hide
/// it. Splats are as large as their texels and tilted like their triangles, so that a smooth
/// surface does not hide its own points. Holes between points show the nearest one
/// (L-infinity), with its plane's depth. Ids end with the surface: within a pixel where texels are
/// no larger than pixels, else within a texel.
///
/// Texels smaller than pixels lose each other's places; those far larger than 128 pixels leave
/// holes. Deterministic for any number of threads. Throws InvalidInput where there are 2^32 points
/// or more.
EditingChart pull_points(const Mesh& mesh, const StorageAtlas& storage, const ChartGrid& grid,
                         const PullOptions& options = {});
/// The same into buffers that are kept from chart to chart. chart.weight is left as it is.
void pull_points(const Mesh& mesh, const StorageAtlas& storage, const ChartGrid& grid,
                 const PullOptions& options, EditingChart& chart);

}  // namespace normalshop
