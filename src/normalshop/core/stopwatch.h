#pragma once

#include <chrono>

namespace normalshop {

/// Wall-clock time from lap to lap.
class Stopwatch {
 public:
  /// Seconds since the last call, at first since it was made.
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    const double seconds = std::chrono::duration<double>(now - last_).count();
    last_ = now;
    return seconds;
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

}  // namespace normalshop
