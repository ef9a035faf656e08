#include "normalshop/core/random.h"

namespace normalshop {

Random::Random(std::uint64_t seed, std::uint64_t sequence)
    : state_(0), increment_((sequence << 1U) | 1U) {
  next();
  state_ += seed;
  next();
}

std::uint32_t Random::next() {
  const std::uint64_t old = state_;
  state_ = old * 6364136223846793005ULL + increment_;
  const auto shifted = static_cast<std::uint32_t>(((old >> 18U) ^ old) >> 27U);
  const auto rotation = static_cast<std::uint32_t>(old >> 59U);
  return (shifted >> rotation) | (shifted << ((32U - rotation) & 31U));
}

std::uint32_t hash(std::uint32_t x, std::uint32_t y, std::uint32_t seed) {
  std::uint32_t h = seed ^ (x * 0x9E3779B1U);
  h = (h ^ (h >> 15U)) * 0x85EBCA77U;
  h ^= y * 0xC2B2AE3DU;
  h = (h ^ (h >> 13U)) * 0x27D4EB2FU;
  h ^= h >> 16U;
  return h * 0x165667B1U ^ (h >> 15U);
}

}  // namespace normalshop
