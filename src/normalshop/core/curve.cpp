#include "normalshop/core/curve.h"

#include <algorithm>
#include <cmath>

#include "normalshop/core/error.h"

namespace normalshop {

namespace {

void check(const std::vector<Vec2f>& points) {
  if (points.empty()) throw InvalidInput("a curve needs at least one point");
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!points[i].allFinite()) throw InvalidInput("a curve's points must be finite numbers");
    if (i > 0 && points[i].x() <= points[i - 1].x()) {
      throw InvalidInput("a curve's points must have increasing x");
    }
  }
}

/// Harmonic mean of neighbouring secants where they agree in sign, else 0.
float inner_tangent(const Vec2f& a, const Vec2f& b, const Vec2f& c) {
  const float h0 = b.x() - a.x();
  const float h1 = c.x() - b.x();
  const float s0 = (b.y() - a.y()) / h0;
  const float s1 = (c.y() - b.y()) / h1;
  if (s0 * s1 <= 0.0F) return 0.0F;
  const float w0 = 2.0F * h1 + h0;
  const float w1 = h1 + 2.0F * h0;
  return (w0 + w1) / (w0 / s0 + w1 / s1);
}

}  // namespace

struct Curve::Piece {
  std::size_t index;
  float width;
  float t;
  bool outside;
};

Curve::Curve(std::vector<Vec2f> points) : points_(std::move(points)) {
  check(points_);
  tangents_.assign(points_.size(), 0.0F);
  for (std::size_t i = 1; i + 1 < points_.size(); ++i) {
    tangents_[i] = inner_tangent(points_[i - 1], points_[i], points_[i + 1]);
  }
}

Curve::Piece Curve::piece(float x) const {
  // Not x <= front: what is not a number counts as before the first point.
  if (points_.size() < 2 || !(x > points_.front().x())) return {0, 1.0F, 0.0F, true};
  if (x >= points_.back().x()) return {points_.size() - 1, 1.0F, 0.0F, true};
  const auto after = std::upper_bound(points_.begin(), points_.end(), x,
                                      [](float value, const Vec2f& p) { return value < p.x(); });
  const auto i = static_cast<std::size_t>(after - points_.begin()) - 1;
  const float width = points_[i + 1].x() - points_[i].x();
  return {i, width, (x - points_[i].x()) / width, false};
}

float Curve::value(float x) const {
  if (points_.empty()) return 0.0F;
  const Piece p = piece(x);
  if (p.outside) return points_[p.index].y();
  const float t2 = p.t * p.t;
  const float t3 = t2 * p.t;
  const float rise = 3.0F * t2 - 2.0F * t3;
  return points_[p.index].y() * (1.0F - rise) + points_[p.index + 1].y() * rise +
         p.width *
             ((t3 - 2.0F * t2 + p.t) * tangents_[p.index] + (t3 - t2) * tangents_[p.index + 1]);
}

float Curve::derivative(float x) const {
  if (points_.empty()) return 0.0F;
  const Piece p = piece(x);
  if (p.outside) return 0.0F;
  const float t2 = p.t * p.t;
  const float secant = (points_[p.index + 1].y() - points_[p.index].y()) / p.width;
  return 6.0F * (p.t - t2) * secant + (3.0F * t2 - 4.0F * p.t + 1.0F) * tangents_[p.index] +
         (3.0F * t2 - 2.0F * p.t) * tangents_[p.index + 1];
}

}  // namespace normalshop
