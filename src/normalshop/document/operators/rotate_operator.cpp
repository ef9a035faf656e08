#include "normalshop/document/operators/area_operator.h"
#include "normalshop/document/operators/operators.h"
#include "normalshop/rgbn/vector_tools.h"

namespace normalshop {

namespace {

struct RotateTool {
  using Options = RotateNormalsOptions;
  static constexpr bool is_local = true;
  static constexpr std::string_view name = "rotate";
  static constexpr std::string_view summary = "Turns normals about an axis";
  static void apply(const OperatorInput& input, MaskView mask, SlopeSpan target, Rect region,
                    const Options& options) {
    rotate_normals(input.source, mask, target, region, options);
  }
};

}  // namespace

OperatorType rotate_operator() { return area_type<RotateTool>(); }

}  // namespace normalshop
