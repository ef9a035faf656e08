#pragma once

#include <cmath>
#include <cstdio>
#include <string>
#include <string_view>
#include <type_traits>

#include "normalshop/core/error.h"
#include "normalshop/core/options.h"

namespace normalshop {

/// Throws InvalidInput, naming the field and its range, for the first number among the options that
/// is not finite or out of its range.
template <class Options>
void check_options(std::string_view name, const Options& options) {
  for_each_field<Options>([&](const auto& f) {
    using T = std::remove_cvref_t<decltype(options.*f.member)>;
    if constexpr (std::is_same_v<T, float> || std::is_same_v<T, int>) {
      const auto value = static_cast<double>(options.*f.member);
      const bool limited = f.min < f.max;
      if (std::isfinite(value) && (!limited || (value >= f.min && value <= f.max))) return;
      char range[64] = "";
      if (limited) std::snprintf(range, sizeof range, " from %g to %g", f.min, f.max);
      throw InvalidInput(std::string(name) + ": " + std::string(f.name) + " must be a number" +
                         range);
    }
  });
}

}  // namespace normalshop
