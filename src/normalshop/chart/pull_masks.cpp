#include "normalshop/chart/pull_masks.h"

#include <cassert>

#include "normalshop/chart/chart_triangle.h"
#include "normalshop/chart/pixel_row.h"
#include "normalshop/core/parallel.h"
#include "normalshop/core/sample.h"

namespace normalshop {

namespace {

float mask_at(const Mesh& mesh, std::uint32_t set, MaskView mask, const Vec2f& uv) {
  if (mask.empty()) return 0.0F;
  const Vec2f place =
      mesh.repeats(set) ? uv : reading_place(mesh, set, uv, mask.width(), mask.height());
  return sample_bilinear<float, Border::Wrap>(mask,
                                              place.x() * static_cast<float>(mask.width()) - 0.5F,
                                              place.y() * static_cast<float>(mask.height()) - 0.5F);
}

}  // namespace

MaskImage pull_masks(const Mesh& mesh, std::span<const MaskView> masks, const EditingChart& chart) {
  assert(masks.size() >= mesh.texture_set_names.size());
  const Image<std::uint32_t>& ids = chart.ids.triangle;
  MaskImage out(ids.width(), ids.height(), 0.0F);
  parallel_for(static_cast<std::size_t>(ids.height()), 16, [&](std::size_t begin, std::size_t end) {
    TriangleCache<PixelTriangle> triangles(mesh, chart.grid);
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      for (int x = 0; x < ids.width(); ++x) {
        if (ids(x, y) == no_triangle) continue;
        const PixelTriangle& t = triangles.get(ids(x, y));
        const Vec2f b =
            (static_cast<float>(x) - t.x0) * t.dx + (static_cast<float>(y) - t.y0) * t.dy;
        const Vec2f uv = t.uv + b.x() * t.uv1 + b.y() * t.uv2;
        out(x, y) = mask_at(mesh, t.texture_set, masks[t.texture_set], uv);
      }
    }
  });
  return out;
}

}  // namespace normalshop
