#pragma once

#include <algorithm>
#include <cstddef>

/// What pushes count, private to floor 4.
namespace normalshop {

/// Sums that do not depend on the order of tasks.
struct PushTally {
  std::size_t visited = 0;
  std::size_t changed = 0;
  float largest = 0.0F;  // 1 - cos of the angle

  void add(const PushTally& other) {
    visited += other.visited;
    changed += other.changed;
    largest = std::max(largest, other.largest);
  }
};

}  // namespace normalshop
