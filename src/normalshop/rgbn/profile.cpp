#include "normalshop/rgbn/profile.h"

#include <algorithm>
#include <cmath>

#include "normalshop/core/error.h"

namespace normalshop {

namespace {

using Value = Profile::Value;

// All profiles end with slope and curvature 0: a kink at a stroke's border would be read
// differently from the texels left and right of a seam.

/// (1 - u^2)^3.
Value bump(float u) {
  const float s = 1.0F - u * u;
  return {s * s * s, -6.0F * u * s * s};
}

/// -(1 - a)^3 (1 - 2 a), a = |u|: straight into the valley, with shoulders slightly above 0.
Value crease(float u) {
  const float a = std::abs(u);
  const float s = 1.0F - a;
  const float slope = s * s * (5.0F - 8.0F * a);
  const float side = u > 0.0F ? 1.0F : (u < 0.0F ? -1.0F : 0.0F);
  return {-s * s * s * (1.0F - 2.0F * a), side * slope};
}

/// (1 - u^2)^3 (6 u^2 - 1): two fifths as wide as the stroke, lips 0.3 times as high as it is deep.
Value scratch(float u) {
  const float t = u * u;
  const float s = 1.0F - t;
  return {s * s * s * (6.0F * t - 1.0F), 2.0F * u * s * s * (9.0F - 24.0F * t)};
}

/// Quintic from 0 at -1 to 1 at 1: its curvature ends at 0 too.
Value step(float u) {
  const float t = 0.5F * (u + 1.0F);
  const float s = 1.0F - t;
  return {t * t * t * (10.0F - 15.0F * t + 6.0F * t * t), 15.0F * t * t * s * s};
}

void check(const Profile::Options& o) {
  if (o.shape == ProfileShape::Step && !o.closed) {
    throw InvalidInput("pen: the profile \"step\" changes the level, so it needs \"closed\": true");
  }
  if (o.shape != ProfileShape::Custom) return;
  if (o.curve.empty()) throw InvalidInput("pen: the profile \"custom\" needs a \"curve\"");
  if (o.curve.points().front().x() < -1.0F || o.curve.points().back().x() > 1.0F) {
    throw InvalidInput("pen: the points of \"curve\" must have u between -1 and 1");
  }
}

}  // namespace

Profile::Profile(const Options& options)
    : shape_(options.shape), curve_(options.curve), closed_(options.closed) {
  check(options);
  if (shape_ == ProfileShape::Step) level_ = 1.0F;
  if (shape_ != ProfileShape::Custom) return;
  first_ = curve_.value(-1.0F);
  last_ = curve_.value(1.0F);
  if (closed_) level_ = last_ - first_;
}

Profile::Value Profile::custom(float u) const {
  const Value ramp = step(u);
  const float correction = closed_ ? 0.0F : last_ - first_;
  return {curve_.value(u) - first_ - correction * ramp.height,
          curve_.derivative(u) - correction * ramp.slope};
}

Profile::Value Profile::at(float u) const {
  if (u <= -1.0F) return {0.0F, 0.0F};
  if (u >= 1.0F) return {level_, 0.0F};
  switch (shape_) {
    case ProfileShape::Bump:
      return bump(u);
    case ProfileShape::Crease:
      return crease(u);
    case ProfileShape::Scratch:
      return scratch(u);
    case ProfileShape::Step:
      return step(u);
    case ProfileShape::Custom:
      break;
  }
  return custom(u);
}

Profile::Value Profile::at(float u, float radius) const {
  Value value = at(u);
  if (shape_ == ProfileShape::Crease && std::abs(u) < radius) {
    value.slope = (at(u + radius).height - at(u - radius).height) / (2.0F * radius);
  }
  return value;
}

}  // namespace normalshop
