#pragma once

#include <limits>

namespace normalshop::test {

inline constexpr float nan = std::numeric_limits<float>::quiet_NaN();

}  // namespace normalshop::test
