#pragma once

#include "normalshop/chart/rasterizer.h"
#include "normalshop/chart/storage.h"
#include "normalshop/core/image.h"

namespace normalshop {

/// An editing chart: what an orthographic view shows of the storage atlas, an RGBN image with ids.
/// Normals are unit and in chart axes. Pixels that see no surface hold zero vectors.
struct EditingChart {
  ChartGrid grid;
  IdBuffer ids;
  Image<Vec3f> base_normal;  ///< N^b; points away from the viewer on back faces
  Image<Vec3f> normal;       ///< N^f: the stored normals, details included; empty unless asked for
  ColorImage albedo;         ///< linear RGB; empty unless asked for
  MaskImage weight;          ///< effective chart: see effective.h; empty until asked for
  /// Which texel (y * width + x in its triangle's texture set) a pixel shows; empty until asked
  /// for: pull_points(), find_texels().
  Image<std::uint32_t> texel;
};

struct PullOptions {
  bool normals = true;  ///< false: base normals only, for edits that don't read the details
  bool albedo = false;
  /// Pixels that cover several texels show the mean of these instead of the one in the middle, so
  /// that what operators read has no aliasing: the mean of slopes, or of unit vectors where the map
  /// is not in tangent space. Pixels with up to 1.5 texels a side are the same either way.
  bool means = true;
};

/// Looks up normals (and albedo) for every pixel of chart.ids: transfer by triangles
/// (thesis 5.3.1), bilinear in the atlas. Needs chart.grid and chart.ids; beside the maps, `means`
/// reads which texels belong to which triangle.
void pull_attributes(const Mesh& mesh, const StorageAtlas& storage, EditingChart& chart,
                     const PullOptions& options = {});

/// Rasterises the grid and pulls.
EditingChart pull(const Mesh& mesh, const StorageAtlas& storage, const ChartGrid& grid,
                  const PullOptions& options = {});
/// The same into buffers that are kept from chart to chart. chart.weight is left as it is.
void pull(const Mesh& mesh, const StorageAtlas& storage, const ChartGrid& grid,
          const PullOptions& options, Rasterizer& rasterizer, EditingChart& chart);

}  // namespace normalshop
