#pragma once

#include "normalshop/chart/pull.h"

namespace normalshop {

/// What an operator did to the colours of an editing chart: linear RGB that is added to what the
/// texels show, times the weight.
struct ColorEdit {
  ColorView change;  ///< size of the chart; read beyond the borders of the surface, too
  Rect region;       ///< pixels outside change nothing
};

struct ColorPushResult {
  std::size_t visited = 0;  ///< texels of triangles that may lie in the region
  std::size_t changed = 0;  ///< texels and gutter texels with a new code
};

/// Finds the texels of colour maps that have another size than the normals, and makes all editable.
/// push_colors() does it where it was not done; it is what takes memory.
void prepare_colors(const Mesh& mesh, StorageAtlas& storage);

/// Carries an edit of colours back as push() does one of normals: by gathering, with the same rules
/// for what the chart sees, for gutters and for shared texels. Texture sets without a colour map
/// keep their constant colour. Deterministic for any number of
/// threads.
ColorPushResult push_colors(const Mesh& mesh, const EditingChart& chart, const ColorEdit& edit,
                            StorageAtlas& storage);

}  // namespace normalshop
