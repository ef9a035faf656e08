#include "noise.h"

#include <array>

#include "normalshop/core/random.h"

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

std::uint32_t hash3(std::uint32_t x, std::uint32_t y, std::uint32_t z, std::uint32_t seed) {
  return hash(x, y, seed + z * 0x9E3779B9U);
}

/// Ten bits as a number from 0 to 1.
float part_of(std::uint32_t h, unsigned shift) {
  return static_cast<float>(h >> shift & 1023U) * (1.0F / 1023.0F);
}

Vec3f vector_of(std::uint32_t h) { return {part_of(h, 0), part_of(h, 10), part_of(h, 20)}; }

Jet compose(const JetPoint& p, float value, const Vec3f& gradient) {
  const Jet along = p.x * gradient.x() + p.y * gradient.y() + p.z * gradient.z();
  return along.chain(value, 1.0F);
}

}  // namespace

Jet noise(const JetPoint& p, std::uint32_t seed) {
  const Vec3f at = p.value();
  const Cell cell = cell_of(at);
  const Eigen::Array3f f = at - cell.corner;
  const Eigen::Array3f u = f * f * f * (f * (f * 6.0F - 15.0F) + 10.0F);
  const Eigen::Array3f du = 30.0F * f * f * (f * (f - 2.0F) + 1.0F);
  float value = 0.0F;
  Vec3f gradient = Vec3f::Zero();
  for (std::uint32_t k = 0; k < 8; ++k) {
    const std::array<std::uint32_t, 3> o{k & 1U, k >> 1U & 1U, k >> 2U};
    const std::uint32_t h =
        hash3(cell.index[0] + o[0], cell.index[1] + o[1], cell.index[2] + o[2], seed);
    const Vec3f g = 2.0F * vector_of(h) - Vec3f::Ones();
    Vec3f w;
    Vec3f dw;
    Vec3f to;
    for (Eigen::Index i = 0; i < 3; ++i) {
      const bool far = o[static_cast<std::size_t>(i)] != 0;
      w[i] = far ? u[i] : 1.0F - u[i];
      dw[i] = far ? du[i] : -du[i];
      to[i] = far ? f[i] - 1.0F : f[i];
    }
    const float d = g.dot(to);
    const float weight = w.x() * w.y() * w.z();
    value += weight * d;
    gradient += weight * g +
                d * Vec3f(dw.x() * w.y() * w.z(), w.x() * dw.y() * w.z(), w.x() * w.y() * dw.z());
  }
  return compose(p, value, gradient);
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
  const std::uint32_t h = hash3(cell.index[0], cell.index[1], cell.index[2], seed);
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
    const std::uint32_t h = hash3(shifted(0), shifted(1), shifted(2), seed);
    const Vec3f center = cell.corner + o.cast<float>() + vector_of(h);
    const float d = (at - center).squaredNorm();
    if (d < smallest) {
      smallest = d;
      nearest = center;
    }
  }
  return compose(p, smallest, 2.0F * (at - nearest));
}

}  // namespace normalshop::demo
