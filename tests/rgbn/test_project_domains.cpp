#include <cmath>
#include <vector>

#include "support/slope_fields.h"
#include <gtest/gtest.h>

#include "normalshop/core/error.h"
#include "normalshop/rgbn/curl.h"
#include "normalshop/rgbn/project.h"

namespace normalshop::test {
namespace {

TEST(Project, WhatTilesKeepsTiling) {
  for (const int size : {96, 75}) {  // odd sizes take another way
    const SlopeImage image = noise_image(size, size);
    const SlopeImage out = projected(image, {}, {.border = Border::Wrap});
    MaskImage curls(size, size);
    curl(out, {}, curls, curls.rect(), {.border = Border::Wrap});
    for (int i = 0; i < size; ++i) {
      EXPECT_NEAR(curls(size - 1, i), 0.0F, 1e-6F);
      EXPECT_NEAR(curls(i, size - 1), 0.0F, 1e-6F);
    }
    // Another cut through the same tiling gives the same slopes.
    SlopeImage moved(size, size);
    SlopeImage moved_out(size, size);
    const auto move = [&](const SlopeImage& from, SlopeImage& to) {
      for (int y = 0; y < size; ++y) {
        for (int x = 0; x < size; ++x) to(x, y) = from((x + 31) % size, (y + 50) % size);
      }
    };
    move(image, moved);
    move(out, moved_out);
    EXPECT_LT(largest_difference(projected(moved, {}, {.border = Border::Wrap}), moved_out), 3e-6);
  }
}

TEST(Project, ATiltedTileStaysTilted) {
  SlopeImage image(64, 48);
  const double turn = 2.0 * 3.14159265358979;
  const SlopeImage wave = slopes_of(64, 48, [&](int x, int y) {
    return 3.0 * std::sin(turn * x / 64) + std::cos(turn * y / 24);
  });
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x < 64; ++x) image(x, y) = wave(x, y) + Vec2f(0.5F, -0.25F);
  }
  MaskImage strip(64, 48, 1.0F);
  for (int x = 0; x < 64; ++x) strip(x, 20) = 0.0F;  // still connected across
  for (const MaskImage& mask : {MaskImage(), strip}) {
    SlopeImage out(64, 48);
    MaskImage height(64, 48);
    const Projection done = project_to_integrable(image, mask, {.slopes = out, .height = height},
                                                  out.rect(), {.border = Border::Wrap});
    EXPECT_LT(largest_difference(image, out, mask), 2e-6);
    EXPECT_LT(done.removed_share, 1e-12);
    // The tilt is not in the height.
    EXPECT_NEAR(height(63, 5) - height(0, 5), wave(63, 5).x() * -1.0F, 0.05F);
  }
}

TEST(Project, PartsAreSolvedEachByItself) {
  const SlopeImage image = noise_image(90, 60);
  MaskImage left(90, 60, 0.0F);
  MaskImage right(90, 60, 0.0F);
  MaskImage both(90, 60, 0.0F);
  for (int y = 5; y < 55; ++y) {
    for (int x = 3; x < 40; ++x) left(x, y) = both(x, y) = 1.0F;
    for (int x = 41; x < 88; ++x) right(x, y) = both(x, y) = 1.0F;
  }
  SlopeImage out(90, 60);
  MaskImage height(90, 60);
  project_to_integrable(image, both, {.slopes = out, .height = height}, out.rect());
  EXPECT_LT(largest_difference(out, projected(image, left), left), 3e-6);
  EXPECT_LT(largest_difference(out, projected(image, right), right), 3e-6);
  for (const MaskImage* part : {&left, &right}) {
    double sum = 0.0;
    for (int y = 0; y < 60; ++y) {
      for (int x = 0; x < 90; ++x) {
        if ((*part)(x, y) > 0.0F) sum += static_cast<double>(height(x, y));
      }
    }
    EXPECT_NEAR(sum, 0.0, 1e-3);
  }
}

TEST(Project, HeightsReturnToThemselvesAroundAHole) {
  constexpr int size = 100;
  SlopeImage image(size, size, Vec2f::Zero());
  MaskImage ring(size, size);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const double u = x - 50.0;
      const double v = 50.0 - y;
      const double r = std::hypot(u, v);
      ring(x, y) = r > 15.0 && r < 45.0 ? 1.0F : 0.0F;
      if (r > 0.0) image(x, y) = Vec2d(-v / (r * r), u / (r * r)).cast<float>();
    }
  }
  const std::vector<Vec2f> around = {
      {25.0F, 25.0F}, {25.0F, 75.0F}, {75.0F, 75.0F}, {75.0F, 25.0F}, {25.0F, 25.0F}};
  EXPECT_LT(curl_share_of_derivatives(image, ring), 1e-4);
  EXPECT_GT(curl_share(image, ring), 0.98);
  EXPECT_NEAR(level_change(image, around), 2.0 * 3.14159265, 1e-3);
  EXPECT_NEAR(level_change(projected(image, ring), around), 0.0, 1e-4);
}

TEST(Project, ZeroEndsContinueWithZero) {
  const SlopeImage image = noise_image(110, 110);
  const MaskImage mask = disc(110);
  SlopeImage out(110, 110);
  project_to_integrable(image, mask, {.slopes = out}, out.rect(), {.ends = HeightEnds::Zero});
  for (int y = 0; y < 110; ++y) {
    for (int x = 0; x < 110; ++x) {
      if (mask(x, y) == 0.0F) out(x, y) = Vec2f::Zero();
    }
  }
  EXPECT_LT(curl_share(out, {}), 1e-12);  // a height of the whole image now
}

TEST(Project, FadeBringsSlopesToZeroAtTheEnds) {
  const SlopeImage image = noise_image(140, 140);
  const MaskImage mask = disc(140);
  const SlopeImage plain = projected(image, mask, {.ends = HeightEnds::Zero});
  SlopeImage faded = projected(image, mask, {.fade = 20.0F});
  double plain_rim = 0.0;
  double faded_rim = 0.0;
  for (int y = 0; y < 140; ++y) {
    for (int x = 0; x < 140; ++x) {
      const double to_end = 0.48 * 140 - std::hypot(x - 69.5, y - 69.5);
      const Vec2f difference = faded(x, y) - plain(x, y);
      if (to_end > 23.0) {
        EXPECT_LT(difference.norm(), 1e-6F);
      }
      if (to_end > 0.0 && to_end < 2.0) {
        plain_rim = std::max(plain_rim, static_cast<double>(plain(x, y).norm()));
        faded_rim = std::max(faded_rim, static_cast<double>(faded(x, y).norm()));
      }
      if (mask(x, y) == 0.0F) faded(x, y) = Vec2f::Zero();
    }
  }
  EXPECT_GT(plain_rim, 0.2);
  EXPECT_LT(faded_rim, 0.05 * plain_rim);
  EXPECT_LT(curl_share(faded, {}), 1e-12);
  // Without ends there is nothing to fade.
  const SlopeImage tile = projected(image, {}, {.border = Border::Wrap});
  EXPECT_TRUE(same(tile, projected(image, {}, {.border = Border::Wrap, .fade = 20.0F})));
}

TEST(Project, FadeKnowsThatTilesRepeat) {
  const SlopeImage image = noise_image(64, 64);
  MaskImage mask(64, 64, 1.0F);
  mask(0, 0) = 0.0F;
  const ProjectOptions plain = {.border = Border::Wrap, .ends = HeightEnds::Zero};
  const SlopeImage before = projected(image, mask, plain);
  const SlopeImage after = projected(image, mask, {.border = Border::Wrap, .fade = 10.0F});
  EXPECT_LT(after(63, 63).norm(), 0.1F * before(63, 63).norm());
  EXPECT_LT((after(40, 40) - before(40, 40)).norm(), 1e-6F);
}

TEST(Project, PixelsThatDoNotCountStay) {
  SlopeImage image = slopes_of(60, 50, hills);
  MaskImage valid(60, 50, 1.0F);
  image(10, 10) = {nan, 1.0F};
  image(30, 20) = {std::numeric_limits<float>::infinity(), 0.0F};
  valid(20, 40) = 0.0F;
  image(20, 40) = {100.0F, 100.0F};
  valid(21, 40) = nan;
  image(21, 40) = {-5.0F, 7.0F};
  SlopeImage out(60, 50);
  MaskImage height(60, 50);
  project_to_integrable(image, valid, {.slopes = out, .height = height}, out.rect());
  for (int y = 0; y < 50; ++y) {
    for (int x = 0; x < 60; ++x) {
      const bool counts =
          (x != 10 || y != 10) && (x != 30 || y != 20) && ((x != 20 && x != 21) || y != 40);
      EXPECT_EQ(std::isfinite(height(x, y)), counts);
      if (counts) {
        EXPECT_LT((out(x, y) - image(x, y)).norm(), 2e-6F);
      }
    }
  }
  EXPECT_TRUE(std::isnan(out(10, 10).x()));
  EXPECT_EQ(out(10, 10).y(), 1.0F);
  EXPECT_EQ(out(20, 40), image(20, 40));
  EXPECT_EQ(out(21, 40), image(21, 40));
}

TEST(Project, ARegionIsSolvedAlone) {
  const SlopeImage image = noise_image(80, 70);
  const Rect region = {13, 9, 61, 48};
  SlopeImage out(80, 70, Vec2f::Constant(9.0F));
  EXPECT_EQ(project_to_integrable(image, {}, {.slopes = out}, region).written, region);
  MaskImage inside(80, 70, 0.0F);
  for (int y = 0; y < 70; ++y) {
    for (int x = 0; x < 80; ++x) {
      if (region.contains(x, y)) {
        inside(x, y) = 1.0F;
      } else {
        EXPECT_EQ(out(x, y), Vec2f(9.0F, 9.0F));
      }
    }
  }
  EXPECT_LT(largest_difference(out, projected(image, inside), inside), 3e-6);
  EXPECT_THROW(project_to_integrable(image, {}, {.slopes = out}, region, {.border = Border::Wrap}),
               InvalidInput);
}

}  // namespace
}  // namespace normalshop::test
