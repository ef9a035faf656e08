#pragma once

#include <limits>
#include <optional>

#include "style_fixtures.h"
#include "support/nan.h"
#include <gtest/gtest.h>

#include "normalshop/core/parallel.h"
#include "normalshop/core/random.h"
#include "normalshop/rgbn/rgbn_normals.h"

/// What every style promises besides its looks. draw(normals, target, region) runs it.
namespace normalshop::test {

template <class T, class Draw>
void expect_regions_and_threads_to_agree(const T& background, const Draw& draw) {
  const Image<Vec3f> normals = lively(157, 121);
  Image<T> whole(157, 121, background);
  EXPECT_EQ(draw(normals, whole, Rect{-9, -9, 999, 999}), whole.rect());
  const Rect region = {31, 40, 118, 77};
  Image<T> part(157, 121, background);
  EXPECT_EQ(draw(normals, part, region), region);
  EXPECT_TRUE(same_in(whole, part, region));
  EXPECT_TRUE(untouched_outside(part, region, background));
  EXPECT_FALSE(untouched_outside(whole, Rect{}, background));
  const ThreadLimit limit(1);
  Image<T> one(157, 121, background);
  draw(normals, one, one.rect());
  EXPECT_TRUE(same_in(whole, one, whole.rect()));
}

template <class T, class Draw>
void expect_edges_to_hold(const T& background, const Draw& draw) {
  Image<Vec3f> none;
  Image<T> nothing;
  EXPECT_TRUE(draw(none, nothing, Rect{0, 0, 5, 5}).empty());
  const Image<Vec3f> single(1, 1, Vec3f(0.0F, 0.0F, 1.0F));
  Image<T> pixel(1, 1, background);
  EXPECT_EQ(draw(single, pixel, pixel.rect()), pixel.rect());
  EXPECT_TRUE(draw(single, pixel, Rect{3, 3, 5, 5}).empty());
  // No direction, however it is written.
  Image<Vec3f> holes(40, 40, Vec3f(0.0F, 0.6F, 0.8F));
  holes(20, 20) = Vec3f::Zero();
  Image<T> with_zero(40, 40, background);
  draw(holes, with_zero, holes.rect());
  holes(20, 20) = Vec3f::Constant(nan);
  Image<T> with_nan(40, 40, background);
  draw(holes, with_nan, holes.rect());
  EXPECT_TRUE(same_in(with_zero, with_nan, holes.rect()));
}

inline bool is_finite(float value) { return std::isfinite(value); }
inline bool is_finite(const Vec3f& value) { return value.allFinite(); }

/// Every kind of vector without a direction, and some that face away, among those of lively().
inline Image<Vec3f> damaged(int width, int height) {
  const float inf = std::numeric_limits<float>::infinity();
  Image<Vec3f> normals = lively(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const auto bits = hash(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y), 5U);
      Vec3f& n = normals(x, y);
      if (bits % 16 == 0) n = {0.0F, nan, 1.0F};
      if (bits % 16 == 1) n = {nan, nan, nan};
      if (bits % 16 == 2) n = {inf, 0.0F, 1.0F};
      if (bits % 16 == 3) n = {0.0F, 0.0F, -inf};
      if (bits % 16 == 4) n = Vec3f::Zero();
      if (bits % 16 == 5) n.z() = -n.z();
    }
  }
  return normals;
}

/// Writes only numbers, whatever the normals; `in_gaps` where there is no direction.
template <class T, class Draw>
void expect_gaps_to_be_defined(const T& background, const std::optional<T>& in_gaps,
                               const Draw& draw) {
  for (const Image<Vec3f>& normals : {damaged(120, 90), Image<Vec3f>(70, 50, Vec3f::Zero()),
                                      Image<Vec3f>(70, 50, Vec3f::Constant(nan))}) {
    Image<T> out(normals.width(), normals.height(), background);
    draw(normals, out, out.rect());
    for (int y = 0; y < out.height(); ++y) {
      for (int x = 0; x < out.width(); ++x) {
        ASSERT_TRUE(is_finite(out(x, y))) << x << " " << y;
        const bool gap = !normals(x, y).allFinite() || normals(x, y).isZero(0.0F);
        ASSERT_TRUE(!gap || !in_gaps || same(out(x, y), *in_gaps)) << x << " " << y;
      }
    }
  }
}

/// What the mask of an RGBN image leaves out does not count, whatever its slopes.
template <class T, class Draw>
void expect_masked_pixels_not_to_count(const T& background, const Draw& draw) {
  const Image<Vec3f> normals = lively(120, 90);
  SlopeImage slopes(120, 90);
  MaskImage validity(120, 90, 1.0F);
  SlopeImage others(120, 90);
  for (int y = 0; y < 90; ++y) {
    for (int x = 0; x < 120; ++x) {
      slopes(x, y) = slope_from_normal(normals(x, y));
      if (std::hypot(x - 50, y - 40) < 20.0) validity(x, y) = 0.0F;
      others(x, y) = validity(x, y) > 0.0F ? slopes(x, y) : Vec2f(7.0F, -3.0F);
    }
  }
  const auto drawn = [&](const SlopeImage& image, const MaskImage& mask) {
    Image<Vec3f> seen(120, 90);
    normals_of({image, {}, mask}, seen, seen.rect());
    Image<T> out(120, 90, background);
    draw(seen, out, out.rect());
    return out;
  };
  const Image<T> masked = drawn(slopes, validity);
  EXPECT_TRUE(same_in(masked, drawn(others, validity), masked.rect()));
  EXPECT_FALSE(same_in(masked, drawn(others, {}), masked.rect()));
}

/// All of the above. `in_gaps`: what becomes of pixels without a direction, if that is one value.
template <class T, class Draw>
void expect_a_style(const T& background, const std::optional<T>& in_gaps, const Draw& draw) {
  expect_regions_and_threads_to_agree(background, draw);
  expect_edges_to_hold(background, draw);
  expect_gaps_to_be_defined(background, in_gaps, draw);
  expect_masked_pixels_not_to_count(background, draw);
}

}  // namespace normalshop::test
