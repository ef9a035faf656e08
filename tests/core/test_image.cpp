#include <cstdint>
#include <utility>

#include <gtest/gtest.h>

#include "normalshop/core/image.h"
#include "normalshop/core/raw_image.h"
#include "normalshop/core/rect.h"

namespace normalshop {
namespace {

TEST(Image, CopiesItsPixels) {
  Image<int> a(3, 2, 7);
  Image<int> b = a;
  b(2, 1) = 9;
  EXPECT_EQ(a(2, 1), 7);
  EXPECT_EQ(b(2, 1), 9);
  EXPECT_EQ(b(0, 0), 7);
  a = b;
  EXPECT_EQ(a(2, 1), 9);
  EXPECT_NE(a.data(), b.data());
}

TEST(Image, MovesWithoutCopying) {
  Image<int> a(3, 2, 7);
  const int* pixels = a.data();
  Image<int> b = std::move(a);
  EXPECT_EQ(b.data(), pixels);
  Image<int> c;
  c = std::move(b);
  EXPECT_EQ(c.data(), pixels);
  EXPECT_EQ(c(1, 1), 7);
}

TEST(Image, CopiesAnEmptyOne) {
  const Image<int> none;
  const Image<int> copy = none;
  EXPECT_TRUE(copy.empty());
  EXPECT_TRUE(Image<int>(0, 5).empty());
}

TEST(Image, KeepsItsMemoryWhenItShrinks) {
  Image<int> a(10, 10);
  const int* pixels = a.data();
  a.resize(5, 20);
  EXPECT_EQ(a.data(), pixels);
  EXPECT_EQ(a.height(), 20);
}

TEST(Image, IsAlignedForVectors) {
  const Image<float> a(5, 5);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(a.data()) % 64, 0U);
}

TEST(RawImage, GivesCodesOfEachType) {
  RawImage bytes(2, 1, 3, CodeType::U8);
  bytes.row<std::uint8_t>(0)[5] = 200;
  EXPECT_EQ(bytes.code(1, 0, 2), 200.0F);
  RawImage words(1, 2, 4, CodeType::U16);
  words.row<std::uint16_t>(1)[3] = 65535;
  EXPECT_EQ(words.code(0, 1, 3), 65535.0F);
  EXPECT_EQ(words.row_bytes(), 8U);
  EXPECT_EQ(words.size_bytes(), 16U);
}

TEST(Rect, IntersectsUnitesAndGrows) {
  const Rect a{0, 0, 10, 5};
  const Rect b{5, 2, 20, 20};
  EXPECT_EQ(intersect(a, b), (Rect{5, 2, 10, 5}));
  EXPECT_EQ(unite(a, b), (Rect{0, 0, 20, 20}));
  EXPECT_EQ(unite(a, Rect{}), a);
  EXPECT_EQ(unite(Rect{}, b), b);
  EXPECT_EQ(grow(a, 2), (Rect{-2, -2, 12, 7}));
  EXPECT_TRUE(intersect(a, Rect{10, 0, 12, 5}).empty());
  EXPECT_EQ(intersect(a, Rect{30, 0, 40, 5}).width(), 0);
}

}  // namespace
}  // namespace normalshop
