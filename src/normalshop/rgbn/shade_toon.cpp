#include "normalshop/rgbn/shade_toon.h"

#include <cmath>
#include <vector>

#include "normalshop/rgbn/detail/check_options.h"
#include "normalshop/rgbn/detail/display.h"
#include "normalshop/rgbn/detail/normal_layer.h"

namespace normalshop {

namespace {

/// Linear colours of the bands from dark to light.
std::vector<Vec3f> band_colors(const ToonOptions& o) {
  const Vec3f blue(-0.4F, -0.2F, 0.5F);  // chosen by eye
  std::vector<Vec3f> out;
  for (int k = 0; k < o.bands; ++k) {
    const float light =
        o.bands == 1 ? 1.0F : static_cast<float>(k) / static_cast<float>(o.bands - 1);
    const float tone = o.dark + (1.0F - o.dark) * light;
    const Vec3f shift = o.tint * (1.0F - tone) * blue;
    out.push_back((Vec3f::Ones() + shift) * linear_tone(tone));
  }
  return out;
}

/// The bands' colours mixed by how much of each a step of this width around s covers.
Vec3f mix(const std::vector<Vec3f>& colors, float s, float width) {
  const auto count = static_cast<float>(colors.size());
  Vec3f out = colors[0];
  for (std::size_t k = 1; k < colors.size(); ++k) {
    const float above = s - static_cast<float>(k) / count;
    float share = above >= 0.0F ? 1.0F : 0.0F;
    if (std::abs(above) < 0.5F * width) share = above / width + 0.5F;
    if (share > 0.0F) out += share * (colors[k] - colors[k - 1]);
  }
  return out;
}

}  // namespace

Rect shade_toon(ImageView<Vec3f> normals, ColorView albedo, ColorSpan target, Rect region,
                const ToonOptions& options) {
  check_options("toon", options);
  assert(normals.rect() == target.rect());
  region = intersect(region, target.rect());
  if (region.empty()) return {};
  const NormalLayer layer =
      NormalLayer(normals, grow(region, reach(options))).smoothed(options.sigma);
  const Vec3f light = light_vector(options);
  const std::vector<Vec3f> colors = band_colors(options);
  const float softness = std::max(1.0F, options.softness);
  const auto lit = [&](const Vec3f& n) {
    return (n.dot(light) + options.wrap) / (1.0F + options.wrap);
  };
  for_each_row(region, [&](int y) {
    for (int x = region.x0; x < region.x1; ++x) {
      const Vec3f& n = layer(x, y);
      if (!has_direction(n)) continue;
      const Links links = links_at(layer, x, y, guard_cosine(180.0F));
      const auto at = [&](bool linked, int i, int j) { return linked ? lit(layer(i, j)) : 0.0F; };
      const float s = lit(n);
      const float dx = slope_between(links.left, links.right, at(links.left, x - 1, y), s,
                                     at(links.right, x + 1, y));
      const float dy =
          slope_between(links.up, links.down, at(links.up, x, y - 1), s, at(links.down, x, y + 1));
      const Vec3f tone = mix(colors, s, softness * std::sqrt(dx * dx + dy * dy));
      target(x, y) = albedo.empty() ? tone : Vec3f(tone.cwiseProduct(albedo(x, y)));
    }
  });
  return region;
}

int reach(const ToonOptions& options) { return smoothing_reach(options.sigma) + 1; }

}  // namespace normalshop
