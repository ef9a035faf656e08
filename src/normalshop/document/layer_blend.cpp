#include "normalshop/document/layer_blend.h"

#include <cmath>

#include "normalshop/core/slope.h"

namespace normalshop {

namespace {

/// Opposite directions have no middle: the nearer one counts then.
Vec3f mix_vectors(const Vec3f& below, const Vec3f& above, float share) {
  const Vec3f mixed = below + share * (above - below);
  const float length = mixed.norm();
  if (length < 1e-6F) return share < 0.5F ? below : above;
  return mixed / length;
}

Vec3f turn(const Vec3f& below, const Vec3f& above, float share) {
  const double angle = std::atan2(static_cast<double>(below.cross(above).norm()),
                                  static_cast<double>(below.dot(above)));
  const double sine = std::sin(angle);
  if (sine < 1e-6) return mix_vectors(below, above, share);
  const auto part = [&](double of) { return static_cast<float>(std::sin(of * angle) / sine); };
  const auto t = static_cast<double>(share);
  return (part(1.0 - t) * below + part(t) * above).normalized();
}

}  // namespace

Vec3f blend_normals(const Vec3f& below, const Vec3f& above, float opacity, LayerBlend blend,
                    NormalSpace space) {
  if (opacity == 0.0F) return below;
  if (opacity == 1.0F) return above;
  if (blend == LayerBlend::Rotation) return turn(below, above, opacity);
  if (space != NormalSpace::Tangent || below.z() < min_cosine || above.z() < min_cosine) {
    return mix_vectors(below, above, opacity);
  }
  const Vec2f a = slope_from_normal(below);
  const Vec2f b = slope_from_normal(above);
  return normal_from_slope(a + opacity * (b - a));
}

}  // namespace normalshop
