#include "normalshop/document/surface_part.h"

#include <algorithm>
#include <iterator>

#include "normalshop/chart/pull_masks.h"
#include "normalshop/core/error.h"
#include "normalshop/core/for_pixels.h"
#include "normalshop/document/operate.h"
#include "normalshop/document/surface_trace.h"
#include "normalshop/rgbn/smooth.h"
#include "normalshop/surface/texel_density.h"

namespace normalshop {

namespace {

/// The masks by texture set.
std::vector<std::shared_ptr<const MaskImage>> masks_by_set(const Edit& edit, const Mesh& mesh) {
  const std::vector<std::string>& names = mesh.texture_set_names;
  std::vector<std::shared_ptr<const MaskImage>> out(names.size());
  for (const AtlasMask& mask : edit.part->masks) {
    bool found = false;
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (!mask.set.empty() && mask.set != names[i]) continue;
      out[i] = mask.image;
      found = true;
    }
    if (found) continue;
    throw InvalidInput(edit.path + ".part.mask names the texture set '" + mask.set +
                       "', which the model does not have; it has '" + names.front() + "'" +
                       (names.size() > 1 ? " and others" : ""));
  }
  return out;
}

}  // namespace

Edit with_feather_in_units(Edit edit, const Mesh& mesh, const StorageAtlas& storage) {
  if (!edit.part || !(edit.part->feather_texels > 0.0F)) return edit;
  double texel = 0.0;
  for (std::size_t i = 0; i < storage.sets.size() && !(texel > 0.0); ++i) {
    const NormalMap& map = storage.sets[i].normals;
    texel =
        texel_density(mesh, static_cast<std::uint32_t>(i), map.width(), map.height()).area_median;
  }
  edit.part->feather = edit.part->feather_texels * static_cast<float>(texel);
  edit.part->feather_texels = 0.0F;
  return edit;
}

PartMask::PartMask(const Edit& edit, const Mesh& mesh) {
  if (!edit.part) return;
  if (!edit.part->masks.empty()) masks_ = masks_by_set(edit, mesh);
  feather_ = edit.part->feather;
  if (edit.part->charts_at.empty()) return;
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

MaskImage PartMask::weights(const Mesh& mesh, const EditingChart& chart) const {
  std::vector<MaskView> masks;
  for (const auto& mask : masks_) masks.push_back(mask ? mask->view() : MaskView());
  MaskImage weights = pull_masks(mesh, masks, chart);
  if (!(feather_ > 0.0F)) return weights;
  MaskImage seen(weights.width(), weights.height());
  for_pixels(seen.rect(), [&](int x, int y) {
    seen(x, y) = chart.ids.triangle(x, y) == no_triangle ? 0.0F : 1.0F;
  });
  // Two standard deviations on either side of the border.
  const auto widest = static_cast<float>(std::max(weights.width(), weights.height()));
  SmoothOptions blur;
  blur.sigma = std::min(0.25F * feather_ / chart.grid.pixel, widest);
  smooth(weights, seen, weights, weights.rect(), blur);
  return weights;
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
