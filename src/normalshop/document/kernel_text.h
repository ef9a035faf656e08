#pragma once

#include <string_view>

#include "normalshop/core/image.h"

namespace normalshop {

/// A kernel as JSON: a list of rows, each a list of numbers from -1000000 to 1000000, the upper row
/// first: [[0, 1, 0], [1, 1, 1], [0, 1, 0]]. Sides are odd, at most 255. Throws InvalidInput that
/// names `file` and the row, counted from 1.
Image<float> parse_kernel(std::string_view json, std::string_view file);

}  // namespace normalshop
