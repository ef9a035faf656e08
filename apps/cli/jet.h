#pragma once

#include <algorithm>
#include <cmath>

#include <Eigen/Core>

#include "normalshop/core/vec.h"

/// Numbers that carry their gradient in space (automatic differentiation, forward), so that a
/// procedural height gives its exact normals in one evaluation.
namespace normalshop::demo {

class Jet {
 public:
  Jet() : q_(0.0F, 0.0F, 0.0F, 0.0F) {}
  Jet(float value) : q_(0.0F, 0.0F, 0.0F, value) {}
  Jet(const Eigen::Array4f& gradient_and_value) : q_(gradient_and_value) {}

  float value() const { return q_[3]; }
  Vec3f gradient() const { return q_.head<3>(); }
  const Eigen::Array4f& all() const { return q_; }
  /// f(this), from f's value and derivative here.
  Jet chain(float f, float derivative) const {
    Jet r(Eigen::Array4f(q_ * derivative));
    r.q_[3] = f;
    return r;
  }

 private:
  Eigen::Array4f q_;  ///< gradient, then value
};

inline Jet operator+(const Jet& a, const Jet& b) { return Eigen::Array4f(a.all() + b.all()); }
inline Jet operator-(const Jet& a, const Jet& b) { return Eigen::Array4f(a.all() - b.all()); }
inline Jet operator-(const Jet& a) { return Eigen::Array4f(-a.all()); }
inline Jet operator*(const Jet& a, float b) { return Eigen::Array4f(a.all() * b); }
inline Jet operator*(float b, const Jet& a) { return a * b; }
inline Jet operator+(const Jet& a, float b) { return a + Jet(b); }
inline Jet operator-(const Jet& a, float b) { return a - Jet(b); }
inline Jet operator*(const Jet& a, const Jet& b) {
  Eigen::Array4f q = a.all() * b.value() + b.all() * a.value();
  q[3] = a.value() * b.value();
  return q;
}
inline Jet operator/(const Jet& a, const Jet& b) {
  const float f = a.value() / b.value();
  Eigen::Array4f q = (a.all() - b.all() * f) / b.value();
  q[3] = f;
  return q;
}

inline Jet sqrt(const Jet& a) {
  const float root = std::sqrt(std::max(a.value(), 1e-12F));
  return a.chain(root, 0.5F / root);
}
inline Jet sin(const Jet& a) { return a.chain(std::sin(a.value()), std::cos(a.value())); }
inline Jet cos(const Jet& a) { return a.chain(std::cos(a.value()), -std::sin(a.value())); }
inline Jet abs(const Jet& a) { return a.value() < 0.0F ? -a : a; }
inline Jet min(const Jet& a, const Jet& b) { return b.value() < a.value() ? b : a; }
inline Jet max(const Jet& a, const Jet& b) { return b.value() > a.value() ? b : a; }
inline Jet atan2(const Jet& y, const Jet& x) {
  const float scale = 1.0F / std::max(x.value() * x.value() + y.value() * y.value(), 1e-12F);
  Eigen::Array4f q = (y.all() * x.value() - x.all() * y.value()) * scale;
  q[3] = std::atan2(y.value(), x.value());
  return q;
}
inline Jet acos(const Jet& a) {
  const float c = std::clamp(a.value(), -0.99999F, 0.99999F);
  return a.chain(std::acos(c), -1.0F / std::sqrt(1.0F - c * c));
}

inline Jet smoothstep(float low, float high, const Jet& x) {
  const float t = std::clamp((x.value() - low) / (high - low), 0.0F, 1.0F);
  return x.chain(t * t * (3.0F - 2.0F * t), 6.0F * t * (1.0F - t) / (high - low));
}
/// Round hill: 1 at 0, 0 from |x| = width on, smooth everywhere.
inline Jet hill(const Jet& x, float width) {
  const float t = 1.0F - std::min(1.0F, x.value() * x.value() / (width * width));
  return x.chain(t * t, -4.0F * t * x.value() / (width * width));
}

/// Smooth minimum: differs from min() where |a - b| < k (cubic: the second derivative is
/// continuous too).
inline Jet smooth_min(const Jet& a, const Jet& b, float k) {
  const float h = std::max(k - std::abs(a.value() - b.value()), 0.0F) / k;
  if (h == 0.0F) return min(a, b);
  const Jet far = abs(a - b);
  const Jet t = (Jet(k) - far) * (1.0F / k);
  return min(a, b) - t * t * t * (k / 6.0F);
}
inline Jet smooth_max(const Jet& a, const Jet& b, float k) { return -smooth_min(-a, -b, k); }

struct JetPoint {
  Jet x;
  Jet y;
  Jet z;

  /// The point itself, as a function of the point.
  static JetPoint at(const Vec3f& p) {
    return {Jet({1.0F, 0.0F, 0.0F, p.x()}), Jet({0.0F, 1.0F, 0.0F, p.y()}),
            Jet({0.0F, 0.0F, 1.0F, p.z()})};
  }
  Vec3f value() const { return {x.value(), y.value(), z.value()}; }
};

inline JetPoint operator-(const JetPoint& p, const Vec3f& v) {
  return {p.x - v.x(), p.y - v.y(), p.z - v.z()};
}
inline JetPoint operator+(const JetPoint& p, const Vec3f& v) { return p - Vec3f(-v); }
inline JetPoint operator*(const JetPoint& p, float s) { return {p.x * s, p.y * s, p.z * s}; }
inline JetPoint scaled(const JetPoint& p, const Vec3f& s) {
  return {p.x * s.x(), p.y * s.y(), p.z * s.z()};
}
inline Jet dot(const JetPoint& p, const Vec3f& v) {
  return p.x * v.x() + p.y * v.y() + p.z * v.z();
}
inline Jet length(const JetPoint& p) { return sqrt(p.x * p.x + p.y * p.y + p.z * p.z); }
inline Jet length(const Jet& x, const Jet& y) { return sqrt(x * x + y * y); }

}  // namespace normalshop::demo
