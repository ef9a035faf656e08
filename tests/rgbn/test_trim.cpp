#include <cmath>
#include <numbers>

#include "support/nan.h"
#include <gtest/gtest.h>

#include "normalshop/core/error.h"
#include "normalshop/rgbn/curl.h"
#include "normalshop/rgbn/trim.h"

namespace normalshop::test {
namespace {

constexpr float tau = 2.0F * std::numbers::pi_v<float>;

/// Height a sin(2 pi x / W) (1 + cos(pi t)) / 2, t from -1 to 1 across: tiles along x, and is flat
/// at both sides.
Patch wave(int width, int height, float amplitude) {
  Patch patch{SlopeImage(width, height), {}, {}};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const float k = tau / static_cast<float>(width);
      const float phase = k * (static_cast<float>(x) + 0.5F);
      const float t = 1.0F - 2.0F * (static_cast<float>(y) + 0.5F) / static_cast<float>(height);
      const float fall = 0.5F * (1.0F + std::cos(0.5F * tau * t));
      const float fall_slope =
          -0.25F * tau * std::sin(0.5F * tau * t) * 2.0F / static_cast<float>(height);
      patch.slopes(x, y) = {amplitude * k * std::cos(phase) * fall,
                            amplitude * std::sin(phase) * fall_slope};
    }
  }
  return patch;
}

TrimOptions plain(float width) {
  TrimOptions o;
  o.width = width;
  o.smooth = false;
  return o;
}

Stroke circle(const Vec2f& center, float radius, int points) {
  Stroke out;
  for (int i = 0; i < points; ++i) {
    const float angle = tau * static_cast<float>(i) / static_cast<float>(points);
    out.push_back({center + radius * Vec2f(std::cos(angle), std::sin(angle))});
  }
  return out;
}

/// Along a straight line to the right, the pattern is the patch itself, repeated.
TEST(Trim, AStraightStrokeRepeatsThePatch) {
  const Patch patch = wave(24, 16, 2.0F);
  SlopeImage details(120, 40);
  MaskImage coverage(120, 40);
  const std::vector<Stroke> strokes{{{{11.5F, 19.5F}}, {{107.5F, 19.5F}}}};
  trim(details, coverage, details.rect(), strokes, patch, plain(16.0F));
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 120; ++x) {
      const bool inside = x >= 12 && x < 108 && y >= 12 && y < 28;
      const Vec2f expected = inside ? patch.slopes((x - 12) % 24, y - 12) : Vec2f(0.0F, 0.0F);
      EXPECT_LT((details(x, y) - expected).norm(), 1e-5F) << x << " " << y;
      EXPECT_EQ(coverage(x, y), inside ? 1.0F : 0.0F) << x << " " << y;
    }
  }
}

/// Turned by 90 degrees: the stroke runs up, its left is to the left.
TEST(Trim, TurnsWithTheStroke) {
  const Patch patch = wave(24, 16, 2.0F);
  SlopeImage details(40, 120);
  const std::vector<Stroke> strokes{{{{19.5F, 107.5F}}, {{19.5F, 11.5F}}}};
  trim(details, {}, details.rect(), strokes, patch, plain(16.0F));
  for (int i = 0; i < 96; ++i) {
    for (int j = 0; j < 16; ++j) {
      // Along: up. Across: from left (top of the patch) to right.
      const Vec2f g = patch.slopes(i % 24, j);
      EXPECT_LT((details(12 + j, 107 - i) - Vec2f(-g.y(), g.x())).norm(), 1e-5F) << i << " " << j;
    }
  }
}

/// Around a circle: h(r, angle) is known, and so is its gradient.
TEST(Trim, FollowsACircle) {
  const float radius = 60.0F;
  const float width = 40.0F;
  const int repetitions = 16;
  const Patch patch = wave(96, 160, 12.0F);
  const Vec2f center(100.0F, 100.0F);
  SlopeImage details(201, 201);
  trim(details, {}, details.rect(), std::vector<Stroke>{circle(center, radius, 720)}, patch, [&] {
    TrimOptions o = plain(width);
    o.closed = true;
    return o;
  }());
  const float scale = width / 160.0F;
  EXPECT_EQ(std::lround(tau * radius / (96.0F * scale)), repetitions);
  float worst = 0.0F;
  for (int y = 0; y < 201; ++y) {
    for (int x = 0; x < 201; ++x) {
      const Vec2f p(static_cast<float>(x) - 100.0F, static_cast<float>(y) - 100.0F);
      const float r = p.norm();
      if (std::abs(r - radius) > 0.5F * width - 1.0F) continue;
      const float angle = std::atan2(p.y(), p.x());  // the way the stroke runs, y down
      const float t = (radius - r) / (0.5F * width);
      const float a = 12.0F * scale;
      const float phase = static_cast<float>(repetitions) * angle;
      const float fall = 0.5F * (1.0F + std::cos(0.5F * tau * t));
      const float by_angle = a * static_cast<float>(repetitions) * std::cos(phase) * fall;
      const float by_r =
          a * std::sin(phase) * 0.25F * tau * std::sin(0.5F * tau * t) / (0.5F * width);
      const Vec2f out = p / r;
      const Vec2f around(-out.y(), out.x());
      const Vec2f gradient = by_r * out + by_angle / r * around;
      worst = std::max(worst, (details(x, y) - Vec2f(gradient.x(), -gradient.y())).norm());
    }
  }
  EXPECT_LT(worst, 0.02F);  // of slopes up to 0.9: the chords of the circle and the samples' steps
}

/// Away from the medial axis; what is left comes from the pixels of the pattern.
TEST(Trim, HasHardlyAnyCurl) {
  const Patch patch = wave(64, 64, 6.0F);
  SlopeImage details(512, 512);
  TrimOptions o = plain(64.0F);
  o.smooth = true;
  const std::vector<Stroke> strokes{
      {{{60.0F, 430.0F}}, {{180.0F, 260.0F}}, {{330.0F, 250.0F}}, {{450.0F, 90.0F}}}};
  trim(details, {}, details.rect(), strokes, patch, o);
  EXPECT_LT(curl_share(details, {}), 1e-3);
}

TEST(Trim, PartsAreTheWhole) {
  const Patch patch = wave(20, 12, 1.0F);
  const std::vector<Stroke> strokes{{{{10.0F, 70.0F}, 0.5F}, {{50.0F, 20.0F}}, {{90.0F, 60.0F}}}};
  SlopeImage whole(100, 90);
  trim(whole, {}, whole.rect(), strokes, patch, TrimOptions{.width = 18.0F});
  SlopeImage parts(100, 90, Vec2f(9.0F, 9.0F));
  for (int y = 0; y < 90; y += 37) {
    for (int x = 0; x < 100; x += 41) {
      trim(parts, {}, {x, y, x + 41, y + 37}, strokes, patch, TrimOptions{.width = 18.0F});
    }
  }
  for (int y = 0; y < 90; ++y) {
    for (int x = 0; x < 100; ++x) EXPECT_EQ(whole(x, y), parts(x, y)) << x << " " << y;
  }
}

TEST(Trim, FadesAtItsBorders) {
  Patch patch{SlopeImage(8, 8, Vec2f(0.5F, 0.0F)), MaskImage(8, 8, 0.5F), {}};
  SlopeImage details(80, 40);
  MaskImage coverage(80, 40);
  TrimOptions o = plain(16.0F);
  o.border = 0.25F;
  const std::vector<Stroke> strokes{{{{9.5F, 19.5F}}, {{69.5F, 19.5F}}}};
  trim(details, coverage, details.rect(), strokes, patch, o);
  EXPECT_FLOAT_EQ(coverage(40, 19), 0.5F);
  EXPECT_LT(coverage(40, 12), 0.05F);
  EXPECT_LT(coverage(10, 19), 0.05F);
  EXPECT_GT(coverage(40, 14), 0.1F);
}

TEST(Trim, EdgesOfItsInput) {
  const Patch patch = wave(8, 8, 1.0F);
  SlopeImage details(32, 32, Vec2f(3.0F, 3.0F));
  const auto clear = [&](const std::vector<Stroke>& strokes, const TrimOptions& o) {
    trim(details, {}, details.rect(), strokes, patch, o);
    for (int y = 0; y < 32; ++y) {
      for (int x = 0; x < 32; ++x) EXPECT_EQ(details(x, y), Vec2f(0.0F, 0.0F));
    }
  };
  const Stroke line{{{4.0F, 16.0F}}, {{28.0F, 16.0F}}};
  clear({}, plain(8.0F));
  clear({{}, {{{5.0F, 5.0F}}}}, plain(8.0F));
  clear({line}, plain(0.0F));
  EXPECT_THROW(trim(details, {}, details.rect(), std::vector<Stroke>{line}, {}, plain(8.0F)),
               InvalidInput);
  EXPECT_THROW(trim(details, {}, details.rect(), std::vector<Stroke>{line}, patch, plain(nan)),
               InvalidInput);
  EXPECT_THROW(trim(details, {}, details.rect(),
                    std::vector<Stroke>{{{{nan, 0.0F}}, {{1.0F, 1.0F}}}}, patch, plain(8.0F)),
               InvalidInput);
  // Much smaller than the patch, and a stroke shorter than one repetition.
  trim(details, {}, details.rect(), std::vector<Stroke>{{{{4.0F, 16.0F}}, {{6.0F, 16.0F}}}},
       wave(512, 512, 9.0F), plain(3.0F));
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 32; ++x) EXPECT_TRUE(details(x, y).allFinite());
  }
}

}  // namespace
}  // namespace normalshop::test
