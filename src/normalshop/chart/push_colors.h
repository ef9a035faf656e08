#pragma once

#include "normalshop/chart/pull.h"

namespace normalshop {

/// What an operator did to the colours of an editing chart: linear RGB that is added to what the
/// texels show, times the weight.
struct ColorEdit {
  ColorView change;  ///< size of the chart
  Rect region;       ///< pixels outside change nothing
};

struct ColorPushResult {
  std::size_t visited = 0;  ///< texels of triangles that may lie in the region
  std::size_t changed = 0;  ///< texels and gutter texels with a new code
};

/// Carries an edit of colours back as push() does one of normals: by gathering, with the same rules
/// for what the chart sees, for gutters and for shared texels. Texture sets without a colour map
/// keep their constant colour. Where a colour map has another size than the normals, the texels
/// that it has are found on the first push and kept in the storage. Deterministic for any number of
/// threads.
ColorPushResult push_colors(const Mesh& mesh, const EditingChart& chart, const ColorEdit& edit,
                            StorageAtlas& storage);

}  // namespace normalshop
