#pragma once

#include <cstdint>

#include <Eigen/Core>

namespace normalshop {

using Vec2i = Eigen::Vector2i;
using Vec2f = Eigen::Vector2f;
using Vec3f = Eigen::Vector3f;
/// Not aligned, so that arrays of structures pack tightly.
using Vec4f = Eigen::Matrix<float, 4, 1, Eigen::DontAlign>;
using Vec2d = Eigen::Vector2d;
using Vec3d = Eigen::Vector3d;
using Mat2f = Eigen::Matrix<float, 2, 2, Eigen::DontAlign>;
using Mat3f = Eigen::Matrix3f;
using Vec3u = Eigen::Matrix<std::uint32_t, 3, 1>;

/// z of the cross product of a and b in the plane: positive where b lies to the left of a.
template <class A, class B>
typename A::Scalar cross(const Eigen::MatrixBase<A>& a, const Eigen::MatrixBase<B>& b) {
  return a.x() * b.y() - a.y() * b.x();
}

}  // namespace normalshop
