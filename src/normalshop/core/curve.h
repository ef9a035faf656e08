#pragma once

#include <vector>

#include "normalshop/core/vec.h"

namespace normalshop {

/// A function through points, continuous with its derivative, that never overshoots them
/// (monotone cubic Hermite with weighted harmonic means of the neighbouring slopes as tangents,
/// Fritsch and Butland 1984). Constant outside the first and last point.
class Curve {
 public:
  Curve() = default;
  /// Points (x, y) with strictly increasing x, at least one. Throws InvalidInput otherwise.
  explicit Curve(std::vector<Vec2f> points);

  bool empty() const { return points_.empty(); }
  const std::vector<Vec2f>& points() const { return points_; }
  float value(float x) const;
  float derivative(float x) const;

 private:
  struct Piece;
  Piece piece(float x) const;

  std::vector<Vec2f> points_;
  std::vector<float> tangents_;
};

}  // namespace normalshop
