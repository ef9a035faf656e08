#include "normalshop/surface/vertex_normals.h"

#include <cmath>
#include <cstddef>

#include <Eigen/Geometry>

#include "normalshop/core/parallel.h"
#include "normalshop/surface/topology.h"

namespace normalshop {
namespace {

constexpr std::size_t normals_grain = 4096;

Vec3d edge(const Mesh& mesh, std::uint32_t from, std::uint32_t to) {
  return mesh.position(to).cast<double>() - mesh.position(from).cast<double>();
}

/// Unit, or zero for a triangle without area.
Vec3d face_normal(const Mesh& mesh, std::uint32_t corner) {
  const Vec3d a = edge(mesh, corner, next_corner(corner)).stableNormalized();
  const Vec3d b = edge(mesh, corner, previous_corner(corner)).stableNormalized();
  const Vec3d n = a.cross(b);
  const double sine = n.norm();
  return sine > 1e-12 ? Vec3d(n / sine) : Vec3d(Vec3d::Zero());
}

double corner_angle(const Mesh& mesh, std::uint32_t corner) {
  const Vec3d a = edge(mesh, corner, next_corner(corner)).stableNormalized();
  const Vec3d b = edge(mesh, corner, previous_corner(corner)).stableNormalized();
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

Vec3f unit_or_up(const Vec3d& n) {
  const double length = n.norm();
  return length > 1e-9 ? Vec3f((n / length).cast<float>()) : Vec3f(Vec3f::UnitZ());
}

Vec3f first_face_normal(const Mesh& mesh, std::span<const std::uint32_t> corners) {
  for (const std::uint32_t corner : corners) {
    const Vec3d n = face_normal(mesh, corner);
    if (n.squaredNorm() > 0.0) return n.cast<float>();
  }
  return Vec3f::UnitZ();
}

void angle_weighted(Mesh& mesh) {
  const Welding welding = weld_positions(mesh);
  const CornerLists lists = corners_of_vertices(welding.vertex, welding.vertex_count);
  parallel_for(welding.vertex_count, normals_grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      Vec3d sum = Vec3d::Zero();
      for (const std::uint32_t corner : lists.of(v)) {
        sum += corner_angle(mesh, corner) * face_normal(mesh, corner);
      }
      const bool cancels = !(sum.norm() > 1e-9);
      const Vec3f n = cancels ? first_face_normal(mesh, lists.of(v)) : unit_or_up(sum);
      for (const std::uint32_t corner : lists.of(v)) mesh.normals[corner] = n;
    }
  });
}

void flat(Mesh& mesh) {
  parallel_for(mesh.triangle_count(), normals_grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      const Vec3f n = unit_or_up(face_normal(mesh, static_cast<std::uint32_t>(3 * t)));
      for (std::size_t k = 0; k < 3; ++k) mesh.normals[3 * t + k] = n;
    }
  });
}

}  // namespace

void compute_normals(Mesh& mesh, NormalsRule rule) {
  mesh.normals.resize(mesh.corner_count());
  rule == NormalsRule::Flat ? flat(mesh) : angle_weighted(mesh);
}

}  // namespace normalshop
