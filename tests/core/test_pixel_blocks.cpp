#include <limits>

#include <gtest/gtest.h>

#include "normalshop/core/pixel_blocks.h"

namespace normalshop::test {
namespace {

TEST(PixelBlocks, MarksTheBlocksOfARegionUntilTheNext) {
  PixelBlocks blocks(30, 20);
  blocks.reset({5, 9, 25, 40});
  EXPECT_EQ(blocks.region(), (Rect{5, 9, 25, 20}));
  EXPECT_EQ(blocks.blocks(), (Rect{0, 1, 4, 3}));
  EXPECT_EQ(blocks.pixels(0, 1), (Rect{5, 9, 8, 16}));
  blocks.mark(2, 2);
  EXPECT_TRUE(blocks.marked(2, 2));
  EXPECT_FALSE(blocks.marked(1, 2));
  blocks.mark_all();
  EXPECT_TRUE(blocks.marked(0, 1));
  EXPECT_FALSE(blocks.marked(0, 0)) << "beside the region";
  blocks.reset({0, 0, 8, 8});
  EXPECT_FALSE(blocks.marked(2, 2));
  blocks.reset({40, 40, 50, 50});
  EXPECT_TRUE(blocks.region().empty());
  blocks.mark_all();
  EXPECT_FALSE(blocks.any_near(0.0F, 0.0F, 30.0F, 20.0F, 100.0F));
}

TEST(PixelBlocks, TellsWhatLiesNearMarkedOnes) {
  PixelBlocks blocks(64, 64);
  blocks.reset({0, 0, 64, 64});
  blocks.mark(3, 3);  // pixels 24 to 31
  EXPECT_TRUE(blocks.any_near(28.0F, 28.0F, 28.0F, 28.0F, 0.0F));
  EXPECT_TRUE(blocks.any_near(21.5F, 30.0F, 21.5F, 30.0F, 3.0F));
  EXPECT_FALSE(blocks.any_near(20.0F, 30.0F, 20.0F, 30.0F, 3.0F));
  EXPECT_TRUE(blocks.any_near(34.0F, 34.0F, 34.0F, 34.0F, 3.0F));
  EXPECT_FALSE(blocks.any_near(36.0F, 30.0F, 36.0F, 30.0F, 3.0F));
  EXPECT_TRUE(blocks.any_near(0.0F, 0.0F, 60.0F, 60.0F, 0.0F));
  EXPECT_FALSE(blocks.any_near(1e30F, 1e30F, 1e30F, 1e30F, 3.0F));
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(blocks.any_near(nan, nan, nan, nan, 3.0F));
}

}  // namespace
}  // namespace normalshop::test
