#include "normalshop/document/operators/picked_area.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "normalshop/core/for_pixels.h"
#include "normalshop/rgbn/mask.h"
#include "normalshop/rgbn/segment.h"
#include "normalshop/rgbn/selection.h"

namespace normalshop {

namespace {

constexpr float least_feather = 2.0F;     ///< pixels: no staircase
constexpr float largest_feather = 0.25F;  ///< of the chart's shorter side

/// The pixel there; in a tile the one that repeats there.
Vec2i pixel_at(const Vec2f& p, const Rect& chart, Border border) {
  const auto x = static_cast<int>(std::lround(p.x()));
  const auto y = static_cast<int>(std::lround(p.y()));
  if (border != Border::Wrap) return {x, y};
  return {border_pixel(x, chart.width(), border).index,
          border_pixel(y, chart.height(), border).index};
}

/// visit(pixel) along a stroke, at least once a pixel.
template <class Visit>
void walk(const Stroke& stroke, const Rect& chart, Border border, const Visit& visit) {
  const auto visit_point = [&](const Vec2f& p) {
    const Vec2i pixel = pixel_at(p, chart, border);
    if (chart.contains(pixel.x(), pixel.y())) visit(pixel);
  };
  visit_point(stroke.front().position);
  for (std::size_t i = 1; i < stroke.size(); ++i) {
    const Vec2f& from = stroke[i - 1].position;
    const Vec2f step = stroke[i].position - from;
    const int count = 1 + static_cast<int>(std::min(step.norm(), 1e6F));
    for (int k = 1; k <= count; ++k) {
      visit_point(from + (static_cast<float>(k) / static_cast<float>(count)) * step);
    }
  }
}

void pick_segments(const FilterAreaOptions& options, const OperatorInput& input,
                   const RgbnView& seen, MaskSpan mask) {
  SegmentOptions graph;
  graph.coarseness = options.coarseness;
  graph.color_weight = options.color_weight;
  const Segments segments = segment(seen, graph, input.border);
  std::set<std::uint32_t> chosen;
  for (const Stroke& stroke : input.strokes) {
    walk(stroke, mask.rect(), input.border,
         [&](const Vec2i& p) { chosen.insert(segments.labels(p.x(), p.y())); });
  }
  chosen.erase(no_label);
  const std::vector<std::uint32_t> list(chosen.begin(), chosen.end());
  select_labels(segments.labels, list, mask, mask.rect());
}

/// A point in what is picked already adds nothing: dense strokes cost no more than clicks.
void pick_alike(const FilterAreaOptions& options, const OperatorInput& input, const RgbnView& seen,
                MaskSpan mask) {
  WandOptions wand;
  wand.color_tolerance = options.color_tolerance;
  wand.angle_tolerance = options.angle_tolerance;
  MaskImage picked(mask.width(), mask.height());
  for (const Stroke& stroke : input.strokes) {
    for (const StrokePoint& point : stroke) {
      const Vec2i pixel = pixel_at(point.position, mask.rect(), input.border);
      if (!mask.rect().contains(pixel.x(), pixel.y()) || mask(pixel.x(), pixel.y()) > 0.0F)
        continue;
      select_alike(seen, pixel, picked, wand, input.border);
      combine_masks(mask, picked, mask, mask.rect(), MaskOperation::Add);
    }
  }
}

/// Feathers, and closes holes and gaps that are narrower than half the feather before: else every
/// pixel of noise that was not picked would keep all around it from full strength.
void soften(float feather, Border border, MaskSpan mask) {
  const auto side = static_cast<float>(std::min(mask.width(), mask.height()));
  const float width = std::max(least_feather, std::min(feather, largest_feather * side));
  const float closed = 0.25F * width;
  MaskImage grown(mask.width(), mask.height());
  grow_mask(mask, grown, mask.rect(), {closed}, border);
  MaskImage shrunk(mask.width(), mask.height());
  grow_mask(grown, shrunk, mask.rect(), {-closed}, border);
  feather_mask(shrunk, mask, mask.rect(), {width}, border);
}

/// How far pixels count, none beyond the view: what is picked does not depend on how far the
/// operator reads.
MaskImage validity_in_view(const OperatorInput& input, const Rect& chart) {
  MaskImage validity(chart.width(), chart.height(), 0.0F);
  for_pixels(intersect(input.view, chart),
             [&](int x, int y) { validity(x, y) = input.validity(x, y); });
  return validity;
}

}  // namespace

Rect pick_area(const FilterAreaOptions& options, const OperatorInput& input, MaskView view,
               MaskSpan mask) {
  const MaskImage validity = validity_in_view(input, mask.rect());
  const RgbnView seen{input.seen, input.colors, validity};
  if (options.area == FilterArea::Segments) {
    pick_segments(options, input, seen, mask);
  } else {
    pick_alike(options, input, seen, mask);
  }
  soften(options.feather, input.border, mask);
  for_pixels(mask.rect(), [&](int x, int y) { mask(x, y) *= view(x, y); });
  return bounds(mask);
}

}  // namespace normalshop
