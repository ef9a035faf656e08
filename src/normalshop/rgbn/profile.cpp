#include "normalshop/rgbn/profile.h"

#include <algorithm>
#include <cmath>

#include <hwy/highway.h>

#include "normalshop/core/error.h"
#include "normalshop/rgbn/detail/profile-inl.h"

HWY_BEFORE_NAMESPACE();
namespace normalshop::HWY_NAMESPACE {

/// One of many.
Profile::Value ShapeAt(ProfileShape shape, float level, float u) {
  const hn::CappedTag<float, 1> d;
  const auto value = shape_at(d, shape, level, hn::Set(d, u));
  return {hn::GetLane(value.height), hn::GetLane(value.slope)};
}

}  // namespace normalshop::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

namespace normalshop {

namespace {

using Value = Profile::Value;

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
  const Value ramp = HWY_STATIC_DISPATCH(ShapeAt)(ProfileShape::Step, 1.0F, u);
  const float correction = closed_ ? 0.0F : last_ - first_;
  return {curve_.value(u) - first_ - correction * ramp.height,
          curve_.derivative(u) - correction * ramp.slope};
}

Profile::Value Profile::at(float u) const {
  if (u <= -1.0F) return {0.0F, 0.0F};
  if (u >= 1.0F) return {level_, 0.0F};
  if (shape_ == ProfileShape::Custom) return custom(u);
  return HWY_STATIC_DISPATCH(ShapeAt)(shape_, level_, u);
}

Profile::Value Profile::at(float u, float radius) const {
  Value value = at(u);
  if (shape_ == ProfileShape::Crease && std::abs(u) < radius) {
    value.slope = (at(u + radius).height - at(u - radius).height) / (2.0F * radius);
  }
  return value;
}

}  // namespace normalshop
