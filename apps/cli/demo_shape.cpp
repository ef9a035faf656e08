#include "demo_shape.h"

namespace normalshop::demo {

namespace {

Jet ellipsoid(const JetPoint& p, const Vec3f& center, const Vec3f& radii) {
  const JetPoint q = scaled(p - center, radii.cwiseInverse());
  const Jet k0 = length(q);
  const Jet k1 = length(scaled(q, radii.cwiseInverse()));
  return k0 * (k0 - 1.0F) / k1;
}

Jet sphere(const JetPoint& p, const Vec3f& center, float radius) {
  return length(p - center) - radius;
}

/// A line from a to b whose radius grows from ra to rb.
Jet limb(const JetPoint& p, const Vec3f& a, const Vec3f& b, float ra, float rb) {
  const Vec3f ab = b - a;
  const JetPoint pa = p - a;
  const Jet along = dot(pa, ab) * (1.0F / ab.squaredNorm());
  const Jet t = min(max(along, 0.0F), 1.0F);
  const JetPoint rest{pa.x - t * ab.x(), pa.y - t * ab.y(), pa.z - t * ab.z()};
  return length(rest) - (t * (rb - ra) + ra);
}

/// Adds a part and its mirror image; cuts them out with `cut_pair`.
template <class Part>
Jet add_pair(const Jet& body, const JetPoint& p, float blend, const Part& part) {
  const JetPoint other{-p.x, p.y, p.z};
  return smooth_min(smooth_min(body, part(p), blend), part(other), blend);
}
template <class Part>
Jet cut_pair(const Jet& body, const JetPoint& p, float blend, const Part& part) {
  const JetPoint other{-p.x, p.y, p.z};
  return smooth_max(smooth_max(body, -part(p), blend), -part(other), blend);
}

Jet skull(const JetPoint& p) {
  Jet d = ellipsoid(p, {0.0F, 0.14F, -0.10F}, {0.80F, 0.96F, 0.90F});
  d = smooth_min(d, ellipsoid(p, {0.0F, -0.34F, 0.12F}, {0.62F, 0.74F, 0.64F}), 0.35F);
  const Jet level = band_level(p);
  const Jet band = smoothstep(band_low - 0.03F, band_low + 0.03F, level);
  const Jet hair = smoothstep(band_high - 0.05F, band_high + 0.07F, level);
  return d - band * 0.035F - hair * 0.03F;
}

Jet add_brow_and_eyes(const JetPoint& p, Jet d) {
  d = add_pair(d, p, 0.20F, [](const JetPoint& q) {
    return ellipsoid(q, {0.40F, -0.12F, 0.50F}, {0.20F, 0.15F, 0.20F});
  });
  d = cut_pair(d, p, 0.16F, [](const JetPoint& q) {
    return ellipsoid(q, {0.29F, 0.03F, 0.90F}, {0.21F, 0.115F, 0.19F});
  });
  d = add_pair(d, p, 0.09F, [](const JetPoint& q) {
    return smooth_min(limb(q, {0.09F, 0.145F, 0.80F}, {0.32F, 0.205F, 0.70F}, 0.055F, 0.06F),
                      limb(q, {0.32F, 0.205F, 0.70F}, {0.54F, 0.12F, 0.52F}, 0.06F, 0.04F), 0.06F);
  });
  return add_pair(d, p, 0.035F, [](const JetPoint& q) {
    return ellipsoid(q, {0.285F, 0.02F, 0.615F}, {0.175F, 0.105F, 0.155F});
  });
}

Jet add_nose(const JetPoint& p, Jet d) {
  d = smooth_min(d, limb(p, {0.0F, 0.16F, 0.80F}, {0.0F, -0.21F, 0.955F}, 0.062F, 0.095F), 0.09F);
  d = add_pair(d, p, 0.06F, [](const JetPoint& q) {
    return sphere(q, {0.115F, -0.235F, 0.845F}, 0.075F);
  });
  return d;
}

Jet add_mouth(const JetPoint& p, Jet d) {
  d = smooth_min(d, ellipsoid(p, {0.0F, -0.50F, 0.62F}, {0.34F, 0.22F, 0.19F}), 0.15F);
  d = add_pair(d, p, 0.035F, [](const JetPoint& q) {
    return limb(q, {0.035F, -0.452F, 0.825F}, {0.225F, -0.505F, 0.695F}, 0.052F, 0.024F);
  });
  d = add_pair(d, p, 0.035F, [](const JetPoint& q) {
    return limb(q, {0.0F, -0.575F, 0.795F}, {0.16F, -0.555F, 0.735F}, 0.060F, 0.042F);
  });
  d = smooth_max(d, -limb(p, {-0.13F, -0.512F, 0.885F}, {0.13F, -0.512F, 0.885F}, 0.03F, 0.03F),
                 0.03F);
  return smooth_min(d, sphere(p, {0.0F, -0.81F, 0.53F}, 0.20F), 0.28F);
}

Jet add_ears_and_neck(const JetPoint& p, Jet d) {
  d = add_pair(d, p, 0.06F, [](const JetPoint& q) {
    return smooth_min(ellipsoid(q, {0.80F, 0.04F, -0.08F}, {0.085F, 0.20F, 0.15F}),
                      ellipsoid(q, {0.76F, -0.26F, -0.02F}, {0.085F, 0.20F, 0.085F}), 0.08F);
  });
  d = smooth_min(d, limb(p, {0.0F, -0.6F, -0.12F}, {0.0F, -1.5F, -0.14F}, 0.44F, 0.52F), 0.16F);
  return smooth_max(d, -(p.y + 1.20F), 0.10F);
}

}  // namespace

Jet head_distance(const Vec3f& point) {
  const JetPoint p = JetPoint::at(point);
  return add_ears_and_neck(p, add_mouth(p, add_nose(p, add_brow_and_eyes(p, skull(p)))));
}

HeadPoint head_point(const Vec3f& direction) {
  float t = 2.0F;
  // Sphere tracing inwards; the field is not quite a distance, hence the shorter steps.
  for (int i = 0; i < 200; ++i) {
    const float d = head_distance(t * direction).value();
    t -= 0.7F * d;
    if (std::abs(d) < 2e-7F) break;
  }
  const Vec3f p = t * direction;
  return {p, head_distance(p).gradient().normalized()};
}

}  // namespace normalshop::demo
