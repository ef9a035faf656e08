#include <vector>

#include "support/tile.h"
#include <gtest/gtest.h>

#include "normalshop/core/for_pixels.h"
#include "normalshop/core/random.h"
#include "normalshop/rgbn/mask.h"
#include "normalshop/rgbn/segment.h"
#include "normalshop/rgbn/selection.h"

/// In a tile, segments and what the wand selects know no sides.
namespace normalshop::test {
namespace {

constexpr int tile_width = 60;
constexpr int tile_height = 44;

/// Slopes of a disc that stands out from noisy ground, its middle there; it goes on beyond the
/// sides.
SlopeImage tile_with_disc(int column, int row) {
  SlopeImage slopes(tile_width, tile_height);
  for (int y = 0; y < tile_height; ++y) {
    for (int x = 0; x < tile_width; ++x) {
      const Vec2i way = way_in_tile({column, row}, {x, y}, tile_width, tile_height);
      const int u = way.x();
      const int v = way.y();
      const auto noise = [&](std::uint32_t seed) {
        const auto a = static_cast<std::uint32_t>(u + tile_width);
        const auto b = static_cast<std::uint32_t>(v + tile_height);
        return 0.02F * (static_cast<float>(hash(a, b, seed) >> 8U) * 0x1p-24F - 0.5F);
      };
      slopes(x, y) = Vec2f(u * u + v * v < 144 ? 0.8F : 0.0F, 0.0F) + Vec2f(noise(1), noise(2));
    }
  }
  return slopes;
}

int pixels_of(const Image<std::uint32_t>& labels, std::uint32_t label) {
  int count = 0;
  for (std::size_t i = 0; i < labels.size(); ++i) count += labels.data()[i] == label ? 1 : 0;
  return count;
}

TEST(WrappedSegments, GoOnBeyondTheSides) {
  const SegmentOptions options{.coarseness = 2.0F, .min_size = 20, .sigma = 0.0F};
  const SlopeImage middle = tile_with_disc(30, 22);
  const SlopeImage corner = tile_with_disc(1, 42);
  const Segments whole = segment({middle, {}, {}}, options, Border::Wrap);
  const Segments wrapped = segment({corner, {}, {}}, options, Border::Wrap);
  EXPECT_EQ(whole.count, 2U);
  ASSERT_EQ(wrapped.count, 2U);
  EXPECT_EQ(pixels_of(wrapped.labels, wrapped.labels(1, 42)),
            pixels_of(whole.labels, whole.labels(30, 22)));
  EXPECT_EQ(wrapped.labels(1, 42), wrapped.labels(58, 42));
  EXPECT_EQ(wrapped.labels(1, 42), wrapped.labels(1, 2));
  // Where the sides are ends, they cut the disc into four.
  EXPECT_EQ(segment({corner, {}, {}}, options).count, 5U);
}

TEST(WrappedSegments, AGraphGivesTheSame) {
  const SlopeImage corner = tile_with_disc(1, 42);
  const SegmentOptions options{.coarseness = 0.2F, .min_size = 5};
  const SegmentGraph graph({corner, {}, {}}, options, Border::Wrap);
  for (const float coarseness : {0.001F, 0.05F, 0.2F, 3.0F}) {
    SegmentOptions once = options;
    once.coarseness = coarseness;
    const Segments expected = segment({corner, {}, {}}, once, Border::Wrap);
    const Segments found = graph.segment(coarseness, 5);
    ASSERT_EQ(found.count, expected.count) << coarseness;
    for (std::size_t i = 0; i < found.labels.size(); ++i) {
      ASSERT_EQ(found.labels.data()[i], expected.labels.data()[i]) << coarseness;
    }
  }
}

TEST(WrappedSegments, TilesOfOnePixel) {
  for (const auto& [w, h] : std::vector<std::pair<int, int>>{{1, 1}, {1, 9}, {9, 1}, {2, 2}}) {
    const SlopeImage flat(w, h, Vec2f(0.1F, 0.2F));
    EXPECT_EQ(segment({flat, {}, {}}, {.min_size = 0}, Border::Wrap).count, 1U) << w << " " << h;
  }
}

TEST(WrappedWand, GoesOnBeyondTheSides) {
  const SlopeImage corner = tile_with_disc(1, 42);
  MaskImage mask(tile_width, tile_height);
  const auto select = [&](Border border) {
    select_alike({corner, {}, {}}, {1, 42}, mask, {.angle_tolerance = 5.0F}, border);
    float sum = 0.0F;
    for (std::size_t i = 0; i < mask.size(); ++i) sum += mask.data()[i];
    return sum;
  };
  const float all = select(Border::Wrap);
  EXPECT_EQ(mask(59, 1), 1.0F);
  EXPECT_EQ(mask(30, 20), 0.0F);
  const SlopeImage middle = tile_with_disc(30, 22);
  MaskImage expected(tile_width, tile_height);
  select_alike({middle, {}, {}}, {30, 22}, expected, {.angle_tolerance = 5.0F});
  float sum = 0.0F;
  for (std::size_t i = 0; i < expected.size(); ++i) sum += expected.data()[i];
  EXPECT_EQ(all, sum);
  EXPECT_LT(select(Border::Clamp), 0.5F * all);
}

TEST(WrappedMasks, GrowAndFeatherBeyondTheSides) {
  const auto disc_mask = [](int column, int row) {
    const SlopeImage slopes = tile_with_disc(column, row);
    MaskImage mask(tile_width, tile_height);
    for_pixels(mask.rect(),
               [&](int x, int y) { mask(x, y) = slopes(x, y).x() > 0.4F ? 1.0F : 0.0F; });
    return mask;
  };
  const MaskImage corner = disc_mask(0, 0);
  const MaskImage middle = disc_mask(30, 22);
  const auto expect_turned = [&](const auto& change, const char* what) {
    MaskImage a(tile_width, tile_height);
    MaskImage b(tile_width, tile_height);
    change(corner, a);
    change(middle, b);
    for (int y = 0; y < tile_height; ++y) {
      for (int x = 0; x < tile_width; ++x) {
        ASSERT_EQ(a(x, y), b((x + 30) % tile_width, (y + 22) % tile_height)) << what;
      }
    }
  };
  for (const float distance : {3.0F, -3.0F, 40.0F}) {
    expect_turned(
        [&](const MaskImage& mask, MaskImage& out) {
          grow_mask(mask, out, out.rect(), {distance}, Border::Wrap);
        },
        "grown");
  }
  for (const float feather : {5.0F, 90.0F}) {
    expect_turned(
        [&](const MaskImage& mask, MaskImage& out) {
          feather_mask(mask, out, out.rect(), {feather}, Border::Wrap);
        },
        "feathered");
  }
}

}  // namespace
}  // namespace normalshop::test
