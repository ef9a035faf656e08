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

constexpr float least_feather = 2.0F;  ///< pixels: no staircase

/// The pixel there; in a tile the one that repeats there.
Vec2i pixel_at(const Vec2f& p, const Rect& chart, Border border) {
  const Vec2i pixel(static_cast<int>(std::lround(p.x())), static_cast<int>(std::lround(p.y())));
  if (border != Border::Wrap) return pixel;
  return {border_pixel(pixel.x(), chart.width(), border).index,
          border_pixel(pixel.y(), chart.height(), border).index};
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

void pick_alike(const FilterAreaOptions& options, const OperatorInput& input, const RgbnView& seen,
                MaskSpan mask) {
  WandOptions wand;
  wand.color_tolerance = options.color_tolerance;
  wand.angle_tolerance = options.angle_tolerance;
  MaskImage picked(mask.width(), mask.height());
  for (const Stroke& stroke : input.strokes) {
    for (const StrokePoint& point : stroke) {
      const Vec2i pixel = pixel_at(point.position, mask.rect(), input.border);
      select_alike(seen, pixel, picked, wand, input.border);
      combine_masks(mask, picked, mask, mask.rect(), MaskOperation::Add);
    }
  }
}

/// The same falloff as elsewhere in a tile's sides: from a copy that goes on beyond them.
void feather_tile(const MaskImage& mask, const FeatherMaskOptions& options, MaskSpan target) {
  const int margin = reach(options);
  MaskImage wide(mask.width() + 2 * margin, mask.height() + 2 * margin);
  for_pixels(wide.rect(), [&](int x, int y) {
    wide(x, y) = mask(border_pixel(x - margin, mask.width(), Border::Wrap).index,
                      border_pixel(y - margin, mask.height(), Border::Wrap).index);
  });
  MaskImage soft(wide.width(), wide.height());
  feather_mask(wide, soft, shift(mask.rect(), margin, margin), options);
  for_pixels(mask.rect(), [&](int x, int y) { target(x, y) = soft(x + margin, y + margin); });
}

void soften(float feather, Border border, MaskSpan mask) {
  MaskImage hard(mask.width(), mask.height());
  for_pixels(hard.rect(), [&](int x, int y) { hard(x, y) = mask(x, y); });
  const auto side = static_cast<float>(std::min(mask.width(), mask.height()));
  const FeatherMaskOptions options{std::max(least_feather, std::min(feather, side))};
  if (border == Border::Wrap) {
    feather_tile(hard, options, mask);
  } else {
    feather_mask(hard, mask, mask.rect(), options);
  }
}

Rect bounds(MaskView mask) {
  Rect out;
  for (int y = 0; y < mask.height(); ++y) {
    const float* row = mask.row(y);
    const float* end = row + mask.width();
    const auto is_picked = [](float value) { return value > 0.0F; };
    const float* first = std::find_if(row, end, is_picked);
    if (first == end) continue;
    const float* last = end - 1;
    while (!is_picked(*last)) --last;
    out = unite(out, {static_cast<int>(first - row), y, static_cast<int>(last - row) + 1, y + 1});
  }
  return out;
}

}  // namespace

Rect pick_area(const FilterAreaOptions& options, const OperatorInput& input, MaskView view,
               MaskSpan mask) {
  const RgbnView seen{input.seen, input.colors, input.validity};
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
