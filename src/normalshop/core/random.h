#pragma once

#include <cstdint>

namespace normalshop {

/// PCG32 (O'Neill 2014): small, seeded, the same sequence on every machine.
class Random {
 public:
  explicit Random(std::uint64_t seed, std::uint64_t sequence = 0);
  std::uint32_t next();
  /// Uniform in [0, 1).
  float uniform() { return static_cast<float>(next() >> 8) * 0x1p-24f; }
  float uniform(float low, float high) { return low + (high - low) * uniform(); }

 private:
  std::uint64_t state_;
  std::uint64_t increment_;
};

/// Well-mixed 32 bits of a lattice point: noise that needs no order of visits.
std::uint32_t hash(std::uint32_t x, std::uint32_t y, std::uint32_t seed);

}  // namespace normalshop
