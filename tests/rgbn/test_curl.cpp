#include <cmath>
#include <vector>

#include "support/slope_fields.h"
#include <gtest/gtest.h>

#include "normalshop/core/error.h"
#include "normalshop/core/parallel.h"
#include "normalshop/rgbn/curl.h"
#include "normalshop/rgbn/heatmap.h"
#include "normalshop/rgbn/pen.h"

namespace normalshop::test {
namespace {

/// (-y, x) with y up and the origin at pixel (0, 0): curl 2.
SlopeImage rotation(int width, int height) {
  SlopeImage image(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) image(x, y) = {static_cast<float>(y), static_cast<float>(x)};
  }
  return image;
}

/// Slopes of z = sin(x / 9) cos(y / 7) * 5, y up.
Vec2f wave(float x, float row) {
  const float a = x / 9.0F;
  const float b = -row / 7.0F;
  return {5.0F / 9.0F * std::cos(a) * std::cos(b), -5.0F / 7.0F * std::sin(a) * std::sin(b)};
}

SlopeImage wave_image(int width, int height) {
  SlopeImage image(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      image(x, y) = wave(static_cast<float>(x), static_cast<float>(y));
    }
  }
  return image;
}

TEST(Curl, OfARotationIsTwoAgainstTheClock) {
  const SlopeImage image = rotation(9, 7);
  MaskImage out(9, 7, 5.0F);
  EXPECT_EQ(curl(image, {}, out, {-3, 0, 99, 99}), image.rect());
  for (int y = 0; y < 7; ++y) {
    for (int x = 0; x < 9; ++x) EXPECT_EQ(out(x, y), x < 8 && y < 6 ? 2.0F : 0.0F);
  }
  EXPECT_DOUBLE_EQ(curl_share_of_derivatives(image, {}), 1.0);
}

TEST(Curl, OfASmoothSurfaceIsSmall) {
  const SlopeImage image = wave_image(80, 60);
  MaskImage out(80, 60);
  curl(image, {}, out, out.rect());
  for (int y = 0; y < 60; ++y) {
    for (int x = 0; x < 80; ++x) EXPECT_NEAR(out(x, y), 0.0F, 1e-4F);
  }
  EXPECT_LT(curl_share_of_derivatives(image, {}), 1e-5);
}

TEST(Curl, WrapsWhenTheImageRepeats) {
  SlopeImage image(4, 4, Vec2f::Zero());
  image(0, 0) = {1.0F, 0.0F};
  MaskImage out(4, 4);
  curl(image, {}, out, out.rect(), {.border = Border::Wrap});
  EXPECT_EQ(out(0, 3), 0.5F);  // the pixel is below that square
  EXPECT_EQ(out(3, 3), 0.5F);
  EXPECT_EQ(out(0, 0), -0.5F);
  EXPECT_EQ(out(3, 0), -0.5F);
}

TEST(Curl, IsNoNumberWhereAPixelDoesNotCount) {
  SlopeImage image = rotation(9, 9);
  MaskImage valid(9, 9, 1.0F);
  valid(2, 2) = 0.0F;
  image(6, 6).x() = nan;
  MaskImage out(9, 9);
  curl(image, valid, out, out.rect());
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 8; ++x) {
      const bool near_first = (x == 1 || x == 2) && (y == 1 || y == 2);
      const bool near_second = (x == 5 || x == 6) && (y == 5 || y == 6);
      EXPECT_EQ(std::isnan(out(x, y)), near_first || near_second);
    }
  }
  EXPECT_DOUBLE_EQ(curl_share_of_derivatives(image, valid), 1.0);
}

TEST(Curl, ARegionGivesThePixelsOfTheWholeOnAnyNumberOfThreads) {
  const SlopeImage image = noise_image(70, 50);
  MaskImage whole(70, 50);
  curl(image, {}, whole, whole.rect());
  MaskImage part(70, 50, 9.0F);
  const Rect region = {11, 7, 40, 33};
  const ThreadLimit limit(1);
  EXPECT_EQ(curl(image, {}, part, region), region);
  for (int y = 0; y < 50; ++y) {
    for (int x = 0; x < 70; ++x) {
      EXPECT_EQ(part(x, y), region.contains(x, y) ? whole(x, y) : 9.0F);
    }
  }
  EXPECT_TRUE(curl(image, {}, part, {5, 5, 5, 9}).empty());
}

TEST(Curl, HeatmapShowsItsSize) {
  SlopeImage image = rotation(6, 6);
  image(5, 5).y() = nan;
  ColorImage picture(6, 6);
  curl_heatmap(image, {}, 4.0F, picture);
  EXPECT_EQ(picture(1, 1), heat_color(0.5F));
  EXPECT_EQ(picture(4, 4), heat_color(nan));
  EXPECT_EQ(picture(5, 0), heat_color(0.0F));
}

TEST(CurlShare, IsHalfOfNoiseAndNothingOfASurface) {
  const SlopeImage image = noise_image(128, 128);
  EXPECT_NEAR(curl_share(image, {}), 0.5, 0.02);
  EXPECT_NEAR(curl_share_of_derivatives(image, {}), 0.5, 0.02);
  EXPECT_LT(curl_share(wave_image(128, 128), {}), 1e-5);
  EXPECT_EQ(curl_share(SlopeImage(20, 20, Vec2f(0.5F, -3.0F)), {}), 0.0);
  EXPECT_EQ(curl_share({}, {}), 0.0);
}

/// Waves that tile: a share of the rotation of one and the slopes of another.
TEST(CurlShare, TellsTheShareOfARotatingPart) {
  constexpr int size = 64;
  SlopeImage image(size, size);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const float a = 2.0F * 3.14159265F * static_cast<float>(x) / size;
      const float b = 2.0F * 3.14159265F * static_cast<float>(y) / size;
      image(x, y) = {2.0F * std::cos(2.0F * a), std::cos(a)};  // a slope wave and a shear wave
      image(x, y).x() += std::sin(b);                          // another shear
    }
  }
  // Energies 2, 1/2, 1/2.
  EXPECT_NEAR(curl_share(image, {}, {.border = Border::Wrap}), 1.0 / 3.0, 1e-5);
}

using Path = std::vector<Vec2f>;

TEST(LevelChange, OfAPlaneIsItsHeight) {
  const SlopeImage image(30, 20, Vec2f(0.5F, 2.0F));
  EXPECT_NEAR(level_change(image, Path{{2.25F, 3.5F}, {20.0F, 11.75F}, {21.0F, 1.0F}}),
              0.5 * 18.75 + 2.0 * (3.5 - 1.0), 1e-12);
  EXPECT_EQ(level_change(image, Path{{2.0F, 3.0F}}), 0.0);
  EXPECT_EQ(level_change(image, {}), 0.0);
}

// Stokes: a bilinear field is integrated exactly, whatever the path.
TEST(LevelChange, AroundARotationIsTwiceTheArea) {
  const SlopeImage image = rotation(40, 40);
  const Path triangle = {{3.3F, 30.1F}, {35.7F, 22.9F}, {17.2F, 2.4F}, {3.3F, 30.1F}};
  const double area = 0.5 * std::abs(32.4 * (2.4 - 30.1) - (17.2 - 3.3) * (22.9 - 30.1));
  EXPECT_NEAR(level_change(image, triangle), 2.0 * area, 1e-3);  // against the clock as seen
}

TEST(LevelChange, AroundASurfaceIsNothing) {
  const SlopeImage image = wave_image(100, 100);
  Path circle;
  for (int i = 0; i <= 100; ++i) {
    const float t = 6.2831853F * static_cast<float>(i % 100) / 100.0F;
    circle.emplace_back(50.0F + 33.0F * std::cos(t), 50.0F + 41.0F * std::sin(t));
  }
  EXPECT_NEAR(level_change(image, circle), 0.0, 1e-3);
  const Path line = {{10.0F, 20.0F}, {80.3F, 77.7F}};
  const auto z = [](double x, double y) { return 5.0 * std::sin(x / 9.0) * std::cos(y / 7.0); };
  EXPECT_NEAR(level_change(image, line), z(80.3, 77.7) - z(10.0, 20.0), 0.02);
}

TEST(LevelChange, SeesWhatThePenRaises) {
  Stroke ring;
  for (int i = 0; i < 60; ++i) {
    const float t = 6.2831853F * static_cast<float>(i) / 60.0F;
    ring.push_back({{60.0F + 30.0F * std::cos(t), 60.0F + 30.0F * std::sin(t)}});
  }
  PenOptions options;
  options.closed = true;
  options.height = 3.0F;
  SlopeImage details(120, 120);
  const Path inwards = {{2.0F, 60.0F}, {60.0F, 60.0F}};
  const Path across = {{2.0F, 55.0F}, {118.0F, 70.0F}};
  for (const bool step : {true, false}) {
    options.profile = step ? ProfileShape::Step : ProfileShape::Bump;
    pen(details, {}, details.rect(), std::span<const Stroke>(&ring, 1), options);
    EXPECT_NEAR(level_change(details, inwards), step ? 3.0 : 0.0, 0.02);
    EXPECT_NEAR(level_change(details, across), 0.0, 0.02);
  }
}

TEST(LevelChange, ReadsBeyondTheImageByTheBorder) {
  SlopeImage image(8, 8, Vec2f(1.0F, 0.0F));
  for (int y = 0; y < 8; ++y) image(0, y).x() = 3.0F;
  const Path once_around = {{0.0F, 4.0F}, {8.0F, 4.0F}};
  EXPECT_NEAR(level_change(image, once_around, {.border = Border::Wrap}), 10.0, 1e-12);
  EXPECT_NEAR(level_change(image, once_around), 9.0, 1e-12);
  const Path over_the_edge = {{-2.0F, 4.0F}, {1.0F, 4.0F}};
  EXPECT_NEAR(level_change(image, over_the_edge, {.border = Border::Mirror}), -2.0 + 2.0, 1e-12);
}

TEST(LevelChange, BadInput) {
  SlopeImage image(8, 8, Vec2f::Zero());
  EXPECT_THROW(level_change(image, Path{{0.0F, nan}, {1.0F, 1.0F}}), InvalidInput);
  EXPECT_THROW(level_change({}, Path{{0.0F, 0.0F}, {1.0F, 1.0F}}), InvalidInput);
  image(4, 4).x() = nan;
  EXPECT_TRUE(std::isnan(level_change(image, Path{{3.0F, 4.0F}, {5.0F, 4.0F}})));
  EXPECT_EQ(level_change(image, Path{{3.0F, 3.0F}, {5.0F, 3.0F}}), 0.0);  // beside it
}

}  // namespace
}  // namespace normalshop::test
