#include <set>

#include <gtest/gtest.h>

#include "normalshop/core/random.h"

namespace normalshop {
namespace {

TEST(Random, IsThePcgOfTheReference) {
  // First outputs of pcg32-demo with seed 42 and sequence 54 (O'Neill's reference program).
  Random random(42, 54);
  for (const std::uint32_t expected :
       {0xa15c02b7U, 0x7b47f409U, 0xba1d3330U, 0x83d2f293U, 0xbfa4784bU, 0xcbed606eU}) {
    EXPECT_EQ(random.next(), expected);
  }
}

TEST(Random, UniformStaysInItsRange) {
  Random random(1);
  double sum = 0.0;
  for (int i = 0; i < 100000; ++i) {
    const float x = random.uniform(-2.0F, 6.0F);
    ASSERT_GE(x, -2.0F);
    ASSERT_LE(x, 6.0F);
    sum += x;
  }
  EXPECT_NEAR(sum / 100000.0, 2.0, 0.03);
}

TEST(Hash, SeparatesNeighbours) {
  std::set<std::uint32_t> values;
  for (std::uint32_t y = 0; y < 100; ++y) {
    for (std::uint32_t x = 0; x < 100; ++x) values.insert(hash(x, y, 3));
  }
  EXPECT_GE(values.size(), 9999U);
  EXPECT_EQ(hash(5, 9, 3), hash(5, 9, 3));
  EXPECT_NE(hash(5, 9, 3), hash(5, 9, 4));
  EXPECT_NE(hash(5, 9, 3), hash(9, 5, 3));
}

TEST(Hash, BitsAreBalanced) {
  for (unsigned bit = 0; bit < 32; ++bit) {
    int ones = 0;
    for (std::uint32_t i = 0; i < 10000; ++i) {
      ones += static_cast<int>((hash(i % 100, i / 100, 1) >> bit) & 1U);
    }
    EXPECT_NEAR(ones, 5000, 300) << "bit " << bit;
  }
}

}  // namespace
}  // namespace normalshop
