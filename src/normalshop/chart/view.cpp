#include "normalshop/chart/view.h"

#include <cmath>
#include <limits>

#include <Eigen/Geometry>

#include "normalshop/core/error.h"
#include "normalshop/surface/frames.h"

namespace normalshop {

namespace {

constexpr float margin = 1.04F;

/// Weights of corners 1 and 2 at the point of a triangle nearest to p (Ericson 2004, 5.1.5).
Vec2f nearest_weights(const Vec3f& p, const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  const Vec3f ab = b - a;
  const Vec3f ac = c - a;
  const float d1 = ab.dot(p - a);
  const float d2 = ac.dot(p - a);
  if (d1 <= 0 && d2 <= 0) return {0, 0};
  const float d3 = ab.dot(p - b);
  const float d4 = ac.dot(p - b);
  if (d3 >= 0 && d4 <= d3) return {1, 0};
  const float vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return {d1 / (d1 - d3), 0};
  const float d5 = ab.dot(p - c);
  const float d6 = ac.dot(p - c);
  if (d6 >= 0 && d5 <= d6) return {0, 1};
  const float vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return {0, d2 / (d2 - d6)};
  const float va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6) {
    const float w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {1 - w, w};
  }
  const float sum = va + vb + vc;
  return sum > 0 ? Vec2f(vb / sum, vc / sum) : Vec2f(0, 0);
}

SurfacePoint nearest_point(const Mesh& mesh, const Vec3f& p) {
  SurfacePoint best;
  float smallest = std::numeric_limits<float>::max();
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    const Vec2f w = nearest_weights(p, mesh.position(3 * t), mesh.position(3 * t + 1),
                                    mesh.position(3 * t + 2));
    const SurfacePoint point{static_cast<std::uint32_t>(t), w.x(), w.y()};
    const float distance = (position_at(mesh, point) - p).squaredNorm();
    if (!(distance < smallest)) continue;
    smallest = distance;
    best = point;
  }
  return best;
}

}  // namespace

View make_view(const Vec3f& direction, const Vec3f& up, const Vec3f& center, float width,
               float height) {
  if (!direction.allFinite() || direction.norm() < 1e-12F) {
    throw InvalidInput("view.direction must be three finite numbers, not all 0");
  }
  if (!up.allFinite()) throw InvalidInput("view.up must be three finite numbers");
  if (!center.allFinite()) throw InvalidInput("view.center must be three finite numbers");
  if (!(width > 0) || !std::isfinite(width)) throw InvalidInput("view.width must be above 0");
  if (!(height > 0) || !std::isfinite(height)) throw InvalidInput("view.height must be above 0");
  View view;
  view.direction = direction.normalized();
  view.right = up.cross(view.direction);
  if (view.right.norm() < 1e-4F * std::max(1e-30F, up.norm()) || up.isZero()) {
    const bool vertical = std::abs(view.direction.y()) > 0.9F;
    const Vec3f other = vertical ? Vec3f(0, 0, view.direction.y() > 0 ? -1 : 1) : Vec3f(0, 1, 0);
    view.right = other.cross(view.direction);
  }
  view.right.normalize();
  view.up = view.direction.cross(view.right);
  view.center = center;
  view.width = width;
  view.height = height;
  return view;
}

View framing_view(const Mesh& mesh, const Vec3f& direction, const Vec3f& up) {
  View view = make_view(direction, up, Vec3f::Zero(), 1.0F, 1.0F);
  Vec3f low = Vec3f::Constant(std::numeric_limits<float>::max());
  Vec3f high = -low;
  for (std::size_t corner = 0; corner < mesh.corner_count(); ++corner) {
    const Vec3f p = view.to_chart(mesh.position(corner));
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  if (mesh.triangle_count() == 0) throw InvalidInput("the model has no triangle to look at");
  view.center = view.to_object(0.5F * (low + high));
  const float floor = 1e-6F * std::max(1e-6F, (high - low).norm());
  view.width = std::max(floor, high.x() - low.x()) * margin;
  view.height = std::max(floor, high.y() - low.y()) * margin;
  return view;
}

View named_view(const Mesh& mesh, NamedView name) {
  static const std::array<Vec3f, 6> directions{Vec3f(0, 0, 1), Vec3f(0, 0, -1), Vec3f(-1, 0, 0),
                                               Vec3f(1, 0, 0), Vec3f(0, 1, 0),  Vec3f(0, -1, 0)};
  return framing_view(mesh, directions[static_cast<std::size_t>(name)]);
}

View mirrored(const View& view, int axis, float at) {
  View out = view;
  for (Vec3f* v : {&out.right, &out.up, &out.direction}) (*v)[axis] = -(*v)[axis];
  out.center[axis] = 2.0F * at - out.center[axis];
  return out;
}

View facing_view(const Mesh& mesh, const Vec3f& point, float width, float height) {
  if (mesh.triangle_count() == 0) throw InvalidInput("the model has no triangle to face");
  if (!point.allFinite()) throw InvalidInput("view.facing must be three finite numbers");
  const SurfacePoint nearest = nearest_point(mesh, point);
  return make_view(base_normal_at(mesh, nearest), Vec3f::UnitY(), position_at(mesh, nearest), width,
                   height);
}

}  // namespace normalshop
