#pragma once

#include <cmath>

#include "normalshop/rgbn/curvature.h"

namespace normalshop {

/// Eigenvalues and vectors of J = d(n1, n2) / d(x, y) at the unit normal n, after making J
/// self-adjoint in the surface's metric G = I + m m^T / n3^2, m = (n1, n2) (which it is already
/// where the normals are those of a height).
inline Curvature principal_curvature(const Mat2f& jacobian, const Vec3f& n) {
  constexpr float least_square = 1e-4F;  // n3^2 at the horizon
  const Vec2f m = n.head<2>();
  const float n3_square = std::max(n.z() * n.z(), least_square);
  // J' = (J + G^-1 J^T G) / 2 with G^-1 = I - m m^T / (n3^2 + m^2).
  const Mat2f transposed = jacobian.transpose();
  const Mat2f right = transposed + (transposed * m) * (m.transpose() / n3_square);
  const Mat2f adjoint = right - m * (m.transpose() * right) / (n3_square + m.squaredNorm());
  const Mat2f shape = 0.5F * (jacobian + adjoint);
  const float mean = 0.5F * (shape(0, 0) + shape(1, 1));
  const float half = 0.5F * (shape(0, 0) - shape(1, 1));
  const float spread = std::sqrt(std::max(0.0F, half * half + shape(0, 1) * shape(1, 0)));
  Curvature out;
  out.k1 = mean + spread;
  out.k2 = mean - spread;
  // Two ways to write the eigenvector of k1; the longer one is the safer.
  const Vec2f a(shape(0, 1), spread - half);
  const Vec2f b(spread + half, shape(1, 0));
  const Vec2f longer = a.squaredNorm() > b.squaredNorm() ? a : b;
  if (longer.squaredNorm() > 0.0F) out.e1 = longer.normalized();
  const Vec2f lowered = n3_square * out.e1 + m.dot(out.e1) * m;
  out.e2 = Vec2f(-lowered.y(), lowered.x()).normalized();
  return out;
}

}  // namespace normalshop
