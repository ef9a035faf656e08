#include "normalshop/document/operators/area_operator.h"
#include "normalshop/document/operators/operators.h"
#include "normalshop/rgbn/vector_tools.h"

namespace normalshop {

namespace {

struct PaintEditOptions {
  float azimuth = 0.0F;
  float tilt = 0.0F;

  static constexpr auto fields() {
    using Own = PaintEditOptions;
    return std::tuple{
        field<Own, float>("azimuth", &Own::azimuth, "degrees", -360.0, 360.0,
                          "Where normals are turned to: 0 right, 90 up"),
        field<Own, float>("tilt", &Own::tilt, "degrees", 0.0, 88.0,
                          "Angle from the viewing direction, or, in the mode \"base\", from the "
                          "base surface's normal; 0 faces the viewer")};
  }
};

struct PaintTool {
  using Options = PaintEditOptions;
  static constexpr bool is_local = true;
  static constexpr std::string_view name = "paint";
  static constexpr std::string_view summary = "Turns normals towards one direction";
  static void apply(const OperatorInput& input, MaskView mask, SlopeSpan target, Rect region,
                    const Options& options) {
    PaintDirectionOptions direction;
    direction.azimuth = options.azimuth;
    direction.tilt = options.tilt;
    paint_direction(input.source, mask, target, region, direction);
  }
};

}  // namespace

OperatorType paint_operator() { return area_type<PaintTool>(); }

}  // namespace normalshop
