#include "normalshop/document/edit_operator.h"
#include "normalshop/document/operators/operators.h"

namespace normalshop {

const std::vector<OperatorType>& operator_types() {
  static const std::vector<OperatorType> types{
      pen_operator(),     trim_operator(),     stamp_operator(),    text_operator(),
      combine_operator(), smooth_operator(),   sharpen_operator(),  filter_operator(),
      denoise_operator(), convolve_operator(), equalize_operator(), transplant_operator(),
      flatten_operator(), paint_operator(),    rotate_operator(),   balance_operator(),
      project_operator(), warp_operator()};
  return types;
}

Value describe_operators() {
  Value::Array out;
  for (const OperatorType& type : operator_types()) {
    out.push_back(Value::Object{{"operator", type.name},
                                {"summary", type.summary},
                                {"strokes", type.strokes},
                                {"options", type.fields()}});
  }
  return out;
}

}  // namespace normalshop
