#include "normalshop/surface/mesh.h"

namespace normalshop {

Vec2f reading_place(const Mesh& mesh, std::uint32_t set, const Vec2f& uv, int width, int height) {
  if (mesh.repeats(set)) return uv;
  // A little more than half a texel, so that rounding never reaches the opposite border.
  constexpr float inset = 0.5F + 1.0F / 1024;
  const Vec2f low(inset / static_cast<float>(width), inset / static_cast<float>(height));
  const Vec2f high = Vec2f::Ones() - low;
  return uv.cwiseMin(high.cwiseMax(low)).cwiseMax(low);
}

Bounds bounds(const Mesh& mesh) {
  Bounds b;
  for (std::size_t corner = 0; corner < mesh.corner_count(); ++corner) {
    b.low = b.low.cwiseMin(mesh.position(corner));
    b.high = b.high.cwiseMax(mesh.position(corner));
  }
  return b;
}

}  // namespace normalshop
