#pragma once

#include <algorithm>
#include <cstddef>

#include "normalshop/chart/push.h"
#include "normalshop/chart/texel_writes.h"

/// What pushes count, private to floor 4.
namespace normalshop {

/// Sums that do not depend on the order of tasks.
struct PushTally {
  std::size_t visited = 0;
  std::size_t changed = 0;
  std::size_t shared = 0;  // of the changed
  float largest = 0.0F;    // 1 - cos of the angle

  void add(const PushTally& other) {
    visited += other.visited;
    changed += other.changed;
    shared += other.shared;
    largest = std::max(largest, other.largest);
  }
};

inline PushResult result_of(const PushTally& tally) {
  return {tally.visited, tally.changed, tally.shared, degrees_of_turn(tally.largest)};
}

}  // namespace normalshop
