#pragma once

#include <array>
#include <string_view>
#include <tuple>

#include "normalshop/core/options.h"
#include "normalshop/document/edit_operator.h"

namespace normalshop {

/// Where an edit without a place of its own works.
enum class FilterArea {
  View,    ///< the whole view
  Brush,   ///< along the strokes
  Inside,  ///< inside the strokes, each closed
};
constexpr auto names_of(FilterArea) {
  return std::array<std::string_view, 3>{"view", "brush", "inside"};
}

/// Options that every such edit has.
struct FilterAreaOptions {
  FilterArea area = FilterArea::View;
  float brush = 0.0F;
  float hardness = 0.5F;
  float feather = 0.0F;
};

template <class Owner>
constexpr auto filter_area_fields() {
  return std::tuple{
      field<Owner, FilterArea>("area", &Owner::area,
                               "The whole view, along the strokes, or inside them"),
      field<Owner, float>(
          "brush", &Owner::brush, "length", 0.0, 1e6,
          "Width of the brush that follows the strokes; above 0 for the area \"brush\""),
      field<Owner, float>("hardness", &Owner::hardness, "1", 0.0, 0.99,
                          "Part of the brush's width at full strength; 0 is softest"),
      field<Owner, float>("feather", &Owner::feather, "length", 0.0, 1e6,
                          "Width over which the edit fades in at the border of \"inside\", and of "
                          "\"view\" where the model goes on beyond it; 0: 4 % of the area's "
                          "smaller side")};
}

/// What the strokes of such an edit mean.
inline constexpr std::string_view area_strokes =
    "Where it works, for the areas \"brush\" and \"inside\"; none for \"view\"";

/// Throws InvalidInput for a brush without width.
void check_brush(const FilterAreaOptions& options, const FieldReader& reader);
/// Throws InvalidInput when strokes and area don't fit.
void check_area(const FilterAreaOptions& options, const std::vector<UnitStroke>& strokes,
                const std::string& path);
StrokeUse area_stroke_use(const FilterAreaOptions& options);
Extent area_extent(const FilterAreaOptions& options, const std::vector<UnitStroke>& strokes);
/// The edit's strength per pixel, 0 to 1 (lengths in pixels). Returns where it is not 0.
Rect area_mask(const FilterAreaOptions& options, const OperatorInput& input, MaskSpan mask);

/// target -= source in `region`.
void subtract(SlopeView source, SlopeSpan target, Rect region);
/// change = mask * (filtered - source) in `region`.
void keep_masked_change(SlopeView source, MaskView mask, SlopeSpan filtered_to_change, Rect region);

}  // namespace normalshop
