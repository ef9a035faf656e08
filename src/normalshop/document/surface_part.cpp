#include "normalshop/document/surface_part.h"

#include <algorithm>
#include <iterator>

#include "normalshop/document/operate.h"
#include "normalshop/document/surface_trace.h"

namespace normalshop {

PartMask::PartMask(const Edit& edit, const Mesh& mesh) {
  if (!edit.part) return;
  const Seams seams = find_seams(mesh);
  std::vector<std::uint8_t> charts(seams.chart_count, 0);
  for (std::size_t i = 0; i < edit.part->charts_at.size(); ++i) {
    const SurfacePoint point = surface_point_near(
        mesh, edit.part->charts_at[i], edit.path + ".part.charts_at[" + std::to_string(i) + "]");
    charts[seams.chart[point.triangle]] = 1;
  }
  triangles_.resize(mesh.triangle_count());
  std::transform(
      seams.chart.begin(), seams.chart.end(), triangles_.begin(),
      [&](std::uint32_t chart) { return chart == no_chart ? std::uint8_t{0} : charts[chart]; });
}

CoverView PartMask::narrowed(const CoverView& view, const Mesh& mesh) const {
  if (all()) return view;
  Extent shown;
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    const bool hidden = view.shown && view.shown->triangles[t].isZero();
    if (triangles_[t] == 0 || hidden) continue;
    for (std::size_t corner = 3 * t; corner < 3 * t + 3; ++corner) {
      // A triangle shows nothing of its front where all of its corners face away.
      if (!(view.view.to_chart(mesh.normals[corner]).z() > 0.0F)) continue;
      for (std::size_t k = 3 * t; k < 3 * t + 3; ++k) {
        const Vec2f p = view.view.to_chart(mesh.position(k) - view.view.center).head<2>();
        shown.low = shown.low.cwiseMin(p);
        shown.high = shown.high.cwiseMax(p);
      }
      break;
    }
  }
  // The change is read between pixels, also at the border.
  const float margin = 0.02F * std::max(view.view.width, view.view.height);
  if (!shown.empty()) shown = widened(shown, margin);
  const Extent both = intersect(shown, Extent{view.low, view.high});
  CoverView narrow = view;
  narrow.low = both.low;
  narrow.high = both.high;
  return narrow;
}

std::vector<SeamEdge> PartMask::seams_within(std::span<const SeamEdge> seams) const {
  std::vector<SeamEdge> within;
  std::copy_if(seams.begin(), seams.end(), std::back_inserter(within), [&](const SeamEdge& edge) {
    return holds(edge.triangle_a) && holds(edge.triangle_b);
  });
  return within;
}

}  // namespace normalshop
