#include <cmath>
#include <limits>

#include "style_checks.h"
#include "support/slope_fields.h"
#include <gtest/gtest.h>

#include "normalshop/core/error.h"
#include "normalshop/rgbn/shade_lines.h"

namespace normalshop::test {
namespace {

struct Found {
  MaskImage contours, suggestive, ridges, valleys;
};

Found find(const Image<Vec3f>& normals, const LineOptions& options = {}) {
  const int w = normals.width();
  const int h = normals.height();
  Found f{MaskImage(w, h), MaskImage(w, h), MaskImage(w, h), MaskImage(w, h)};
  find_lines(normals, {f.contours, f.suggestive, f.ridges, f.valleys}, normals.rect(), options);
  return f;
}

/// Middle and width of the line that a row crosses between two columns.
struct Profile1D {
  double middle = 0.0;
  double width = 0.0;
};
Profile1D across(const MaskImage& line, int y, int x0, int x1) {
  Profile1D p;
  for (int x = x0; x < x1; ++x) {
    p.width += static_cast<double>(line(x, y));
    p.middle += x * static_cast<double>(line(x, y));
  }
  p.middle /= p.width;
  return p;
}

TEST(ShadeLines, APlaneHasNone) {
  const Found f = find(Image<Vec3f>(90, 70, tilted(0.8, -0.3)));
  for (const MaskImage* line : {&f.contours, &f.suggestive, &f.ridges, &f.valleys}) {
    EXPECT_EQ(area(*line), 0.0);
  }
}

TEST(ShadeLines, NothingHasNone) {
  const Image<Vec3f> normals(90, 70, Vec3f::Zero());
  const Found f = find(normals);
  for (const MaskImage* line : {&f.contours, &f.suggestive, &f.ridges, &f.valleys}) {
    EXPECT_EQ(area(*line), 0.0);
  }
  ColorImage out(90, 70, Vec3f::Zero());
  shade_lines(normals, out, out.rect());
  EXPECT_TRUE(same_in(out, ColorImage(90, 70, Vec3f(Vec3f::Ones())), out.rect()));
}

TEST(ShadeLines, ABallHasAnOutlineAndNothingElse) {
  const double radius = 60.0;
  const Found f = find(ball(161, radius));
  EXPECT_EQ(area(f.suggestive), 0.0);
  EXPECT_EQ(area(f.ridges), 0.0);
  EXPECT_EQ(area(f.valleys), 0.0);
  for (int k = 0; k < 64; ++k) {
    const double angle = 2.0 * 3.14159265358979 * k / 64.0;
    const auto at = [&](double r) {
      return f.contours(static_cast<int>(std::lround(80 + r * std::cos(angle))),
                        static_cast<int>(std::lround(80 + r * std::sin(angle))));
    };
    EXPECT_GT(std::max(at(radius), at(radius - 1.0)), 0.7F) << k;
    EXPECT_EQ(at(radius - 6.0), 0.0F) << k;
    EXPECT_EQ(at(radius + 4.0), 0.0F) << k;
  }
}

TEST(ShadeLines, RoofAndGutterAreARidgeAndAValley) {
  // The edges run up between two pixels, so their middle is at 79.5.
  const auto roof = [](double turn) {
    return picture_of(160, 60,
                      [&](double x, double) { return tilted(x < 0.0 ? turn : -turn, 0.1); });
  };
  const LineOptions options{.width = 3.0F};
  const Found ridge = find(roof(0.5), options);
  EXPECT_NEAR(across(ridge.ridges, 30, 0, 160).middle, 79.5, 0.05);
  EXPECT_NEAR(across(ridge.ridges, 30, 0, 160).width, 3.0, 0.35);
  EXPECT_EQ(area(ridge.valleys), 0.0);
  EXPECT_EQ(area(ridge.contours), 0.0);
  const Found valley = find(roof(-0.5), options);
  EXPECT_NEAR(across(valley.valleys, 30, 0, 160).middle, 79.5, 0.05);
  EXPECT_EQ(area(valley.ridges), 0.0);
  // A crease of 5 degrees is less than the limit of 15.
  EXPECT_EQ(area(find(roof(std::tan(2.5 * 3.14159 / 180.0)), options).ridges), 0.0);
}

TEST(ShadeLines, RidgesAreSmoothAtAnyAngle) {
  const double turn = 0.4;  // radians
  const auto normals = picture_of(161, 161, [&](double x, double y) {
    const double side = x * std::cos(turn) + y * std::sin(turn) < 0.0 ? 0.6 : -0.6;
    return tilted(side * std::cos(turn), side * std::sin(turn));
  });
  const MaskImage line = find(normals).ridges;
  for (int y = 20; y < 141; ++y) {
    const Profile1D p = across(line, y, 0, 161);
    EXPECT_NEAR(p.width * std::cos(turn), 2.0, 0.35) << y;
    EXPECT_NEAR(p.middle, 80.0 - (80 - y) * std::tan(turn), 0.6) << y;
  }
}

TEST(ShadeLines, SuggestiveContoursOfABump) {
  // z = 40 exp(-r^2 / (2 s^2)) is steepest at r = s, where n3 is least along (n1, n2).
  const double s = 30.0;
  const auto normals = picture_of(201, 201, [&](double x, double y) {
    const double g = -40.0 / (s * s) * std::exp(-0.5 * (x * x + y * y) / (s * s));
    return tilted(g * x, g * y);
  });
  for (const float sigma : {0.5F, 1.0F, 2.0F}) {
    // Smoothing widens the bump; 30.25 is where the smoothed n3 is least at sigma 3, by summing up.
    const double radius = s + 0.25 * static_cast<double>(sigma * sigma) / 9.0;
    const LineOptions options{.sigma = sigma, .dip = 0.002F * sigma * sigma / 9.0F};
    const MaskImage line = find(normals, options).suggestive;
    EXPECT_NEAR(across(line, 100, 105, 200).middle, 100.0 + radius, 0.1) << sigma;
    EXPECT_NEAR(across(line, 100, 0, 95).middle, 100.0 - radius, 0.1) << sigma;
  }
  const MaskImage line = find(normals, {.dip = 0.002F}).suggestive;
  EXPECT_NEAR(across(line, 100, 105, 200).middle, 100.0 + s + 0.25, 0.1);
  EXPECT_NEAR(across(line, 100, 0, 95).middle, 100.0 - s - 0.25, 0.1);
  EXPECT_NEAR(across(line, 100, 105, 200).width, 2.0, 0.4);
  for (int k = 0; k < 40; ++k) {
    const double angle = 2.0 * 3.14159265358979 * k / 40.0;
    const auto at = [&](double r) {
      return line(static_cast<int>(std::lround(100 + r * std::cos(angle))),
                  static_cast<int>(std::lround(100 + r * std::sin(angle))));
    };
    EXPECT_GT(at(s), 0.5F) << k;
    EXPECT_EQ(at(s - 8.0), 0.0F) << k;
    EXPECT_EQ(at(s + 8.0), 0.0F) << k;
  }
}

TEST(ShadeLines, ARimBeforeAnotherSurfaceIsAContour) {
  const auto normals = picture_of(161, 161, [](double x, double y) {
    const double z2 = 900.0 - x * x - y * y;
    if (z2 <= 0.0) return Vec3f(0.0F, 0.0F, 1.0F);
    return Vec3f((Vec3d(x, y, std::sqrt(z2)) / 30.0).cast<float>());
  });
  const MaskImage line = find(normals).contours;
  EXPECT_GT(line(80 + 29, 80), 0.7F);
  EXPECT_GT(line(80, 80 - 29), 0.7F);
  EXPECT_EQ(line(80 + 20, 80), 0.0F);
  EXPECT_EQ(line(80 + 36, 80), 0.0F);
}

TEST(ShadeLines, WeakPartsGoOnFromStrongOnesOnly) {
  // A crease that turns by 24 degrees in the upper half and by 10 in the lower one.
  const auto crease = [](double upper, double lower) {
    return picture_of(121, 161, [&](double x, double y) {
      const double t = std::tan(0.5 * (y > 0.0 ? upper : lower) * 3.14159265 / 180.0);
      return tilted(x < 0.0 ? t : -t, 0.0);
    });
  };
  LineOptions options;
  options.connect = 30.0F;
  const MaskImage joined = find(crease(24.0, 10.0), options).ridges;
  EXPECT_GT(across(joined, 40, 0, 121).width, 1.2);
  EXPECT_GT(across(joined, 90, 0, 121).width, 0.02);
  EXPECT_EQ(across(joined, 130, 0, 121).width, 0.0);  // farther than connect
  options.connect = 0.0F;
  EXPECT_EQ(across(find(crease(24.0, 10.0), options).ridges, 95, 0, 121).width, 0.0);
  EXPECT_EQ(area(find(crease(10.0, 10.0), options).ridges), 0.0);
}

TEST(ShadeLines, InkOnPaper) {
  const auto normals = ball(101, 40.0);
  ColorImage out(101, 101, Vec3f(0.5F, 0.6F, 0.7F));
  LineOptions options;
  shade_lines(normals, out, out.rect(), options);
  EXPECT_EQ(out(0, 0), Vec3f(Vec3f::Ones()));
  EXPECT_EQ(out(50, 50), Vec3f(Vec3f::Ones()));
  EXPECT_LT(std::min(out(50 + 40, 50).x(), out(50 + 39, 50).x()), 0.2F);
  options.paper = LinePaper::Keep;
  const ColorImage before(101, 101, Vec3f(0.5F, 0.6F, 0.7F));
  ColorImage kept = before;
  shade_lines(normals, kept, kept.rect(), options);
  EXPECT_EQ(kept(50, 50), before(50, 50));
  EXPECT_LT(std::min(kept(50 + 40, 50).x(), kept(50 + 39, 50).x()), 0.2F);
}

TEST(ShadeLines, NeutralOptionsLeaveThePicture) {
  const auto normals = lively(90, 70);
  const ColorImage before(90, 70, Vec3f(0.5F, 0.6F, 0.7F));
  LineOptions options;
  options.paper = LinePaper::Keep;
  ColorImage drawn = before;
  shade_lines(normals, drawn, drawn.rect(), options);
  EXPECT_FALSE(same_in(drawn, before, before.rect()));
  ColorImage no_width = before;
  options.width = 0.0F;
  shade_lines(normals, no_width, no_width.rect(), options);
  EXPECT_TRUE(same_in(no_width, before, before.rect()));
  options = {.contours = 0.0F,
             .suggestive = 0.0F,
             .ridges = 0.0F,
             .valleys = 0.0F,
             .paper = LinePaper::Keep};
  ColorImage no_ink = before;
  shade_lines(normals, no_ink, no_ink.rect(), options);
  EXPECT_TRUE(same_in(no_ink, before, before.rect()));
}

TEST(ShadeLines, RegionsThreadsEdgesAndGaps) {
  const auto draw = [](ImageView<Vec3f> normals, ColorSpan target, Rect region) {
    LineOptions options;
    options.sigma = 1.0F;
    options.connect = 3.0F;
    options.shortest = 4.0F;
    options.ridges = 1.0F;
    return shade_lines(normals, target, region, options);
  };
  const Vec3f background(0.1F, 0.2F, 7.0F);
  expect_a_style(background, std::optional<Vec3f>(), draw);
}

TEST(ShadeLines, RejectsOptionsOutOfRange) {
  const Image<Vec3f> normals(1, 1, Vec3f(0.0F, 0.0F, 1.0F));
  ColorImage out(1, 1);
  using Options = LineOptions;
  for (float Options::*member :
       {&Options::width, &Options::sigma, &Options::contours, &Options::suggestive,
        &Options::ridges, &Options::valleys, &Options::jump, &Options::dip, &Options::crease,
        &Options::connect}) {
    Options options;
    options.*member = std::numeric_limits<float>::quiet_NaN();
    EXPECT_THROW(shade_lines(normals, out, out.rect(), options), InvalidInput);
  }
}

}  // namespace
}  // namespace normalshop::test
