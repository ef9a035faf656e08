#pragma once

#include <array>
#include <string_view>
#include <tuple>

#include "normalshop/core/options.h"
#include "normalshop/document/edit_operator.h"

namespace normalshop {

/// Where an edit without a place of its own works.
enum class FilterArea {
  View,      ///< the whole view
  Brush,     ///< along the strokes
  Inside,    ///< inside the strokes, each closed
  Segments,  ///< the segments that the strokes touch
  Alike,     ///< what hangs together with a point of the strokes and looks like it
};
constexpr auto names_of(FilterArea) {
  return std::array<std::string_view, 5>{"view", "brush", "inside", "segments", "alike"};
}

/// Options that every such edit has.
struct FilterAreaOptions {
  FilterArea area = FilterArea::View;
  float brush = 0.0F;
  float hardness = 0.5F;
  float feather = 0.0F;
  float coarseness = 1.0F;
  float color_weight = 1.0F;
  float color_tolerance = 0.1F;
  float angle_tolerance = 15.0F;
};

template <class Owner>
constexpr auto filter_area_fields() {
  return std::tuple{
      field<Owner, FilterArea>(
          "area", &Owner::area,
          "The whole view, along the strokes, inside them, the segments of like "
          "colour and normal that they touch, or what hangs together with one "
          "of their points and is like it"),
      field<Owner, float>(
          "brush", &Owner::brush, "length", 0.0, 1e6,
          "Width of the brush that follows the strokes; above 0 for the area \"brush\""),
      field<Owner, float>("hardness", &Owner::hardness, "1", 0.0, 0.99,
                          "Part of the brush's width at full strength; 0 is softest"),
      field<Owner, float>(
          "feather", &Owner::feather, "length", 0.0, 1e6,
          "Width over which the edit fades in at the border, for \"view\" where the model goes on "
          "beyond it; 0: 4 % of the smaller side of \"inside\" and \"view\". Of \"segments\" and "
          "\"alike\" from 2 pixels to a quarter of the view; holes of half that width close. None "
          "for \"brush\""),
      field<Owner, float>(
          "coarseness", &Owner::coarseness, "1", 0.0, 1e6,
          "Of \"segments\": larger values give fewer, larger ones; none has less than "
          "50 of the chart's pixels"),
      field<Owner, float>("color_weight", &Owner::color_weight, "1", 0.0, 1e6,
                          "Of \"segments\": how much colours count beside normals; 0: not at all"),
      field<Owner, float>("color_tolerance", &Owner::color_tolerance, "1", 0.0, 1e6,
                          "Of \"alike\": largest distance between linear colours; 0: equal ones, "
                          "1e6: all"),
      field<Owner, float>("angle_tolerance", &Owner::angle_tolerance, "degrees", 0.0, 180.0,
                          "Of \"alike\": largest angle between normals; 0: equal ones, 180: all")};
}

/// What the strokes of such an edit mean.
inline constexpr std::string_view area_strokes = "Where it works, for all areas but \"view\"";

/// Do the strokes pick the area in what is there?
constexpr bool picks(FilterArea area) {
  return area == FilterArea::Segments || area == FilterArea::Alike;
}
/// Throws InvalidInput for a brush without width.
void check_brush(const FilterAreaOptions& options, const FieldReader& reader);
/// Throws InvalidInput when strokes and area don't fit.
void check_area(const FilterAreaOptions& options, const std::vector<UnitStroke>& strokes,
                const std::string& path);
StrokeUse area_stroke_use(const FilterAreaOptions& options);
Extent area_extent(const FilterAreaOptions& options, const std::vector<UnitStroke>& strokes);
/// The edit's strength per pixel, 0 to 1 (lengths in pixels). Returns where it is not 0. `mask` is
/// 0 before.
Rect area_mask(const FilterAreaOptions& options, const OperatorInput& input, MaskSpan mask);

/// target -= source in `region`.
void subtract(SlopeView source, SlopeSpan target, Rect region);
/// change = mask * (filtered - source) in `region`.
void keep_masked_change(SlopeView source, MaskView mask, SlopeSpan filtered_to_change, Rect region);

}  // namespace normalshop
