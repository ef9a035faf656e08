#include <cmath>
#include <limits>
#include <numbers>

#include "support/slope_fields.h"
#include <gtest/gtest.h>

#include "normalshop/core/error.h"
#include "normalshop/core/parallel.h"
#include "normalshop/core/random.h"
#include "normalshop/core/slope.h"
#include "normalshop/rgbn/curl.h"
#include "normalshop/rgbn/warp.h"

namespace normalshop::test {
namespace {

using std::numbers::pi;

ColorImage noise_colors(int width, int height) {
  ColorImage image(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      image(x, y) = {noise(x, y, 3), noise(x, y, 4), noise(x, y, 5)};
    }
  }
  return image;
}

/// A map given point by point.
WarpMap map_from(const std::function<WarpPoint(double, double)>& point) {
  return [point](int x0, int y, std::span<WarpPoint> run) {
    for (std::size_t i = 0; i < run.size(); ++i) run[i] = point(x0 + static_cast<double>(i), y);
  };
}

WarpMap linear_map(const Eigen::Matrix2d& matrix, const Vec2d& offset) {
  return map_from([=](double x, double y) {
    return WarpPoint{matrix * Vec2d(x, y) + offset, matrix};
  });
}

Eigen::Matrix2d matrix(double a, double b, double c, double d) {
  Eigen::Matrix2d m;
  m << a, b, c, d;
  return m;
}

/// Turns about (60, 50) by an angle that grows with the distance, and stretches.
WarpPoint spiral(double x, double y) {
  const Vec2d r(x - 60.0, y - 50.0);
  const double angle = 0.3 + 0.004 * r.norm();
  const double grows = 0.004 / std::max(r.norm(), 1e-12);
  const Eigen::Matrix2d turn =
      matrix(std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle));
  const Eigen::Matrix2d stretch = matrix(0.9, 0.1, -0.05, 0.8);
  const Vec2d across = turn * Vec2d(-r.y(), r.x());
  return {stretch * (turn * r) + Vec2d(64.0, 55.0),
          stretch * (turn + grows * across * r.transpose())};
}

/// Height of rows that run down.
double height(double x, double y) {
  return 3.0 * std::sin(0.13 * x + 0.05 * y) + 2.0 * std::cos(0.08 * x - 0.12 * y);
}

/// Slopes by differences of a height, y up: the oracle knows no Jacobian.
template <class Height>
Vec2f slope_by_differences(const Height& z, double x, double y) {
  constexpr double h = 1e-4;
  return {static_cast<float>((z(x + h, y) - z(x - h, y)) / (2.0 * h)),
          static_cast<float>((z(x, y - h) - z(x, y + h)) / (2.0 * h))};
}

template <class Height>
SlopeImage slope_image(const Height& z, int width, int rows) {
  SlopeImage image(width, rows);
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < width; ++x) image(x, y) = slope_by_differences(z, x, y);
  }
  return image;
}

double worst_angle(const SlopeImage& a, const SlopeImage& b, const Rect& rect) {
  double worst = 0.0;
  for (int y = rect.y0; y < rect.y1; ++y) {
    for (int x = rect.x0; x < rect.x1; ++x) {
      worst =
          std::max(worst, angle_degrees(normal_from_slope(a(x, y)), normal_from_slope(b(x, y))));
    }
  }
  return worst;
}

/// The largest difference, in parts of the range of b's slopes.
double worst_of_range(const SlopeImage& a, const SlopeImage& b, const Rect& rect) {
  float worst = 0.0F;
  float low = 0.0F;
  float high = 0.0F;
  for (int y = rect.y0; y < rect.y1; ++y) {
    for (int x = rect.x0; x < rect.x1; ++x) {
      worst = std::max(worst, (a(x, y) - b(x, y)).cwiseAbs().maxCoeff());
      low = std::min(low, b(x, y).minCoeff());
      high = std::max(high, b(x, y).maxCoeff());
    }
  }
  return static_cast<double>(worst / (high - low));
}

constexpr WarpOptions sampled{.reduction = WarpReduction::Sample};

TEST(Warp, GivesTheSlopesOfTheWarpedHeight) {
  const SlopeImage source = slope_image(height, 128, 110);
  ColorImage color(128, 110);
  for (int y = 0; y < 110; ++y) {
    for (int x = 0; x < 128; ++x) color(x, y).setConstant(static_cast<float>(height(x, y)));
  }
  SlopeImage out(120, 100);
  ColorImage color_out(120, 100);
  warp({source, color, {}}, {out, color_out}, out.rect(), map_from(spiral), sampled);
  const auto warped = [](double x, double y) {
    const Vec2d w = spiral(x, y).position;
    return height(w.x(), w.y());
  };
  const SlopeImage expected = slope_image(warped, 120, 100);
  const Rect inside = {30, 20, 90, 80};  // all of it shows the source's inside
  EXPECT_LT(worst_of_range(out, expected, inside), 1e-4);
  for (int y = inside.y0; y < inside.y1; ++y) {  // colours come along
    for (int x = inside.x0; x < inside.x1; ++x) {
      ASSERT_NEAR(color_out(x, y).x(), warped(x, y), 1e-4 * 10.0) << x << ' ' << y;
    }
  }
  SlopeImage copied(120, 100);  // colours' way of warping, for the size of the effect
  const auto as_color = [](double x, double y) {
    return WarpPoint{spiral(x, y).position, Eigen::Matrix2d::Identity()};
  };
  warp({source, {}, {}}, {copied, {}}, out.rect(), map_from(as_color), {});
  EXPECT_GT(worst_angle(copied, expected, inside), 10.0);
}

// The thesis proves g(W) DW conservative: as much as the source is by the same measure, which sees
// samples of slopes and knows no derivatives.
TEST(Warp, WarpedSlopesHaveNoCurl) {
  const auto soft = [](double x, double y) {
    return 6.0 * std::sin(0.05 * x + 0.02 * y) + 4.0 * std::cos(0.03 * x - 0.045 * y);
  };
  const SlopeImage source = slope_image(soft, 300, 300);
  const auto moved = [](double x, double y) {
    WarpPoint p = spiral(x, y);
    p.position += Vec2d(80.0, 90.0);
    return p;
  };
  SlopeImage out(140, 120);
  warp({source, {}, {}}, {out, {}}, out.rect(), map_from(moved), sampled);
  EXPECT_LT(curl_share(source, {}), 1e-6);
  EXPECT_LT(curl_share(out, {}), 1e-6);
  warp({source, {}, {}}, {out, {}}, out.rect(), map_from(moved), {});
  EXPECT_LT(curl_share(out, {}), 1e-6);  // averaging costs little where a picture is so smooth
  const auto as_color = [&](double x, double y) {
    return WarpPoint{moved(x, y).position, Eigen::Matrix2d::Identity()};
  };
  warp({source, {}, {}}, {out, {}}, out.rect(), map_from(as_color), sampled);
  EXPECT_GT(curl_share(out, {}), 0.01);
}

// A mean over a width of w pixels multiplies a wave of wave number k by sin(k w / 2) / (k w / 2);
// n samples in the middles of w's n parts by that over the same of w / n.
TEST(Warp, AveragingFlattensWavesAsItSays) {
  constexpr double k = 0.2;
  constexpr double step = 2.0;
  const auto wave = [](double x, double) { return std::sin(k * x) / k; };
  const SlopeImage source = slope_image(wave, 240, 8);
  SlopeImage out(100, 4);
  const WarpMap reduce = linear_map(matrix(step, 0, 0, 1), Vec2d(10.0, 2.0));
  warp({source, {}, {}}, {out, {}}, out.rect(), reduce, {});
  const double width = std::sqrt(step * step - 1.0);
  const double samples = 1.0 + std::ceil(width);
  const double gain = std::sin(k * width / 2.0) / (samples * std::sin(k * width / 2.0 / samples));
  EXPECT_NEAR(gain, 1.0 - k * k * width * width / 24.0, 1e-3);  // what the header names
  for (int x = 0; x < 100; ++x) {
    const double truth = step * std::cos(k * (step * x + 10.0));
    ASSERT_NEAR(out(x, 2).x(), gain * truth, step * k * k * k / 45.0) << x;
  }
}

TEST(Warp, MovesHeightsAsItMovesTheirSlopes) {
  MaskImage source(128, 110);
  for (int y = 0; y < 110; ++y) {
    for (int x = 0; x < 128; ++x) source(x, y) = static_cast<float>(height(x, y));
  }
  MaskImage out(120, 100);
  warp(source, out, out.rect(), map_from(spiral), {});
  for (int y = 20; y < 80; ++y) {
    for (int x = 30; x < 90; ++x) {
      const Vec2d w = spiral(x, y).position;
      ASSERT_NEAR(out(x, y), height(w.x(), w.y()), 2e-3) << x << ' ' << y;
    }
  }
}

TEST(Warp, TheIdentityLeavesAllBits) {
  SlopeImage slopes = noise_image(300, 41);
  slopes(7, 8) = {-0.0F, std::numeric_limits<float>::quiet_NaN()};
  const ColorImage color = noise_colors(300, 41);
  MaskImage validity(300, 41);
  for (int y = 0; y < 41; ++y) {
    for (int x = 0; x < 300; ++x) validity(x, y) = std::max(0.0F, noise(x, y, 9));
  }
  const WarpMap identity = linear_map(Eigen::Matrix2d::Identity(), Vec2d::Zero());
  for (const MaskView valid : {MaskView(), validity.view()}) {
    for (const WarpHeights heights : {WarpHeights::Keep, WarpHeights::Grow}) {
      SlopeImage slopes_out(300, 41);
      ColorImage color_out(300, 41);
      EXPECT_EQ(warp({slopes, color, valid}, {slopes_out, color_out}, {-3, -3, 900, 900}, identity,
                     {.heights = heights}),
                slopes.rect());
      EXPECT_TRUE(same_bits(slopes, slopes_out));
      EXPECT_TRUE(same_bits(color, color_out));
    }
  }
}

TEST(Warp, FourQuarterTurnsAreTheIdentity) {
  const SlopeImage slopes = noise_image(37, 20);
  const ColorImage color = noise_colors(37, 20);
  SlopeImage turned = slopes;
  ColorImage turned_color = color;
  for (int i = 0; i < 4; ++i) {
    // What is at the source's right comes to the top: counter-clockwise.
    const int width = turned.height();
    const int rows = turned.width();
    const WarpMap map = linear_map(matrix(0, -1, 1, 0), Vec2d(rows - 1, 0));
    SlopeImage next(width, rows);
    ColorImage next_color(width, rows);
    warp({turned, turned_color, {}}, {next, next_color}, next.rect(), map, {});
    if (i == 0) {  // a slope towards the right points up now
      EXPECT_EQ(next(5, 36 - 30), Vec2f(-turned(30, 5).y(), turned(30, 5).x()));
      EXPECT_EQ(next_color(5, 36 - 30), turned_color(30, 5));
    }
    turned = next;
    turned_color = next_color;
  }
  EXPECT_TRUE(same(slopes, turned));
  EXPECT_TRUE(same(color, turned_color));
}

TEST(Warp, HeightsKeepOrGrow) {
  const SlopeImage source(20, 20, Vec2f(0.5F, -1.5F));
  SlopeImage out(40, 40);
  const WarpMap twice = linear_map(0.5 * Eigen::Matrix2d::Identity(), Vec2d(-0.25, -0.25));
  warp({source, {}, {}}, {out, {}}, out.rect(), twice, {.heights = WarpHeights::Keep});
  EXPECT_LT((out(17, 9) - Vec2f(0.25F, -0.75F)).norm(), 1e-6F);
  warp({source, {}, {}}, {out, {}}, out.rect(), twice, {.heights = WarpHeights::Grow});
  EXPECT_LT((out(17, 9) - Vec2f(0.5F, -1.5F)).norm(), 1e-6F);
  const WarpMap flat = linear_map(Eigen::Matrix2d::Zero(), Vec2d(4, 4));
  warp({source, {}, {}}, {out, {}}, out.rect(), flat, {.heights = WarpHeights::Grow});
  EXPECT_EQ(out(17, 9), Vec2f(0.0F, 0.0F));
}

TEST(Warp, ReducingAverages) {
  // A wave of 3 pixels cannot be seen on a picture of a sixth; one of 120 can.
  const auto wave = [](double length, int x) { return std::sin(2.0 * pi * x / length); };
  SlopeImage slopes(720, 40);
  ColorImage color(720, 40);
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 720; ++x) {
      slopes(x, y) = {static_cast<float>(wave(3.1, x)), 0.0F};
      color(x, y) = Vec3f(static_cast<float>(wave(3.1, x)), static_cast<float>(wave(120, x)), 1.0F);
    }
  }
  SlopeImage out(120, 6);
  ColorImage color_out(120, 6);
  const WarpMap sixth = linear_map(6.0 * Eigen::Matrix2d::Identity(), Vec2d(2.5, 2.5));
  warp({slopes, color, {}}, {out, color_out}, out.rect(), sixth,
       {.heights = WarpHeights::Grow, .border = Border::Mirror});
  for (int x = 2; x < 118; ++x) {
    EXPECT_LT(std::abs(out(x, 3).x()), 0.12F) << x;
    EXPECT_LT(std::abs(color_out(x, 3).x()), 0.12F) << x;
    EXPECT_NEAR(color_out(x, 3).y(), std::sin(2.0 * pi * (6.0 * x + 2.5) / 120.0), 0.02) << x;
    EXPECT_NEAR(color_out(x, 3).z(), 1.0F, 1e-5F) << x;
  }
}

// Where W starts to reduce, the averaging sets in gently: no line shows.
TEST(Warp, AveragingSetsInSmoothly) {
  const SlopeImage source = noise_image(120, 40);
  const auto scaled = [&](double scale) {
    SlopeImage out(100, 30);
    const WarpMap map = linear_map(scale * Eigen::Matrix2d::Identity(), Vec2d(3.3, 2.7));
    warp({source, {}, {}}, {out, {}}, out.rect(), map, {.heights = WarpHeights::Grow});
    return out;
  };
  const double first = std::sqrt(1.02);  // from here on more than one sample
  const SlopeImage before = scaled(first - 1e-7);
  const SlopeImage after = scaled(first + 1e-7);
  double sum = 0.0;
  for (int y = 0; y < 30; ++y) {
    for (int x = 0; x < 100; ++x) sum += static_cast<double>((before(x, y) - after(x, y)).norm());
  }
  EXPECT_LT(sum / 3000.0, 0.01);  // of noise with amplitude 1
}

TEST(Warp, InvalidPixelsDoNotCount) {
  SlopeImage slopes(60, 40, Vec2f(0.25F, -0.5F));
  MaskImage validity(60, 40, 1.0F);
  for (int y = 0; y < 40; ++y) {
    for (int x = 30; x < 60; ++x) {
      validity(x, y) = 0.0F;
      slopes(x, y) = Vec2f::Constant(std::numeric_limits<float>::quiet_NaN());
    }
  }
  SlopeImage out(60, 40);
  const WarpMap shift = linear_map(Eigen::Matrix2d::Identity(), Vec2d(0.3, 0.4));
  warp({slopes, {}, validity}, {out, {}}, out.rect(), shift, {});
  for (int x = 0; x <= 29; ++x) {
    EXPECT_LT((out(x, 20) - Vec2f(0.25F, -0.5F)).norm(), 1e-6F) << x;
  }
  EXPECT_TRUE(std::isnan(out(45, 20).x()));  // nothing valid in reach: as without validity
}

TEST(Warp, WrappedImagesKeepTiling) {
  const auto tile = [](double x, double y) {
    return 2.0 * std::sin(2.0 * pi * x / 32.0) * std::cos(2.0 * pi * y / 48.0 + 1.0);
  };
  const auto moved = [](double x, double y) {
    const double a = 2.0 * pi / 64.0;
    const double b = 2.0 * pi / 48.0;
    return WarpPoint{{x + 5.0 * std::sin(b * y) + 9.7, y + 4.0 * std::cos(a * x)},
                     matrix(1.0, 5.0 * b * std::cos(b * y), -4.0 * a * std::sin(a * x), 1.0)};
  };
  const auto warped = [&](double x, double y) {
    const Vec2d w = moved(x, y).position;
    return tile(w.x(), w.y());
  };
  const SlopeImage source = slope_image(tile, 64, 48);
  const SlopeImage expected = slope_image(warped, 64, 48);
  SlopeImage out(64, 48);
  warp({source, {}, {}}, {out, {}}, out.rect(), map_from(moved), {.border = Border::Wrap});
  EXPECT_LT(worst_angle(out, expected, out.rect()), 0.1);
  warp({source, {}, {}}, {out, {}}, out.rect(), map_from(moved),
       {.reduction = WarpReduction::Sample, .border = Border::Wrap});
  EXPECT_LT(worst_of_range(out, expected, out.rect()), 1e-4);
  // Two of them side by side show the same twice, whatever is averaged.
  for (const WarpReduction reduction : {WarpReduction::Average, WarpReduction::Sample}) {
    SlopeImage more(128, 96);
    const WarpOptions wraps{.reduction = reduction, .border = Border::Wrap};
    warp({source, {}, {}}, {more, {}}, more.rect(), map_from(moved), wraps);
    for (int y = 0; y < 48; ++y) {
      for (int x = 0; x < 64; ++x) {
        ASSERT_LT((more(x, y) - more(x + 64, y)).norm(), 1e-5F) << x << ' ' << y;
        ASSERT_LT((more(x, y) - more(x, y + 48)).norm(), 1e-5F) << x << ' ' << y;
      }
    }
  }
  warp({source, {}, {}}, {out, {}}, out.rect(), map_from(moved), {});
  EXPECT_GT(worst_angle(out, expected, out.rect()), 5.0);
}

TEST(Warp, MirroredBordersTurnSlopesOver) {
  const SlopeImage source = noise_image(16, 12);
  SlopeImage out(16, 12);
  const WarpMap left = linear_map(Eigen::Matrix2d::Identity(), Vec2d(-16, 0));
  warp({source, {}, {}}, {out, {}}, out.rect(), left, {.border = Border::Mirror});
  EXPECT_EQ(out(15, 3), Vec2f(-source(0, 3).x(), source(0, 3).y()));
  const WarpMap below = linear_map(Eigen::Matrix2d::Identity(), Vec2d(0, 12));
  warp({source, {}, {}}, {out, {}}, out.rect(), below, {.border = Border::Mirror});
  EXPECT_EQ(out(5, 2), Vec2f(source(5, 9).x(), -source(5, 9).y()));
}

TEST(Warp, ARegionGivesThePixelsOfTheWhole) {
  const SlopeImage source = noise_image(600, 90);
  SlopeImage whole(600, 90);
  SlopeImage part(600, 90, Vec2f::Constant(9.0F));
  const Rect region = {111, 17, 570, 63};
  warp({source, {}, {}}, {whole, {}}, whole.rect(), map_from(spiral), {});
  EXPECT_EQ(warp({source, {}, {}}, {part, {}}, region, map_from(spiral), {}), region);
  for (int y = 0; y < 90; ++y) {
    for (int x = 0; x < 600; ++x) {
      const Vec2f expected = region.contains(x, y) ? whole(x, y) : Vec2f(9.0F, 9.0F);
      ASSERT_EQ(part(x, y), expected) << x << ' ' << y;
    }
  }
}

TEST(Warp, TheNumberOfThreadsChangesNothing) {
  const SlopeImage source = noise_image(128, 110);
  SlopeImage many(120, 100);
  warp({source, {}, {}}, {many, {}}, many.rect(), map_from(spiral), {});
  const ThreadLimit limit(1);
  SlopeImage one(120, 100);
  warp({source, {}, {}}, {one, {}}, one.rect(), map_from(spiral), {});
  EXPECT_TRUE(same_bits(many, one));
}

TEST(Warp, ReachIsHowFarPixelsMove) {
  const WarpMap shift = linear_map(Eigen::Matrix2d::Identity(), Vec2d(-3.5, 12.25));
  EXPECT_EQ(reach(shift, {0, 0, 50, 50}), 15);  // half a pixel of footprint, 2 of the filter
  EXPECT_EQ(reach(shift, {}), 0);
  // Pixels beyond the reach do not count.
  SlopeImage source = noise_image(200, 200);
  const Rect region = {90, 90, 110, 110};
  const int margin = reach(map_from(spiral), region);
  const auto warped = [&] {
    SlopeImage out(200, 200, Vec2f::Zero());
    warp({source, {}, {}}, {out, {}}, region, map_from(spiral), {});
    return out;
  };
  const SlopeImage before = warped();
  const Rect used = grow(region, margin);
  for (int y = 0; y < 200; ++y) {
    for (int x = 0; x < 200; ++x) {
      if (!used.contains(x, y)) source(x, y) = Vec2f::Constant(1e6F);
    }
  }
  EXPECT_TRUE(same_bits(before, warped()));
}

TEST(Warp, TinyAndEmptyImages) {
  const SlopeImage pixel(1, 1, Vec2f(1.0F, 2.0F));
  for (const Border border : {Border::Clamp, Border::Wrap}) {
    SlopeImage out(3, 3);
    const WarpMap map = linear_map(Eigen::Matrix2d::Identity(), Vec2d(0.5, 7.25));
    warp({pixel, {}, {}}, {out, {}}, out.rect(), map, {.border = border});
    EXPECT_LT((out(1, 2) - Vec2f(1.0F, 2.0F)).norm(), 1e-6F);
  }
  SlopeImage none;
  EXPECT_TRUE(warp({pixel, {}, {}}, {none, {}}, {0, 0, 5, 5}, map_from(spiral), {}).empty());
  SlopeImage out(2, 2);
  ColorImage color(2, 2);
  MaskImage mask(2, 2);
  EXPECT_THROW(warp(RgbnView{}, {out, {}}, out.rect(), map_from(spiral), {}), InvalidInput);
  EXPECT_THROW(warp({pixel, {}, {}}, {out, color}, out.rect(), map_from(spiral), {}), InvalidInput);
  EXPECT_THROW(warp(MaskView{}, mask, mask.rect(), map_from(spiral), {}), InvalidInput);
}

TEST(Warp, PlacesThatAreNoNumbersReadSomething) {
  const SlopeImage source(5, 5, Vec2f(1.0F, 2.0F));
  SlopeImage out(2, 2);
  const WarpMap map = map_from([](double, double) {
    return WarpPoint{{nan, 1e300}, Eigen::Matrix2d::Identity()};
  });
  warp({source, {}, {}}, {out, {}}, out.rect(), map, {});
  EXPECT_EQ(out(1, 1), Vec2f(1.0F, 2.0F));
}

}  // namespace
}  // namespace normalshop::test
