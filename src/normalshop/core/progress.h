#pragma once

#include <functional>
#include <string_view>

#include "normalshop/core/error.h"

namespace normalshop {

/// Where long work says how far it is. `report` returns false to cancel. Empty: silent.
struct Progress {
  std::function<bool(double fraction, std::string_view stage)> report;

  /// Throws Cancelled when the receiver asks for it.
  void at(double fraction, std::string_view stage) const {
    if (report && !report(fraction, stage)) throw Cancelled();
  }
};

}  // namespace normalshop
