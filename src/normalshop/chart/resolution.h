#pragma once

#include "normalshop/chart/grid.h"
#include "normalshop/chart/storage.h"

namespace normalshop {

/// Whose texels count: those of the normals, or the finer ones of normals and colours.
enum class CountedTexels { Normals, All };

/// How long a texel is: as the view shows it, or as if it faced the viewer.
enum class TexelLength { Seen, Facing };

/// Pixel size (object units) at which a chart of that part of the view is as fine as the texels
/// that it shows: for 95 % of the facing surface (by its area in the view, triangles within 75
/// degrees of the viewing direction) no texel is shorter than a pixel in any direction. Occlusion
/// is not considered. `low` and `high`: the part in object units from the view's centre, y up.
/// Where it shows no textured surface: 1/1024 of the view's larger side.
float texel_pixel_size(const Mesh& mesh, const StorageAtlas& storage, const View& view,
                       const Vec2f& low, const Vec2f& high,
                       CountedTexels counted = CountedTexels::Normals,
                       TexelLength length = TexelLength::Seen);

}  // namespace normalshop
