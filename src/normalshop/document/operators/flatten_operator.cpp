#include "normalshop/document/operators/area_operator.h"
#include "normalshop/document/operators/operators.h"
#include "normalshop/rgbn/vector_tools.h"

namespace normalshop {

namespace {

struct FlattenEditOptions {
  float slope_x = 0.0F;
  float slope_y = 0.0F;

  static constexpr auto fields() {
    using Own = FlattenEditOptions;
    return std::tuple{
        field<Own, float>("slope_x", &Own::slope_x, "1", -50.0, 50.0,
                          "The plane's slope to the right; 0 faces the viewer, or, in the mode "
                          "\"base\", is the base surface"),
        field<Own, float>("slope_y", &Own::slope_y, "1", -50.0, 50.0, "Its slope upwards")};
  }
};

struct FlattenTool {
  using Options = FlattenEditOptions;
  static constexpr bool is_local = true;
  static constexpr std::string_view name = "flatten";
  static constexpr std::string_view summary =
      "Brings the slopes to those of a plane, or of the base surface";
  static void apply(const OperatorInput& input, MaskView mask, SlopeSpan target, Rect region,
                    const Options& options) {
    FlattenOptions plane;
    plane.slope = {options.slope_x, options.slope_y};
    flatten(input.source, mask, target, region, plane);
  }
};

}  // namespace

OperatorType flatten_operator() { return area_type<FlattenTool>(); }

}  // namespace normalshop
