#pragma once

#include <string>

#include "normalshop/core/error.h"

namespace normalshop {

/// Runs `job`; says which file an error is about, where the error could not.
template <class F>
auto naming(const std::string& file, const F& job) {
  try {
    return job();
  } catch (const InvalidInput& error) {
    throw InvalidInput("'" + file + "': " + error.what());
  }
}

}  // namespace normalshop
