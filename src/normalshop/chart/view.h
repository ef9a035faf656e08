#pragma once

#include <array>
#include <string_view>

#include <Eigen/Geometry>

#include "normalshop/surface/mesh.h"

namespace normalshop {

/// An orthographic view of the surface: the frame of an editing chart ("chart axes" are right, up,
/// direction). Points in it are in object units from the centre, x right and y up.
struct View {
  Vec3f right = Vec3f::UnitX();
  Vec3f up = Vec3f::UnitY();
  Vec3f direction = Vec3f::UnitZ();  ///< unit, from the surface to the viewer
  Vec3f center = Vec3f::Zero();      ///< object space
  float width = 1.0F;                ///< extent in object units
  float height = 1.0F;

  /// Object-space vector in chart axes, and back.
  Vec3f to_chart(const Vec3f& v) const { return {v.dot(right), v.dot(up), v.dot(direction)}; }
  Vec3f to_object(const Vec3f& v) const { return v.x() * right + v.y() * up + v.z() * direction; }
  /// -1 for a mirrored() view, whose axes are left-handed.
  float handedness() const { return right.cross(up).dot(direction) < 0.0F ? -1.0F : 1.0F; }
};

/// Where the viewer stands: Front looks along -z (glTF's front faces +z), Left from -x, Top from
/// +y.
enum class NamedView { Front, Back, Left, Right, Top, Bottom };
constexpr auto names_of(NamedView) {
  return std::array<std::string_view, 6>{"front", "back", "left", "right", "top", "bottom"};
}

/// `up` is only a hint: its part across `direction` counts; when it is parallel, another axis is
/// taken. Throws InvalidInput when direction is zero or a number is not finite or not positive.
View make_view(const Vec3f& direction, const Vec3f& up, const Vec3f& center, float width,
               float height);

/// The whole mesh from that side, with a margin of 4 %.
View named_view(const Mesh& mesh, NamedView name);
/// The whole mesh from any direction.
View framing_view(const Mesh& mesh, const Vec3f& direction, const Vec3f& up = Vec3f::UnitY());

/// The view of the surface's mirror image in the plane where coordinate `axis` is `at`: it shows of
/// the surface what `view` shows of that image, letters the wrong way round.
View mirrored(const View& view, int axis, float at);

/// The view that faces the surface point nearest to `point`: along the base normal there, centred
/// on it. Throws InvalidInput when the mesh has no triangle.
View facing_view(const Mesh& mesh, const Vec3f& point, float width, float height);

}  // namespace normalshop
