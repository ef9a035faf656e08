#include <cmath>

#include "support/nan.h"
#include <gtest/gtest.h>

#include "normalshop/core/error.h"
#include "normalshop/core/parallel.h"
#include "normalshop/core/slope.h"
#include "normalshop/rgbn/pen.h"

namespace normalshop::test {
namespace {

struct Drawing {
  Drawing(int width, int height, const std::vector<Stroke>& strokes, const PenOptions& options)
      : slopes(width, height), coverage(width, height), heights(width, height) {
    changed = pen(slopes, coverage, slopes.rect(), strokes, options);
    pen_height(heights, slopes.rect(), strokes, options);
  }
  SlopeImage slopes;
  MaskImage coverage;
  MaskImage heights;
  Rect changed;
};

PenOptions options_of(ProfileShape profile, float width, float height) {
  PenOptions o;
  o.profile = profile;
  o.width = width;
  o.height = height;
  o.smooth = false;
  return o;
}

Stroke circle(const Vec2f& center, float radius, int points, float direction) {
  Stroke s;
  for (int i = 0; i < points; ++i) {
    const float a = direction * 6.2831853F * static_cast<float>(i) / static_cast<float>(points);
    s.push_back({{center.x() + radius * std::cos(a), center.y() + radius * std::sin(a)}});
  }
  return s;
}

TEST(Pen, StraightLineHasTheSlopesOfItsProfile) {
  for (const auto shape : {ProfileShape::Bump, ProfileShape::Crease, ProfileShape::Scratch}) {
    const PenOptions o = options_of(shape, 21.0F, 3.0F);
    const Vec2f direction = Vec2f(3.0F, 1.0F).normalized();
    const Stroke line = {{{-100.0F, 20.0F}}, {Vec2f(-100.0F, 20.0F) + 400.0F * direction}};
    const Drawing d(128, 128, {line}, o);
    const Profile profile({shape, false, {}});
    const Vec2f left(direction.y(), -direction.x());
    double worst = 0.0;
    for (int y = 0; y < 128; ++y) {
      for (int x = 0; x < 128; ++x) {
        const Vec2f p(static_cast<float>(x), static_cast<float>(y));
        const float u = (p - line[0].position).dot(left) / 10.5F;
        if (std::abs(u) < 1e-3F) continue;
        // A crease's slope is averaged over 1.5 pixels on both sides of its bottom.
        const float r = 1.5F / 10.5F;
        const bool averaged = shape == ProfileShape::Crease && std::abs(u) < r;
        const float slope = averaged
                                ? (profile.at(u + r).height - profile.at(u - r).height) / (2.0F * r)
                                : profile.at(u).slope;
        const Vec2f g = 3.0F / 10.5F * slope * left;
        worst = std::max(worst, angle_degrees(normal_from_slope(d.slopes(x, y)),
                                              normal_from_slope({g.x(), -g.y()})));
        EXPECT_NEAR(d.heights(x, y), 3.0F * profile.at(u).height, 1e-3F);
      }
    }
    EXPECT_LT(worst, 0.01);
  }
}

/// A straight line through the same points as a curve would show its pieces as facets.
TEST(Pen, SmoothCurvesHaveNoFacets) {
  constexpr float radius = 150.0F;
  constexpr float around = 200.0F;
  for (const bool closed : {false, true}) {
    PenOptions o = options_of(ProfileShape::Bump, 100.0F, 30.0F);
    o.smooth = true;
    o.closed = closed;
    const Drawing d(400, 400, {circle({around, around}, radius, 36, 1.0F)}, o);
    double worst = 0.0;
    double most_off = 0.0;
    for (int y = 0; y < 400; ++y) {
      for (int x = 0; x < 400; ++x) {
        const Vec2f away =
            Vec2f(static_cast<float>(x), static_cast<float>(y)) - Vec2f(around, around);
        const float u = (away.norm() - radius) / 50.0F;
        // An open line's first and last pieces are not those of a circle.
        const bool near_ends = away.x() > 0.0F && away.y() < 0.4F * radius;
        if (std::abs(u) > 0.9F || (!closed && near_ends)) continue;
        const Profile::Value bump = Profile({ProfileShape::Bump, closed, {}}).at(u);
        const Vec2f g = 30.0F / 50.0F * bump.slope * away.normalized();
        worst = std::max(worst, angle_degrees(normal_from_slope(d.slopes(x, y)),
                                              normal_from_slope({g.x(), -g.y()})));
        most_off = std::max(most_off,
                            static_cast<double>(std::abs(d.heights(x, y) - 30.0F * bump.height)));
      }
    }
    EXPECT_LT(worst, 0.05) << closed;
    EXPECT_LT(most_off, 0.03) << closed;
  }
}

TEST(Pen, YIsUp) {
  // A bump along the x axis: above it (smaller row) the surface falls upwards.
  const Drawing d(40, 40, {{{{0.0F, 20.0F}}, {{40.0F, 20.0F}}}},
                  options_of(ProfileShape::Bump, 16.0F, 2.0F));
  EXPECT_LT(d.slopes(20, 16).y(), -0.1F);
  EXPECT_GT(d.slopes(20, 24).y(), 0.1F);
}

/// Largest deviation of the slopes from differences of the height, as a part of the largest slope,
/// leaving out a part of the pixels for medial axes.
double gradient_error(const Drawing& d, double quantile) {
  std::vector<double> errors;
  double largest = 0.0;
  for (int y = 1; y + 1 < d.slopes.height(); ++y) {
    for (int x = 1; x + 1 < d.slopes.width(); ++x) {
      const Vec2f g = d.slopes(x, y);
      const Vec2f numeric(0.5F * (d.heights(x + 1, y) - d.heights(x - 1, y)),
                          0.5F * (d.heights(x, y - 1) - d.heights(x, y + 1)));
      largest = std::max(largest, static_cast<double>(g.norm()));
      if (d.coverage(x, y) > 0.0F) errors.push_back(static_cast<double>((g - numeric).norm()));
    }
  }
  std::sort(errors.begin(), errors.end());
  return errors[static_cast<std::size_t>(quantile * static_cast<double>(errors.size() - 1))] /
         largest;
}

TEST(Pen, SlopesAreTheGradientOfOneHeight) {
  PenOptions o = options_of(ProfileShape::Bump, 40.0F, 8.0F);
  o.taper = 60.0F;
  o.smooth = true;
  const Stroke wave = {{{40.0F, 150.0F}, 0.6F},
                       {{110.0F, 90.0F}, 1.0F},
                       {{200.0F, 180.0F}, 0.5F},
                       {{270.0F, 120.0F}, 0.9F}};
  // The rest is where differences say little: the rim, and bends narrower than the stroke.
  EXPECT_LT(gradient_error({320, 260, {wave}, o}, 0.9), 0.02);
  EXPECT_LT(gradient_error({320, 260, {wave}, o}, 0.99), 0.05);
  o.profile = ProfileShape::Custom;
  o.curve = Curve({{-1.0F, 0.0F}, {-0.3F, 1.0F}, {0.4F, -0.5F}, {1.0F, 0.0F}});
  EXPECT_LT(gradient_error({320, 260, {wave}, o}, 0.99), 0.04);
  o.taper = 0.0F;  // round ends of an uneven profile
  EXPECT_LT(gradient_error({320, 260, {wave}, o}, 0.99), 0.04);
}

TEST(Pen, ClosedStrokeIsTheGradientOfOneHeight) {
  PenOptions o = options_of(ProfileShape::Step, 24.0F, 5.0F);
  o.closed = true;
  EXPECT_LT(gradient_error({200, 200, {circle({100.3F, 99.6F}, 60.0F, 200, 1.0F)}, o}, 1.0), 0.02);
}

TEST(Pen, OpenStrokeDoesNotChangeTheLevel) {
  PenOptions o = options_of(ProfileShape::Custom, 30.0F, 4.0F);
  o.curve = Curve({{-1.0F, -0.5F}, {0.0F, 1.0F}, {1.0F, 0.8F}});
  const Drawing d(100, 100, {{{{-20.0F, 50.3F}}, {{120.0F, 50.3F}}}}, o);
  double up = 0.0;
  for (int y = 0; y < 100; ++y) up += static_cast<double>(d.slopes(50, y).y());
  EXPECT_NEAR(up, 0.0, 0.01);
}

TEST(Pen, ClosedStepRaisesTheInsideWhateverTheDirection) {
  for (const float direction : {1.0F, -1.0F}) {
    PenOptions o = options_of(ProfileShape::Step, 20.0F, 7.0F);
    o.closed = true;
    const Drawing d(200, 200, {circle({100.0F, 100.0F}, 60.0F, 90, direction)}, o);
    double rise = 0.0;
    for (int x = 0; x < 100; ++x) rise += static_cast<double>(d.slopes(x, 100).x());
    EXPECT_NEAR(rise, 7.0, 0.02);
    EXPECT_EQ(d.slopes(100, 100), Vec2f(0.0F, 0.0F));
    EXPECT_EQ(d.coverage(100, 100), 0.0F);
    EXPECT_EQ(d.heights(100, 100), 7.0F);
    EXPECT_EQ(d.heights(3, 3), 0.0F);
  }
}

TEST(Pen, OverlappingRaisedRegionsJoin) {
  PenOptions o = options_of(ProfileShape::Step, 12.0F, 3.0F);
  o.closed = true;
  const Drawing d(
      200, 200,
      {circle({80.0F, 100.0F}, 40.0F, 60, 1.0F), circle({120.0F, 100.0F}, 40.0F, 60, -1.0F)}, o);
  EXPECT_EQ(d.slopes(80, 100), Vec2f(0.0F, 0.0F));  // on the other stroke's line
  EXPECT_EQ(d.heights(80, 100), 3.0F);
}

TEST(Pen, CrossingStrokesJoinInsteadOfAddingUp) {
  const PenOptions o = options_of(ProfileShape::Crease, 16.0F, 4.0F);
  const Drawing d(100, 100,
                  {{{{10.0F, 10.0F}}, {{90.0F, 90.0F}}}, {{{10.0F, 90.0F}}, {{90.0F, 10.0F}}}}, o);
  EXPECT_NEAR(d.heights(50, 50), -4.0F, 1e-4F);
  for (int i = 0; i < 100; ++i) {
    for (int j = 0; j < 100; ++j) EXPECT_GE(d.heights(i, j), -4.0001F);
  }
}

TEST(Pen, NothingBeyondTheStroke) {
  const PenOptions o = options_of(ProfileShape::Bump, 10.0F, 4.0F);
  const Stroke line = {{{300.0F, 300.0F}}, {{340.0F, 320.0F}}};
  const Drawing d(640, 480, {line}, o);
  EXPECT_LT(d.changed.width(), 60);
  std::size_t touched = 0;
  for (int y = 0; y < 480; ++y) {
    for (int x = 0; x < 640; ++x) {
      if (d.slopes(x, y).isZero(0.0F) && d.coverage(x, y) == 0.0F) continue;
      ++touched;
      EXPECT_TRUE(d.changed.contains(x, y));
    }
  }
  EXPECT_GT(touched, 300U);
  EXPECT_EQ(d.coverage(320, 310), 1.0F);
}

TEST(Pen, RegionsAndThreadsGiveTheSamePixels) {
  PenOptions o = options_of(ProfileShape::Scratch, 18.0F, 2.0F);
  o.smooth = true;
  const std::vector<Stroke> strokes = {
      {{{20.0F, 30.0F}}, {{150.0F, 90.0F}}, {{60.0F, 160.0F}}, {{190.0F, 170.0F}}}};
  const Drawing whole(220, 200, strokes, o);
  const ThreadLimit limit(1);
  SlopeImage part(220, 200, Vec2f::Constant(9.0F));
  const Rect region = {37, 21, 181, 166};
  pen(part, {}, region, strokes, o);
  for (int y = 0; y < 200; ++y) {
    for (int x = 0; x < 220; ++x) {
      EXPECT_EQ(part(x, y),
                region.contains(x, y) ? whole.slopes(x, y) : Vec2f(Vec2f::Constant(9.0F)));
    }
  }
}

Stroke spiral(int points) {
  Stroke s;
  for (int i = 0; i < points; ++i) {
    const float t = 0.35F * static_cast<float>(i);
    const float radius = 12.0F + 3.0F * t;
    s.push_back({{100.0F + radius * std::cos(t), 96.0F + radius * std::sin(t)},
                 0.6F + 0.4F * std::sin(2.0F * t)});
  }
  return s;
}

std::vector<PenOptions> options_to_redraw() {
  PenOptions bump = options_of(ProfileShape::Bump, 30.0F, 4.0F);
  bump.smooth = true;
  PenOptions crease = options_of(ProfileShape::Crease, 9.0F, 1.0F);
  PenOptions tapered = bump;
  tapered.taper = 40.0F;
  PenOptions custom = options_of(ProfileShape::Custom, 20.0F, 2.0F);
  custom.curve = Curve({{-1.0F, 0.0F}, {0.2F, 1.0F}, {1.0F, 0.5F}});
  custom.pressure = PressureTo::None;
  PenOptions narrow = options_of(ProfileShape::Scratch, 3.0F, 1.0F);
  PenOptions closed = options_of(ProfileShape::Step, 12.0F, 2.0F);
  closed.closed = true;
  return {bump, crease, tapered, custom, narrow, closed};
}

TEST(Pen, RedrawingGivesWhatDrawingGivesBitForBit) {
  const Stroke whole = spiral(24);
  const Stroke other = {{{20.0F, 150.0F}}, {{150.0F, 20.0F}}, {{180.0F, 170.0F}}};
  const auto first = [&](std::size_t points) {
    return Stroke(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(points));
  };
  const std::vector<std::vector<Stroke>> steps = {
      {first(3)}, {first(12)}, {first(13)}, {first(13), other}, {first(24), other}, {other}, {}};
  for (const PenOptions& o : options_to_redraw()) {
    SlopeImage slopes(200, 190, Vec2f(0.0F, 0.0F));
    MaskImage coverage(200, 190, 0.0F);
    PixelBlocks drawn(200, 190);
    std::vector<Stroke> before;
    for (const std::vector<Stroke>& strokes : steps) {
      drawn.reset(slopes.rect());
      redraw_pen(slopes, coverage, before, strokes, o, drawn);
      const Drawing all(200, 190, strokes, o);
      int different = 0;
      for (int y = 0; y < 190; ++y) {
        for (int x = 0; x < 200; ++x) {
          const bool same =
              slopes(x, y) == all.slopes(x, y) && coverage(x, y) == all.coverage(x, y);
          different += same ? 0 : 1;
        }
      }
      EXPECT_EQ(different, 0) << static_cast<int>(o.profile) << ", " << strokes.size();
      before = strokes;
    }
  }
}

TEST(Pen, RedrawingLeavesWhatALongerStrokeLeavesAsItIs) {
  const PenOptions o = options_of(ProfileShape::Bump, 60.0F, 4.0F);
  const Stroke before = {
      {{60.0F, 100.0F}}, {{100.0F, 100.0F}}, {{150.0F, 100.0F}}, {{240.0F, 100.0F}}};
  Stroke after = before;
  after.push_back({{250.0F, 100.0F}});
  SlopeImage slopes(400, 200, Vec2f(7.0F, 7.0F));
  PixelBlocks drawn(400, 200);
  drawn.reset(slopes.rect());
  redraw_pen(slopes, {}, std::vector<Stroke>{before}, std::vector<Stroke>{after}, o, drawn);
  for (int y = 0; y < 200; ++y) {
    for (int x = 0; x < 400; ++x) {
      const bool marked = drawn.marked(x / PixelBlocks::side, y / PixelBlocks::side);
      EXPECT_EQ(slopes(x, y) != Vec2f(7.0F, 7.0F), marked) << x << ", " << y;
      // The last segment has got a neighbour: it counts as another, and so does the one before it.
      if (x < 70 || x > 300) {
        EXPECT_FALSE(marked) << x << ", " << y;
      } else if (x >= 255 && x < 275 && y >= 80 && y < 120) {
        EXPECT_TRUE(marked) << x << ", " << y;
      }
    }
  }
}

TEST(Pen, NarrowStrokesDoNotBreakUp) {
  const PenOptions o = options_of(ProfileShape::Bump, 1.5F, 1.0F);
  const Drawing d(100, 40, {{{{-10.0F, 10.0F}}, {{110.0F, 27.0F}}}}, o);
  for (int x = 0; x < 100; ++x) {
    float sum = 0.0F;
    for (int y = 0; y < 40; ++y) sum += d.heights(x, y);
    EXPECT_NEAR(sum, 0.5333F * 1.5F * 1.01F, 0.25F) << x;
  }
}

TEST(Pen, DotsAndLimits) {
  PenOptions o = options_of(ProfileShape::Bump, 20.0F, 2.0F);
  const Drawing dot(40, 40, {{{{20.0F, 20.0F}}}, {}}, o);
  EXPECT_FLOAT_EQ(dot.heights(20, 20), 2.0F);
  EXPECT_NEAR(dot.heights(13, 20), dot.heights(20, 27), 1e-6F);
  o.width = 0.0F;
  EXPECT_TRUE(Drawing(40, 40, {{{{20.0F, 20.0F}}}}, o).changed.empty());
}

TEST(Pen, PressureScalesWidthAndHeight) {
  PenOptions o = options_of(ProfileShape::Bump, 20.0F, 2.0F);
  const std::vector<Stroke> half = {{{{-50.0F, 20.0F}, 0.5F}, {{90.0F, 20.0F}, 0.5F}}};
  EXPECT_FLOAT_EQ(Drawing(40, 40, half, o).heights(20, 20), 1.0F);
  EXPECT_EQ(Drawing(40, 40, half, o).heights(20, 14), 0.0F);
  o.pressure = PressureTo::None;
  EXPECT_FLOAT_EQ(Drawing(40, 40, half, o).heights(20, 20), 2.0F);
  EXPECT_GT(Drawing(40, 40, half, o).heights(20, 14), 0.0F);
}

/// The middle of a line that tapers over all of its length, shown alone and half as wide.
TEST(Pen, PartsOfALineKeepItsLengthsAndWidths) {
  PenOptions o = options_of(ProfileShape::Bump, 24.0F, 3.0F);
  o.taper = 100.0F;
  o.smooth = true;
  const Stroke whole = {{{20.0F, 32.0F}}, {{220.0F, 32.0F}}};
  Stroke part = {{{60.0F, 32.0F}, 1.0F, 40.0F, 160.0F}, {{180.0F, 32.0F}, 1.0F, 160.0F, 40.0F}};
  const Drawing all(240, 64, {whole}, o);
  const Drawing middle(240, 64, {part}, o);
  for (StrokePoint& p : part) p.across = 0.5F;
  const Drawing narrow(240, 64, {part}, o);
  for (int x = 80; x < 160; x += 7) {
    for (int y = 20; y < 44; ++y) {
      EXPECT_NEAR(middle.heights(x, y), all.heights(x, y), 0.02F);
      const int half = 32 + (y - 32) * 2;
      const bool inside = half >= 0 && half < 64;
      EXPECT_NEAR(narrow.heights(x, y), inside ? all.heights(x, half) : 0.0F, 0.02F);
    }
  }
}

TEST(Pen, RejectsBadInput) {
  SlopeImage image(8, 8);
  const auto draw = [&](const Stroke& s, const PenOptions& o) {
    pen(image, {}, image.rect(), std::vector<Stroke>{s}, o);
  };
  const Stroke line = {{{1.0F, 1.0F}}, {{6.0F, 6.0F}}};
  EXPECT_THROW(draw(line, options_of(ProfileShape::Step, 4.0F, 1.0F)), InvalidInput);
  PenOptions closed = options_of(ProfileShape::Step, 4.0F, 1.0F);
  closed.closed = true;
  EXPECT_THROW(draw(line, closed), InvalidInput);
  EXPECT_THROW(draw({{{nan, 0.0F}}}, options_of(ProfileShape::Bump, 4.0F, 1.0F)), InvalidInput);
  EXPECT_THROW(draw(line, options_of(ProfileShape::Bump, nan, 1.0F)), InvalidInput);
}

TEST(Pen, FarAwayStrokesAreHarmless) {
  const PenOptions o = options_of(ProfileShape::Bump, 10.0F, 4.0F);
  const Drawing d(64, 64, {{{{1e9F, -1e9F}}, {{2e9F, 3e9F}}}}, o);
  EXPECT_TRUE(d.changed.empty());
  EXPECT_EQ(d.slopes(5, 5), Vec2f(0.0F, 0.0F));
}

TEST(SmoothStroke, PassesThroughThePointsWithoutGaps) {
  const Stroke s = {{{0.0F, 0.0F}, 0.0F}, {{50.0F, 0.0F}, 1.0F}, {{50.0F, 50.0F}, 0.5F}};
  const Stroke open = smooth_stroke(s, 2.0F);
  EXPECT_EQ(open.front().position, s[0].position);
  EXPECT_EQ(open.back().position, s[2].position);
  for (std::size_t i = 1; i < open.size(); ++i) {
    EXPECT_LT((open[i].position - open[i - 1].position).norm(), 3.0F);
  }
  const Stroke closed = smooth_stroke(s, 2.0F, StrokeEnds::Closed);
  EXPECT_LT((closed.back().position - s[0].position).norm(), 3.0F);
  EXPECT_GT((closed.back().position - s[0].position).norm(), 0.5F);
}

}  // namespace
}  // namespace normalshop::test
