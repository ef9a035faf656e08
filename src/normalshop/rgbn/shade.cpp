#include "normalshop/rgbn/shade.h"

#include <array>
#include <cmath>

#include "normalshop/core/parallel.h"
#include "normalshop/core/random.h"
#include "normalshop/core/sample.h"

namespace normalshop {

namespace {

constexpr float pi = 3.14159265F;

/// A light with what does not depend on the pixel.
struct Prepared {
  Vec3f direction;
  Vec3f half;  ///< between light and viewer
  Vec3f color;
  float fresnel;
};

struct Surface {
  float alpha2;
  float smith;  ///< k of Schlick's masking term
  float specular;
};

float power5(float x) {
  const float x2 = x * x;
  return x2 * x2 * x;
}

Prepared prepare(const Light& light, const Surface& surface) {
  const Vec3f l = light.direction.normalized();
  const Vec3f h = (l + Vec3f(0.0F, 0.0F, 1.0F)).normalized();
  const float c = std::max(0.0F, h.dot(l));
  return {l, h, light.color, surface.specular + (1.0F - surface.specular) * power5(1.0F - c)};
}

/// GGX with Schlick's masking, without the cosine; the viewer is at (0, 0, 1).
float highlight(const Vec3f& n, float n_l, const Prepared& light, const Surface& s) {
  const float n_h = std::max(0.0F, n.dot(light.half));
  const float n_v = std::max(n.z(), 0.05F);
  const float q = n_h * n_h * (s.alpha2 - 1.0F) + 1.0F;
  const float distribution = s.alpha2 / (pi * q * q);
  const float masking =
      1.0F / ((n_l * (1.0F - s.smith) + s.smith) * (n_v * (1.0F - s.smith) + s.smith));
  return 0.25F * distribution * masking * light.fresnel;
}

/// Narkowicz' fit of the ACES curve.
float tone(float x) {
  const float v = std::max(0.0F, 0.62F * x);
  return std::min(1.0F, v * (2.51F * v + 0.03F) / (v * (2.43F * v + 0.59F) + 0.14F));
}

Vec3f shade_pixel(const Vec3f& n, const Vec3f& albedo, float open, float lit,
                  const std::vector<Prepared>& lights, const Surface& surface,
                  const ShadeOptions& options) {
  const float up = 0.5F + 0.5F * n.y();
  const Vec3f ambient = options.ground + up * (options.sky - options.ground);
  const float grazing = power5(1.0F - std::max(n.z(), 0.0F));
  Vec3f sum = open * albedo.cwiseProduct(ambient);
  sum += open * (surface.specular + 0.25F * grazing) * ambient;
  for (std::size_t i = 0; i < lights.size(); ++i) {
    const float n_l = n.dot(lights[i].direction);
    if (n_l <= 0.0F) continue;
    const float visible = i == 0 ? lit : 1.0F;
    const Vec3f diffuse = (1.0F - lights[i].fresnel) / pi * albedo;
    const float shine = highlight(n, n_l, lights[i], surface);
    sum += visible * n_l * (diffuse + Vec3f::Constant(shine)).cwiseProduct(lights[i].color);
  }
  return options.exposure * sum;
}

/// Heights that are not finite stand for nothing; -infinity and NaN fail every comparison below.
constexpr float nothing = 1e30F;

/// Nearest integer of |x| < 16384 (std::lround is a call without SSE 4.1).
int rounded(float x) { return static_cast<int>(x + 16384.5F) - 16384; }

/// In [0, 1), decided by the pixel alone.
float random_part(int x, int y, std::uint32_t seed) {
  const auto bits = hash(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y), seed);
  return static_cast<float>(bits >> 8U) * 0x1p-24F;
}

template <class Body>
void for_each_pixel(const Rect& rect, const Body& body) {
  parallel_for(static_cast<std::size_t>(rect.height()), 8, [&](std::size_t a, std::size_t b) {
    for (int y = static_cast<int>(a); y < static_cast<int>(b); ++y) {
      for (int x = 0; x < rect.width(); ++x) body(x, y);
    }
  });
}

}  // namespace

std::vector<Light> ShadeOptions::studio_lights(const Vec3f& key) {
  return {{key, {3.3F, 3.1F, 2.85F}},
          {{0.85F, 0.1F, 0.55F}, {0.28F, 0.33F, 0.42F}},
          {{0.8F, 0.45F, -0.35F}, {0.9F, 1.15F, 1.5F}},
          {{-0.9F, 0.1F, -0.4F}, {0.35F, 0.4F, 0.5F}}};
}

void shade(ImageView<Vec3f> normals, ColorView albedo, MaskView occlusion, MaskView shadow,
           ColorSpan target, const ShadeOptions& options) {
  assert(normals.rect() == target.rect());
  const float roughness = std::clamp(options.material.roughness, 0.05F, 1.0F);
  const float alpha = roughness * roughness;
  const Surface surface = {alpha * alpha, (roughness + 1.0F) * (roughness + 1.0F) / 8.0F,
                           options.material.specular};
  std::vector<Prepared> lights;
  for (const Light& light : options.lights) lights.push_back(prepare(light, surface));
  for_each_pixel(target.rect(), [&](int x, int y) {
    const Vec3f& n = normals(x, y);
    if (n.isZero(0.0F)) return;
    const Vec3f color = albedo.empty() ? Vec3f::Constant(0.5F) : albedo(x, y);
    const float open = occlusion.empty() ? 1.0F : occlusion(x, y);
    const float lit = shadow.empty() ? 1.0F : shadow(x, y);
    target(x, y) = shade_pixel(n, color, open, lit, lights, surface, options).unaryExpr(&tone);
  });
}

void normal_colors(ImageView<Vec3f> normals, ColorSpan target) {
  assert(normals.rect() == target.rect());
  for_each_pixel(target.rect(), [&](int x, int y) {
    const Vec3f& n = normals(x, y);
    if (!n.isZero(0.0F)) target(x, y) = 0.5F * (n + Vec3f::Ones());
  });
}

void studio_background(ColorSpan target) {
  const auto width = static_cast<float>(target.width());
  const auto height = static_cast<float>(target.height());
  const Vec3f light(0.085F, 0.09F, 0.1F);
  const Vec3f dark(0.012F, 0.013F, 0.016F);
  for_each_pixel(target.rect(), [&](int x, int y) {
    const float dx = (static_cast<float>(x) + 0.5F) / width - 0.5F;
    const float dy = (static_cast<float>(y) + 0.5F) / height - 0.42F;
    const float t = smoothstep(0.0F, 0.85F, std::sqrt(dx * dx + dy * dy));
    // A grain of less than one 8-bit code hides the bands of a dark gradient.
    const float grain = random_part(x, y, 7U) - 0.5F;
    target(x, y) = (light + t * (dark - light)) * (1.0F + 0.03F * grain);
  });
}

void ambient_occlusion(MaskView height, float radius, MaskSpan target) {
  assert(height.rect() == target.rect());
  radius = std::min(radius, 16000.0F);
  constexpr int directions = 12;
  constexpr int steps = 7;
  std::array<Vec2f, directions> turn;
  for (std::size_t i = 0; i < directions; ++i) {
    const float angle = 2.0F * pi * static_cast<float>(i) / directions;
    turn[i] = {std::cos(angle), std::sin(angle)};
  }
  for_each_pixel(target.rect(), [&](int x, int y) {
    const float here = height(x, y);
    if (!std::isfinite(here)) {
      target(x, y) = 1.0F;
      return;
    }
    const float jitter = random_part(x, y, 11U);
    std::array<float, steps> distance;
    std::array<float, steps> steepness;  // of a unit rise there, fading out towards the radius
    for (std::size_t k = 0; k < steps; ++k) {
      const float part = (static_cast<float>(k) + 0.3F + 0.7F * jitter) / steps;
      distance[k] = 1.0F + part * part * radius;
      steepness[k] = (1.0F - part * part) / distance[k];
    }
    float open = 0.0F;
    for (const Vec2f& d : turn) {
      float horizon = 0.0F;
      for (std::size_t k = 0; k < steps; ++k) {
        const int px = x + rounded(distance[k] * d.x());
        const int py = y + rounded(distance[k] * d.y());
        if (!height.rect().contains(px, py)) continue;
        const float rise = height(px, py) - here;
        if (rise < nothing) horizon = std::max(horizon, rise * steepness[k]);
      }
      open += 1.0F / (1.0F + horizon * horizon);
    }
    target(x, y) = open / directions;
  });
}

void cast_shadow(MaskView height, const Vec3f& direction, float distance, MaskSpan target) {
  assert(height.rect() == target.rect());
  const Vec2f flat(direction.x(), -direction.y());
  const float length = flat.norm();
  if (length < 1e-6F) {
    for_each_pixel(target.rect(), [&](int x, int y) { target(x, y) = 1.0F; });
    return;
  }
  const Vec2f step = flat / length;
  const float climb = direction.z() / length;
  distance = std::min(distance, 16000.0F);
  for_each_pixel(target.rect(), [&](int x, int y) {
    const float here = height(x, y);
    float lit = 1.0F;
    const float jitter = random_part(x, y, 13U);
    // Steps grow with the distance, and so does the penumbra.
    for (float r = 2.0F + jitter; std::isfinite(here) && r < distance && lit > 0.0F;
         r += 1.0F + 0.06F * r) {
      const int px = x + rounded(r * step.x());
      const int py = y + rounded(r * step.y());
      if (!height.rect().contains(px, py)) break;
      const float above = height(px, py) - (here + climb * r) - 1.0F;
      if (std::isfinite(above)) lit = std::min(lit, 1.0F - above / (1.0F + 0.12F * r));
    }
    target(x, y) = std::clamp(lit, 0.0F, 1.0F);
  });
}

}  // namespace normalshop
