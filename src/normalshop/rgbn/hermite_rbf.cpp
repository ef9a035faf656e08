#include "normalshop/rgbn/detail/hermite_rbf.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace normalshop {

namespace {

double psi(const Vec2d& r) {
  const double length = r.norm();
  return length * length * length;
}

Vec2d psi_gradient(const Vec2d& r) { return 3.0 * r.norm() * r; }

Eigen::Matrix2d psi_hessian(const Vec2d& r) {
  const double length = r.norm();
  if (!(length > 0.0)) return Eigen::Matrix2d::Zero();
  return 3.0 * (length * Eigen::Matrix2d::Identity() + r * r.transpose() / length);
}

}  // namespace

HermiteRbfField::Value HermiteRbfField::at(const Vec2d& x) const {
  const Vec2d place = (x - origin_) * scale_;
  Value sum{linear_ * place + constant_, linear_};
  for (std::size_t i = 0; i < centers_.size(); ++i) {
    const Center& c = centers_[i];
    const Vec2d r = place - c.place;
    const double length = r.norm();
    sum.value += (length * length * length) * c.weight;
    sum.jacobian += c.weight * (3.0 * length * r.transpose());
    if (i >= hermite_ || !(length > 0.0)) continue;
    const Vec2d along = c.gradient_weight * r;
    sum.value -= 3.0 * length * along;
    sum.jacobian -= 3.0 * length * c.gradient_weight + along * (3.0 / length * r.transpose());
  }
  sum.jacobian *= scale_;
  return sum;
}

HermiteRbf::HermiteRbf(std::vector<Vec2d> points, std::size_t hermite)
    : points_(std::move(points)), hermite_(static_cast<Eigen::Index>(hermite)) {
  assert((points_.size() >= 3 || hermite > 0) && hermite <= points_.size());
  place_points();
  factors_.compute(matrix());
}

/// The cube of distances in pixels would spoil the system's condition.
void HermiteRbf::place_points() {
  Vec2d low = points_.front();
  Vec2d high = low;
  for (const Vec2d& p : points_) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  origin_ = 0.5 * (low + high);
  scale_ = 1.0 / std::max((high - low).maxCoeff(), 1e-9);
  for (Vec2d& p : points_) p = (p - origin_) * scale_;
}

/// Rows: values, gradients, then the side conditions that keep linear functions out of the sums.
Eigen::MatrixXd HermiteRbf::matrix() const {
  const auto n = static_cast<Eigen::Index>(points_.size());
  const Eigen::Index linear = n + 2 * hermite_;
  Eigen::MatrixXd m = Eigen::MatrixXd::Zero(linear + 3, linear + 3);
  for (Eigen::Index j = 0; j < n; ++j) {
    const Vec2d& center = points_[static_cast<std::size_t>(j)];
    for (Eigen::Index i = 0; i < n; ++i) {
      const Vec2d r = points_[static_cast<std::size_t>(i)] - center;
      m(i, j) = psi(r);
      if (i < hermite_) m.block<2, 1>(n + 2 * i, j) = psi_gradient(r);
      if (j < hermite_) m.block<1, 2>(i, n + 2 * j) = -psi_gradient(r).transpose();
      if (i < hermite_ && j < hermite_) {
        m.block<2, 2>(n + 2 * i, n + 2 * j) = -psi_hessian(r);
      }
    }
    m(j, linear) = m(linear, j) = 1.0;
    m.block<1, 2>(j, linear + 1) = center.transpose();
    m.block<2, 1>(linear + 1, j) = center;
    if (j < hermite_) {
      m.block<2, 2>(n + 2 * j, linear + 1).setIdentity();
      m.block<2, 2>(linear + 1, n + 2 * j).setIdentity();
    }
  }
  return m;
}

HermiteRbfField HermiteRbf::solve(const Eigen::MatrixX2d& values,
                                  const Eigen::MatrixX2d& gradients) const {
  const auto n = static_cast<Eigen::Index>(points_.size());
  assert(values.rows() == n && (gradients.rows() == 0 || gradients.rows() == 2 * hermite_));
  Eigen::MatrixX2d right = Eigen::MatrixX2d::Zero(n + 2 * hermite_ + 3, 2);
  right.topRows(n) = values;
  if (gradients.rows() > 0) right.middleRows(n, 2 * hermite_) = gradients / scale_;
  const Eigen::MatrixX2d weights = factors_.solve(right);
  HermiteRbfField field;
  field.origin_ = origin_;
  field.scale_ = scale_;
  field.hermite_ = static_cast<std::size_t>(hermite_);
  for (Eigen::Index i = 0; i < n; ++i) {
    HermiteRbfField::Center center{points_[static_cast<std::size_t>(i)], weights.row(i).transpose(),
                                   Eigen::Matrix2d::Zero()};
    if (i < hermite_) center.gradient_weight = weights.middleRows<2>(n + 2 * i).transpose();
    field.centers_.push_back(center);
  }
  field.constant_ = weights.row(n + 2 * hermite_).transpose();
  field.linear_ = weights.bottomRows<2>().transpose();
  return field;
}

}  // namespace normalshop
