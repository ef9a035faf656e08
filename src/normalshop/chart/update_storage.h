#pragma once

#include "normalshop/chart/push.h"
#include "normalshop/chart/transfer.h"

namespace normalshop {

/// Fills chart.texel of a chart of triangles: the texel in whose cell lies what the pixel's centre
/// shows. It may be one of the gutter, or its centre lie in another triangle.
void find_texels(const Mesh& mesh, const StorageAtlas& storage, EditingChart& chart);

/// Carries an edit back by pixels, as the thesis does (5.3.3), for comparison with push(): the
/// edited normals themselves, not what the edit changed, go into the texels that the pixels of
/// edit.region with a weight show. Update::Point: the normal of the pixel nearest to the texel's
/// centre. Update::Area: the mean of all that show the texel. Not Update::Gather.
///
/// So what the edit leaves as it is gets resampled too; texels that no pixel shows are lost
/// (lost_texels()), and nothing is done for gutter and seams. A texel's frame is that of its owner,
/// of a shared or gutter texel that of its pixel's triangle. Deterministic for any number of
/// threads. In the result, visited and changed both count the texels written.
///
/// The chart has texels, normals and weight; change and coverage are of its size.
PushResult update_storage(const Mesh& mesh, const EditingChart& chart, const ChartEdit& edit,
                          Update how, StorageAtlas& storage);

/// How many texels push() would reach in the region, with a weight of a tenth or more, that no
/// pixel there shows. The chart has texels and weight.
std::size_t lost_texels(const Mesh& mesh, const EditingChart& chart, const Rect& region,
                        const StorageAtlas& storage);

}  // namespace normalshop
