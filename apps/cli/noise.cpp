#include "noise.h"

#include <array>

namespace normalshop::demo {

namespace {

struct Cell {
  Vec3f corner;
  std::array<std::uint32_t, 3> index;
};

Cell cell_of(const Vec3f& p) {
  Cell cell;
  for (std::size_t k = 0; k < 3; ++k) {
    const float down = std::floor(p[static_cast<Eigen::Index>(k)]);
    cell.corner[static_cast<Eigen::Index>(k)] = down;
    cell.index[k] = static_cast<std::uint32_t>(static_cast<std::int32_t>(down));
  }
  return cell;
}

/// Well-mixed bits of a lattice point.
inline std::uint32_t lattice_hash(std::uint32_t x, std::uint32_t y, std::uint32_t z,
                                  std::uint32_t seed) {
  std::uint32_t h = seed * 0x27D4EB2FU + x * 0x9E3779B1U + y * 0x85EBCA77U + z * 0xC2B2AE3DU;
  h = (h ^ h >> 15U) * 0x2C1B3C6DU;
  h = (h ^ h >> 12U) * 0x297A2D39U;
  return h ^ h >> 15U;
}

/// Ten bits as a number from 0 to 1.
float part_of(std::uint32_t h, unsigned shift) {
  return static_cast<float>(h >> shift & 1023U) * (1.0F / 1023.0F);
}

Vec3f vector_of(std::uint32_t h) { return {part_of(h, 0), part_of(h, 10), part_of(h, 20)}; }

template <class T>
using Lanes = std::array<T, 8>;
constexpr Lanes<float> offset_x{0, 1, 0, 1, 0, 1, 0, 1};
constexpr Lanes<float> offset_y{0, 0, 1, 1, 0, 0, 1, 1};
constexpr Lanes<float> offset_z{0, 0, 0, 0, 1, 1, 1, 1};

inline float component(std::uint32_t h) {
  return static_cast<float>(static_cast<std::int32_t>(h & 1023U)) * (2.0F / 1023.0F) - 1.0F;
}

float sum(const Lanes<float>& v) {
  return ((v[0] + v[1]) + (v[2] + v[3])) + ((v[4] + v[5]) + (v[6] + v[7]));
}

/// f(p) from f's gradient and value at p.
Jet compose(const JetPoint& p, const Eigen::Array4f& f) {
  Eigen::Array4f q = p.x.all() * f[0] + p.y.all() * f[1] + p.z.all() * f[2];
  q[3] = f[3];
  return q;
}

}  // namespace

// All eight corners of the cell side by side, for the compiler to vectorise.
Jet noise(const JetPoint& p, std::uint32_t seed) {
  const Vec3f at = p.value();
  const Cell cell = cell_of(at);
  const Eigen::Array3f f = at - cell.corner;
  const Eigen::Array3f u = f * f * f * (f * (f * 6.0F - 15.0F) + 10.0F);
  const Eigen::Array3f du = 30.0F * f * f * (f * (f - 2.0F) + 1.0F);
  alignas(32) Lanes<std::uint32_t> h;
  for (std::uint32_t k = 0; k < 8; ++k) {
    h[k] = lattice_hash(cell.index[0] + (k & 1U), cell.index[1] + (k >> 1U & 1U),
                        cell.index[2] + (k >> 2U), seed);
  }
  alignas(32) std::array<Lanes<float>, 4> terms;
  for (std::size_t k = 0; k < 8; ++k) {
    const float ox = offset_x[k];
    const float oy = offset_y[k];
    const float oz = offset_z[k];
    const float gx = component(h[k]);
    const float gy = component(h[k] >> 10U);
    const float gz = component(h[k] >> 20U);
    const float wx = 1.0F - u[0] + ox * (2.0F * u[0] - 1.0F);
    const float wy = 1.0F - u[1] + oy * (2.0F * u[1] - 1.0F);
    const float wz = 1.0F - u[2] + oz * (2.0F * u[2] - 1.0F);
    const float d = gx * (f[0] - ox) + gy * (f[1] - oy) + gz * (f[2] - oz);
    const float w = wx * wy * wz;
    terms[0][k] = w * gx + d * (2.0F * ox - 1.0F) * du[0] * wy * wz;
    terms[1][k] = w * gy + d * (2.0F * oy - 1.0F) * du[1] * wx * wz;
    terms[2][k] = w * gz + d * (2.0F * oz - 1.0F) * du[2] * wx * wy;
    terms[3][k] = w * d;
  }
  return compose(p, {sum(terms[0]), sum(terms[1]), sum(terms[2]), sum(terms[3])});
}

Jet fractal_noise(const JetPoint& p, int octaves, float gain, std::uint32_t seed) {
  Jet sum;
  float strength = 1.0F;
  float scale = 1.0F;
  for (int i = 0; i < octaves; ++i) {
    sum = sum + noise(p * scale, seed + static_cast<std::uint32_t>(i)) * strength;
    strength *= gain;
    scale *= 2.03F;
  }
  return sum;
}

Jet pits(const JetPoint& p, float share, std::uint32_t seed) {
  const Cell cell = cell_of(p.value());
  const std::uint32_t h = lattice_hash(cell.index[0], cell.index[1], cell.index[2], seed);
  const float lot = part_of(h, 0);
  if (lot >= share) return {};
  const float size = 0.25F + 0.75F * lot / share;
  const float radius = 0.48F * size;
  const Vec3f free = vector_of(h * 0x85EBCA6BU + 0x68E31DA4U);
  const Vec3f center = cell.corner + Vec3f::Constant(radius) + (1.0F - 2.0F * radius) * free;
  const JetPoint q = p - center;
  const Jet r2 = (q.x * q.x + q.y * q.y + q.z * q.z) * (1.0F / (radius * radius));
  if (r2.value() >= 1.0F) return {};
  const float t = 1.0F - r2.value();
  return r2.chain(-size * t * t, 2.0F * size * t);
}

Jet dishes(const JetPoint& p, std::uint32_t seed) {
  const Vec3f at = p.value();
  const Cell cell = cell_of(at);
  Vec3f nearest = at;
  float smallest = 1e9F;
  for (int k = 0; k < 27; ++k) {
    const Eigen::Vector3i o(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
    const auto shifted = [&](std::size_t axis) {
      return cell.index[axis] + static_cast<std::uint32_t>(o[static_cast<Eigen::Index>(axis)]);
    };
    const std::uint32_t h = lattice_hash(shifted(0), shifted(1), shifted(2), seed);
    const Vec3f center = cell.corner + o.cast<float>() + vector_of(h);
    const float d = (at - center).squaredNorm();
    if (d < smallest) {
      smallest = d;
      nearest = center;
    }
  }
  const Vec3f gradient = 2.0F * (at - nearest);
  return compose(p, {gradient.x(), gradient.y(), gradient.z(), smallest});
}

}  // namespace normalshop::demo
