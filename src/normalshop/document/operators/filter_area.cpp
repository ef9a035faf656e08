#include "normalshop/document/operators/filter_area.h"

#include <algorithm>
#include <cmath>

#include "normalshop/core/error.h"
#include "normalshop/core/for_pixels.h"
#include "normalshop/document/operators/picked_area.h"
#include "normalshop/rgbn/pen.h"

namespace normalshop {

namespace {

constexpr float feather_share = 0.04F;

float size_of(const std::vector<Stroke>& strokes) {
  Vec2f low = Vec2f::Constant(3.4e38F);
  Vec2f high = -low;
  for (const Stroke& stroke : strokes) {
    for (const StrokePoint& p : stroke) {
      low = low.cwiseMin(p.position);
      high = high.cwiseMax(p.position);
    }
  }
  return std::max(0.0F, (high - low).minCoeff());
}

/// Closed polygons filled with a soft edge: the height of a closed step.
Rect fill_inside(const std::vector<Stroke>& polygons, float feather, Rect region, MaskSpan mask) {
  PenOptions step;
  step.profile = ProfileShape::Step;
  step.closed = true;
  step.smooth = false;
  step.height = 1.0F;
  step.width = std::max(feather, 1.0F);
  step.pressure = PressureTo::None;
  return pen_height(mask, region, polygons, step);
}

Rect fill_brush(const FilterAreaOptions& options, const OperatorInput& input, MaskSpan mask) {
  PenOptions brush;
  brush.profile = ProfileShape::Custom;
  const float plateau = options.hardness;
  brush.curve = plateau > 0.0F
                    ? Curve({{-1.0F, 0.0F}, {-plateau, 1.0F}, {plateau, 1.0F}, {1.0F, 0.0F}})
                    : Curve({{-1.0F, 0.0F}, {0.0F, 1.0F}, {1.0F, 0.0F}});
  brush.width = options.brush;
  brush.height = 1.0F;
  brush.smooth = true;
  return pen_height(mask, input.region, input.strokes, brush);
}

/// The view's rectangle, drawn in by half the feather so that the mask is 0 at its border; sides
/// beyond which there is no model have nothing to fade to and lie outside.
Stroke view_polygon(const Rect& view, const Rect& model, float feather) {
  const float inset = 0.5F * feather;
  const auto side = [&](int at, int surface, float inwards) {
    const bool cuts = inwards > 0.0F ? surface < at : surface > at;
    return static_cast<float>(cuts ? at : surface) + inwards * (cuts ? inset : -inset - 4.0F);
  };
  const float x0 = side(view.x0, model.x0, 1.0F);
  const float y0 = side(view.y0, model.y0, 1.0F);
  const float x1 = side(view.x1, model.x1, -1.0F);
  const float y1 = side(view.y1, model.y1, -1.0F);
  return {{{x0, y0}}, {{x1, y0}}, {{x1, y1}}, {{x0, y1}}};
}

Rect fill_view(float feather, const OperatorInput& input, MaskSpan mask) {
  const auto side = static_cast<float>(std::min(input.view.width(), input.view.height()));
  const float width = std::min(feather > 0.0F ? feather : feather_share * side, 0.9F * side);
  return fill_inside({view_polygon(input.view, input.model, width)}, width, input.region, mask);
}

/// What is picked fades towards the view's sides as the whole view does.
Rect fill_picked(const FilterAreaOptions& options, const OperatorInput& input, MaskSpan mask) {
  MaskImage view(mask.width(), mask.height(), 0.0F);
  fill_view(0.0F, input, view);
  return pick_area(options, input, view, mask);
}

}  // namespace

void check_brush(const FilterAreaOptions& options, const FieldReader& reader) {
  if (options.area == FilterArea::Brush && !(options.brush > 0.0F)) {
    reader.required("brush").fail("a number above 0 for the area \"brush\"");
  }
}

void check_area(const FilterAreaOptions& options, const std::vector<UnitStroke>& strokes,
                const std::string& path) {
  if (options.area == FilterArea::View) {
    if (!strokes.empty()) {
      throw InvalidInput(path +
                         " must be left out for the area \"view\"; all other areas take strokes");
    }
    return;
  }
  if (strokes.empty()) {
    throw InvalidInput(path + " must have at least one list of points [x, y] for the area \"" +
                       std::string(name_of(options.area)) + "\"");
  }
  for (std::size_t i = 0; i < strokes.size(); ++i) {
    if (options.area == FilterArea::Inside && strokes[i].size() < 3) {
      throw InvalidInput(path + "[" + std::to_string(i) +
                         "] must have at least 3 points to enclose an area");
    }
  }
}

StrokeUse area_stroke_use(const FilterAreaOptions& options) {
  if (options.area == FilterArea::Alike) return StrokeUse::Points;
  return options.area == FilterArea::Inside ? StrokeUse::Inside : StrokeUse::Path;
}

Extent area_extent(const FilterAreaOptions& options, const std::vector<UnitStroke>& strokes) {
  if (options.area == FilterArea::View || picks(options.area)) return {};
  if (options.area == FilterArea::Brush) {
    return smooth_extent_of(strokes, 0.5F * options.brush, StrokeEnds::Open);
  }
  const Extent box = extent_of(strokes, 0.0F);
  const float feather =
      options.feather > 0.0F ? options.feather : feather_share * (box.high - box.low).minCoeff();
  return extent_of(strokes, 0.5F * feather);
}

Rect area_mask(const FilterAreaOptions& options, const OperatorInput& input, MaskSpan mask) {
  if (options.area == FilterArea::Brush) return fill_brush(options, input, mask);
  if (options.area == FilterArea::Inside) {
    const float feather =
        options.feather > 0.0F ? options.feather : feather_share * size_of(input.strokes);
    return fill_inside(input.strokes, feather, input.region, mask);
  }
  if (picks(options.area)) return fill_picked(options, input, mask);
  return fill_view(options.feather, input, mask);
}

void subtract(SlopeView source, SlopeSpan target, Rect region) {
  for_pixels(region, [&](int x, int y) { target(x, y) -= source(x, y); });
}

void keep_masked_change(SlopeView source, MaskView mask, SlopeSpan filtered_to_change,
                        Rect region) {
  for_pixels(region, [&](int x, int y) {
    Vec2f& v = filtered_to_change(x, y);
    v = mask(x, y) * (v - source(x, y));
  });
}

}  // namespace normalshop
