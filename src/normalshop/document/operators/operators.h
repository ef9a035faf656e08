#pragma once

#include "normalshop/document/edit_operator.h"

/// One function an operator, each in its own file; registry.cpp lists them.
namespace normalshop {

OperatorType pen_operator();
OperatorType trim_operator();
OperatorType stamp_operator();
OperatorType text_operator();
OperatorType combine_operator();
OperatorType transplant_operator();
OperatorType smooth_operator();
OperatorType sharpen_operator();
OperatorType filter_operator();
OperatorType denoise_operator();
OperatorType equalize_operator();
OperatorType convolve_operator();
OperatorType flatten_operator();
OperatorType paint_operator();
OperatorType rotate_operator();
OperatorType balance_operator();
OperatorType project_operator();
OperatorType warp_operator();

}  // namespace normalshop
