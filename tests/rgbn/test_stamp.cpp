#include <cmath>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "normalshop/core/error.h"
#include "normalshop/core/parallel.h"
#include "normalshop/core/random.h"
#include "normalshop/core/slope.h"
#include "normalshop/rgbn/stamp.h"

namespace normalshop::test {
namespace {

Patch noise_patch(int width, int height) {
  Patch patch;
  patch.slopes.resize(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const auto bits = hash(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y), 5U);
      patch.slopes(x, y) = {static_cast<float>(bits & 0xffffU) * 1e-4F - 3.0F,
                            static_cast<float>(bits >> 16U) * 1e-4F - 3.0F};
    }
  }
  return patch;
}

/// Slopes of exp(-r^2 / 2 s^2) * height, centred.
Patch bump_patch(int size, float s, float height) {
  Patch patch;
  patch.slopes.resize(size, size);
  const float c = 0.5F * static_cast<float>(size - 1);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const float dx = static_cast<float>(x) - c;
      const float dy = c - static_cast<float>(y);
      const float h = height * std::exp(-0.5F * (dx * dx + dy * dy) / (s * s));
      patch.slopes(x, y) = {-dx / (s * s) * h, -dy / (s * s) * h};
    }
  }
  return patch;
}

StampOptions exact() {
  StampOptions o;
  o.border = 0.0F;
  return o;
}

SlopeImage stamped(const Patch& patch, int width, int height, const StampOptions& o) {
  SlopeImage out(width, height);
  const Vec2f center(0.5F * static_cast<float>(width - 1), 0.5F * static_cast<float>(height - 1));
  stamp(out, {}, out.rect(), patch, center, o);
  return out;
}

TEST(Stamp, IsTheIdentityAtOneToOne) {
  const Patch patch = noise_patch(13, 8);
  const SlopeImage out = stamped(patch, 13, 8, exact());
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 13; ++x) EXPECT_EQ(out(x, y), patch.slopes(x, y));
  }
}

TEST(Stamp, FourQuarterTurnsAreTheIdentity) {
  const Patch original = noise_patch(13, 8);
  Patch turned = original;
  StampOptions o = exact();
  o.rotation = 90.0F;
  for (int i = 0; i < 4; ++i) {
    Patch next;
    next.slopes = stamped(turned, turned.slopes.height(), turned.slopes.width(), o);
    turned = next;
    if (i == 0) {  // counter-clockwise: what pointed right points up
      EXPECT_EQ(turned.slopes(0, 12), Vec2f(-original.slopes(0, 0).y(), original.slopes(0, 0).x()));
    }
  }
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 13; ++x) EXPECT_EQ(turned.slopes(x, y), original.slopes(x, y));
  }
}

TEST(Stamp, MirrorsTwiceIsTheIdentity) {
  const Patch original = noise_patch(9, 6);
  StampOptions o = exact();
  o.scale_x = -1.0F;
  Patch mirrored;
  mirrored.slopes = stamped(original, 9, 6, o);
  EXPECT_EQ(mirrored.slopes(0, 0), Vec2f(-original.slopes(8, 0).x(), original.slopes(8, 0).y()));
  const SlopeImage back = stamped(mirrored, 9, 6, o);
  EXPECT_EQ(back(4, 3), original.slopes(4, 3));
}

/// Largest angle between a stamped bump and the transformed bump's own slopes.
double bump_error(const StampOptions& o, float heights) {
  constexpr int size = 96;
  constexpr float s = 10.0F;
  constexpr float height = 6.0F;
  const Patch patch = bump_patch(size, s, height);
  const SlopeImage out = stamped(patch, 200, 200, o);
  const Mat2f placed = placement_matrix(o);
  const float scale = o.size > 0.0F ? o.size / size : 1.0F;
  Mat2f inverse = (scale * placed).inverse();
  double worst = 0.0;
  for (int y = 0; y < 200; ++y) {
    for (int x = 0; x < 200; ++x) {
      const Vec2f p(static_cast<float>(x) - 99.5F, 99.5F - static_cast<float>(y));
      const Vec2f q = inverse * p;
      if (q.cwiseAbs().maxCoeff() > 46.0F) continue;
      const float h = heights * height * std::exp(-0.5F * q.squaredNorm() / (s * s));
      const Vec2f expected = inverse.transpose() * Vec2f(-h / (s * s) * q);
      worst =
          std::max(worst, angle_degrees(normal_from_slope(out(x, y)), normal_from_slope(expected)));
    }
  }
  return worst;
}

TEST(Stamp, TransformsGradientsByTheInverseTranspose) {
  StampOptions o = exact();
  o.rotation = 33.0F;
  EXPECT_LT(bump_error(o, 1.0F), 0.05);
  o.scale_x = 1.8F;
  o.scale_y = -0.9F;
  EXPECT_LT(bump_error(o, 1.0F), 0.2);
  o.shear = 0.4F;
  EXPECT_LT(bump_error(o, 1.0F), 0.2);
  o.heights = StampHeights::Grow;
  EXPECT_LT(bump_error(o, std::sqrt(1.8F * 0.9F)), 0.2);
}

TEST(Stamp, SizeScalesHeightsAlong) {
  StampOptions o = exact();
  for (const float size : {40.0F, 96.0F, 170.0F}) {
    o.size = size;
    EXPECT_LT(bump_error(o, size / 96.0F), 0.5) << size;
  }
}

TEST(Stamp, ShrinkingAverages) {
  Patch patch;
  patch.slopes.resize(256, 256);
  for (int y = 0; y < 256; ++y) {
    for (int x = 0; x < 256; ++x) {
      patch.slopes(x, y) = (x + y) % 2 == 0 ? Vec2f(1.0F, 0.0F) : Vec2f(-1.0F, 0.5F);
    }
  }
  StampOptions o = exact();
  o.size = 32.0F;
  const SlopeImage out = stamped(patch, 32, 32, o);
  EXPECT_NEAR(out(16, 16).x(), 0.0F, 0.02F);
  EXPECT_NEAR(out(16, 16).y(), 0.25F, 0.02F);
}

TEST(Stamp, FadesAtItsBorderAndClearsTheRest) {
  Patch patch;
  patch.slopes = SlopeImage(20, 20, Vec2f(1.0F, 0.0F));
  patch.color = ColorImage(20, 20, Vec3f(1.0F, 0.5F, 0.0F));
  StampOptions o;
  o.border = 0.25F;
  SlopeImage out(60, 60, Vec2f::Constant(9.0F));
  MaskImage coverage(60, 60, 9.0F);
  const Rect changed = stamp(out, coverage, out.rect(), patch, {30.0F, 30.0F}, o);
  EXPECT_EQ(coverage(30, 30), 1.0F);
  EXPECT_EQ(out(30, 30), Vec2f(1.0F, 0.0F));
  EXPECT_LT(coverage(21, 30), 0.15F);
  EXPECT_FLOAT_EQ(out(22, 30).x(), coverage(22, 30));
  for (int y = 0; y < 60; ++y) {
    for (int x = 0; x < 60; ++x) {
      EXPECT_TRUE(changed.contains(x, y) || coverage(x, y) == 0.0F);
    }
  }
  ColorImage color(60, 60, Vec3f::Zero());
  stamp_color(color, color.rect(), patch, {30.0F, 30.0F}, o);
  EXPECT_EQ(color(30, 30), Vec3f(1.0F, 0.5F, 0.0F));
  EXPECT_EQ(color(2, 2), Vec3f(0.0F, 0.0F, 0.0F));
}

/// Slopes of sin(2 pi x / 16) sin(2 pi y / 16), y up from the middle, on one period.
Vec2f wave_slope(float x, float y) {
  const float w = 6.2831853F / 16.0F;
  return {w * std::cos(w * x) * std::sin(w * y), w * std::sin(w * x) * std::cos(w * y)};
}

Patch wave_patch() {
  Patch patch;
  patch.slopes.resize(16, 16);
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 16; ++x) {
      patch.slopes(x, y) = wave_slope(static_cast<float>(x) - 7.5F, 7.5F - static_cast<float>(y));
    }
  }
  return patch;
}

TEST(StampRepeated, IsTheRepeatedPatchAtOneToOne) {
  const Patch patch = noise_patch(13, 8);
  SlopeImage out(40, 30);
  const Vec2f center(6.0F, 3.5F);
  EXPECT_EQ(stamp_repeated(out, {}, {-9, 0, 99, 99}, patch, center), out.rect());
  for (int y = 0; y < 30; ++y) {
    for (int x = 0; x < 40; ++x) EXPECT_EQ(out(x, y), patch.slopes(x % 13, y % 8));
  }
}

TEST(StampRepeated, TransformsAWaveWithoutSeams) {
  const Patch patch = wave_patch();
  StampOptions o;
  o.size = 37.0F;
  o.rotation = 33.0F;
  o.scale_x = -1.3F;
  o.shear = 0.4F;
  o.relief = -0.5F;
  SlopeImage out(200, 150);
  const Vec2f center(91.3F, 60.7F);
  stamp_repeated(out, {}, out.rect(), patch, center, o);
  const Mat2f inverse = placement_matrix(o).inverse();
  double worst = 0.0;
  for (int y = 0; y < 150; ++y) {
    for (int x = 0; x < 200; ++x) {
      const Vec2f p(static_cast<float>(x) - center.x(), center.y() - static_cast<float>(y));
      const Vec2f q = inverse * p * (16.0F / 37.0F);
      const Vec2f expected = -0.5F * (inverse.transpose() * wave_slope(q.x(), q.y()));
      worst =
          std::max(worst, angle_degrees(normal_from_slope(out(x, y)), normal_from_slope(expected)));
    }
  }
  EXPECT_LT(worst, 0.2);
}

TEST(StampRepeated, CopiesSmallerThanAPixelAreTheMean) {
  Patch patch = wave_patch();
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 16; ++x) patch.slopes(x, y) += Vec2f(0.25F, -0.5F);
  }
  patch.opacity = MaskImage(16, 16, 0.5F);
  StampOptions o;
  for (const float size : {1.0F, 0.37F, 1e-3F}) {
    o.size = size;
    SlopeImage out(9, 9);
    MaskImage coverage(9, 9);
    stamp_repeated(out, coverage, out.rect(), patch, {4.0F, 4.0F}, o);
    EXPECT_NEAR(out(7, 2).x(), 0.125F, 0.01F) << size;
    EXPECT_NEAR(out(7, 2).y(), -0.25F, 0.01F) << size;
    EXPECT_NEAR(coverage(7, 2), 0.5F, 1e-5F);
  }
}

TEST(StampRepeated, ARegionGivesThePixelsOfTheWholeForAnyNumberOfThreads) {
  const Patch patch = noise_patch(13, 8);
  StampOptions o;
  o.size = 9.0F;
  o.rotation = 20.0F;
  SlopeImage whole(60, 50);
  SlopeImage part(60, 50, Vec2f::Constant(9.0F));
  stamp_repeated(whole, {}, whole.rect(), patch, {30.0F, 20.0F}, o);
  const Rect region = {11, 7, 40, 33};
  const ThreadLimit limit(1);
  EXPECT_EQ(stamp_repeated(part, {}, region, patch, {30.0F, 20.0F}, o), region);
  for (int y = 0; y < 50; ++y) {
    for (int x = 0; x < 60; ++x) {
      const bool inside = region.contains(x, y);
      EXPECT_EQ(part(x, y), inside ? whole(x, y) : Vec2f(Vec2f::Constant(9.0F)));
    }
  }
  EXPECT_TRUE(stamp_repeated(part, {}, {70, 0, 80, 9}, patch, {30.0F, 20.0F}, o).empty());
}

TEST(Stamp, RejectsBadInput) {
  SlopeImage out(8, 8);
  EXPECT_THROW(stamp(out, {}, out.rect(), {}, {4.0F, 4.0F}), InvalidInput);
  EXPECT_THROW(stamp_repeated(out, {}, out.rect(), {}, {4.0F, 4.0F}), InvalidInput);
  Patch patch = noise_patch(4, 4);
  StampOptions o;
  o.scale_x = 0.0F;
  EXPECT_THROW(stamp(out, {}, out.rect(), patch, {4.0F, 4.0F}, o), InvalidInput);
  patch.opacity = MaskImage(3, 3, 1.0F);
  EXPECT_THROW(stamp(out, {}, out.rect(), patch, {4.0F, 4.0F}), InvalidInput);
}

}  // namespace
}  // namespace normalshop::test
