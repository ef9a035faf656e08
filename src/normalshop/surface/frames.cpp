#include "normalshop/surface/frames.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include <Eigen/Geometry>

namespace normalshop {
namespace {

/// Sines and lengths below this make a frame whose inverse is noise.
constexpr double min_frame_size = 1e-4;

std::array<std::size_t, 3> corners_of(const SurfacePoint& point) {
  const std::size_t first = 3 * static_cast<std::size_t>(point.triangle);
  return {first, first + 1, first + 2};
}

Vec3d geometric_normal(const Mesh& mesh, const SurfacePoint& point) {
  const auto [a, b, c] = corners_of(point);
  const Vec3d origin = mesh.position(a).cast<double>();
  const Vec3d n =
      (mesh.position(b).cast<double>() - origin).cross(mesh.position(c).cast<double>() - origin);
  const double length = n.norm();
  return length > 0.0 && std::isfinite(length) ? Vec3d(n / length) : Vec3d::UnitZ();
}

/// vN, not normalised; the triangle's own normal where the corners' cancel.
Vec3d interpolated_normal(const Mesh& mesh, const SurfacePoint& point) {
  if (mesh.normals.empty()) return geometric_normal(mesh, point);
  const auto [a, b, c] = corners_of(point);
  const Vec3d n = interpolate<Vec3d>(mesh.normals[a].cast<double>(), mesh.normals[b].cast<double>(),
                                     mesh.normals[c].cast<double>(), point.b1, point.b2);
  return n.squaredNorm() > min_frame_size * min_frame_size ? n : geometric_normal(mesh, point);
}

Vec3f unit_or_zero(const Vec3d& v) {
  const double length = v.norm();
  return length > 0.0 ? Vec3f((v / length).cast<float>()) : Vec3f(Vec3f::Zero());
}

}  // namespace

// Both directions work in double: rounding in float alone would cost 1e-5 degrees a round trip.
Vec3f TangentFrame::object_normal(const Vec3f& map_vector) const {
  const Eigen::Matrix3d m = to_object.cast<double>();
  return unit_or_zero(m * map_vector.cast<double>());
}

Vec3f TangentFrame::map_normal(const Vec3f& normal) const {
  const Vec3d t = to_object.col(0).cast<double>();
  const Vec3d b = to_object.col(1).cast<double>();
  const Vec3d n = to_object.col(2).cast<double>();
  const Vec3d row0 = b.cross(n);
  const Vec3d wanted = normal.cast<double>();
  const Vec3d v(row0.dot(wanted), n.cross(t).dot(wanted), t.cross(b).dot(wanted));
  return unit_or_zero(t.dot(row0) < 0.0 ? Vec3d(-v) : v);
}

Mat3f any_frame(const Vec3d& normal) {
  const Vec3d n = normal.isZero() ? Vec3d(Vec3d::UnitZ()) : normal.normalized();
  // The axis least along the normal, so that the cross product is well away from zero.
  Eigen::Index axis = 0;
  n.cwiseAbs().minCoeff(&axis);
  const Vec3d tangent = Vec3d::Unit(axis).cross(n).normalized();
  Mat3f frame;
  frame.col(0) = tangent.cast<float>();
  frame.col(1) = n.cross(tangent).cast<float>();
  frame.col(2) = n.cast<float>();
  return frame;
}

Vec3f position_at(const Mesh& mesh, const SurfacePoint& point) {
  const auto [a, b, c] = corners_of(point);
  const Vec3f& origin = mesh.position(a);
  return origin + point.b1 * (mesh.position(b) - origin) + point.b2 * (mesh.position(c) - origin);
}

Vec3f base_normal_at(const Mesh& mesh, const SurfacePoint& point) {
  return interpolated_normal(mesh, point).normalized().cast<float>();
}

TangentFrame frame_at(const Mesh& mesh, const SurfacePoint& point, NormalSpace space) {
  TangentFrame frame;
  if (space == NormalSpace::Object) frame.to_object = mesh.node_frame(point.triangle);
  if (space != NormalSpace::Tangent) return frame;
  assert(mesh.tangents.size() == mesh.corner_count());
  const auto [a, b, c] = corners_of(point);
  const Vec4f& ta = mesh.tangents[a];
  const Vec4f& tb = mesh.tangents[b];
  const Vec4f& tc = mesh.tangents[c];
  const double sign = ta[3] + tb[3] + tc[3] < 0.0F ? -1.0 : 1.0;
  const Vec3d t = interpolate<Vec3d>(ta.head<3>().cast<double>(), tb.head<3>().cast<double>(),
                                     tc.head<3>().cast<double>(), point.b1, point.b2);
  const Vec3d n = interpolated_normal(mesh, point);
  const Vec3d bitangent = sign * n.cross(t);
  const double least = min_frame_size * min_frame_size * n.squaredNorm();
  if (!(bitangent.squaredNorm() > least * std::max(1.0, t.squaredNorm()))) {
    frame.to_object = any_frame(n);
    return frame;
  }
  frame.to_object.col(0) = t.cast<float>();
  frame.to_object.col(1) = bitangent.cast<float>();
  frame.to_object.col(2) = n.cast<float>();
  return frame;
}

}  // namespace normalshop
