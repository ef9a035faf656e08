#pragma once

#include <Eigen/Geometry>

#include "normalshop/chart/grid.h"
#include "normalshop/core/normal_map.h"

/// A triangle in chart axes, private to floor 4: what its pixels and texels share.
namespace normalshop {

struct ChartTriangle {
  // Columns: corner 0, corner 1 - corner 0, corner 2 - corner 0, so that M * (1, b1, b2)
  // interpolates.
  Mat3f points = Mat3f::Zero();    ///< pixel x, pixel y, depth
  Mat3f normals = Mat3f::Zero();   ///< base normals
  Mat3f tangents = Mat3f::Zero();  ///< zero without tangents
  float sign = 1.0F;               ///< of the bitangent

  static Mat3f differences(const Vec3f& a, const Vec3f& b, const Vec3f& c) {
    Mat3f m;
    m.col(0) = a;
    m.col(1) = b - a;
    m.col(2) = c - a;
    return m;
  }

  void load(const Mesh& mesh, const ChartGrid& grid, std::uint32_t triangle) {
    const std::size_t corner = 3 * static_cast<std::size_t>(triangle);
    const View& view = grid.view;
    points =
        differences(grid.project(mesh.position(corner)), grid.project(mesh.position(corner + 1)),
                    grid.project(mesh.position(corner + 2)));
    normals =
        differences(view.to_chart(mesh.normals[corner]), view.to_chart(mesh.normals[corner + 1]),
                    view.to_chart(mesh.normals[corner + 2]));
    if (mesh.tangents.empty()) return;
    const auto tangent = [&](std::size_t i) {
      return view.to_chart(mesh.tangents[corner + i].head<3>());
    };
    tangents = differences(tangent(0), tangent(1), tangent(2));
    sign = mesh.tangents[corner].w() < 0.0F ? -1.0F : 1.0F;
  }

  /// Map space to chart axes at weights (1, b1, b2): columns vT, vB, vN, not normalised, like
  /// TangentFrame; `normal` = normals * weights.
  Mat3f frame(const Vec3f& weights, const Vec3f& normal, NormalSpace space,
              const View& view) const {
    Mat3f m;
    if (space == NormalSpace::Tangent) {
      m.col(0) = tangents * weights;
      m.col(1) = sign * normal.cross(m.col(0));
      m.col(2) = normal;
    } else {
      m.row(0) = view.right.transpose();
      m.row(1) = view.up.transpose();
      m.row(2) = view.direction.transpose();
    }
    return m;
  }
};

}  // namespace normalshop
