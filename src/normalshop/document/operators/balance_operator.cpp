#include "normalshop/document/operators/area_operator.h"
#include "normalshop/document/operators/operators.h"
#include "normalshop/rgbn/vector_tools.h"

namespace normalshop {

namespace {

struct NoOptions {
  static constexpr auto fields() { return std::tuple{}; }
};

struct BalanceTool {
  using Options = NoOptions;
  static constexpr bool is_local = false;
  static constexpr std::string_view name = "balance";
  static constexpr std::string_view summary =
      "Takes the mean slope away, so that the area is level as a whole";
  static void apply(const OperatorInput& input, MaskView mask, SlopeSpan target, Rect region,
                    const Options&) {
    balance_mean(input.source, mask, target, region);
  }
};

}  // namespace

OperatorType balance_operator() { return area_type<BalanceTool>(); }

}  // namespace normalshop
