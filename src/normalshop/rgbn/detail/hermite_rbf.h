#pragma once

#include <vector>

#include <Eigen/LU>

#include "normalshop/core/vec.h"

/// Interpolation of two numbers in the plane by Hermite-Birkhoff radial functions |r|^3 with linear
/// reproduction (algorithms 3.2); internal to rgbn.
namespace normalshop {

/// A function that HermiteRbf has found.
class HermiteRbfField {
 public:
  struct Value {
    Vec2d value;
    Eigen::Matrix2d jacobian;  ///< the exact derivative of value
  };
  Value at(const Vec2d& x) const;

 private:
  friend class HermiteRbf;
  struct Center {
    Vec2d place;
    Vec2d weight;
    Eigen::Matrix2d gradient_weight;  ///< the first `hermite_` centres only
  };
  Vec2d origin_;
  double scale_ = 1.0;
  std::size_t hermite_ = 0;
  std::vector<Center> centers_;
  Eigen::Matrix2d linear_;
  Vec2d constant_;
};

/// Factors the system of a set of points once, O(n^3) for n = points + 2 hermite + 3, and solves it
/// for any data. The points must differ and, where none is a Hermite
/// point, must not all lie on one line.
class HermiteRbf {
 public:
  /// At the first `hermite` points the gradient is prescribed beside the value.
  HermiteRbf(std::vector<Vec2d> points, std::size_t hermite);

  /// values: one row a point. gradients: two rows (by x, by y) for each Hermite point, or empty: 0.
  HermiteRbfField solve(const Eigen::MatrixX2d& values, const Eigen::MatrixX2d& gradients) const;

 private:
  void place_points();
  Eigen::MatrixXd matrix() const;

  std::vector<Vec2d> points_;  ///< within a unit square about 0
  Eigen::Index hermite_;
  Vec2d origin_;
  double scale_ = 1.0;
  /// Its blocks are shorter than those of Eigen's product, so the caches' sizes, which decide how
  /// a longer sum is cut, do not enter the result.
  Eigen::PartialPivLU<Eigen::MatrixXd> factors_;
};

}  // namespace normalshop
