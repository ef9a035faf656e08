#include "normalshop/chart/view.h"

#include <cmath>
#include <limits>

#include <Eigen/Geometry>

#include "normalshop/core/error.h"
#include "normalshop/surface/frames.h"
#include "normalshop/surface/nearest_point.h"

namespace normalshop {

namespace {

constexpr float margin = 1.04F;

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
  const SurfacePoint nearest = nearest_surface_point(mesh, point);
  return make_view(base_normal_at(mesh, nearest), Vec3f::UnitY(), position_at(mesh, nearest), width,
                   height);
}

}  // namespace normalshop
