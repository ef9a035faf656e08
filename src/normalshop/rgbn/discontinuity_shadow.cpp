#include "normalshop/rgbn/discontinuity_shadow.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "normalshop/core/sample.h"
#include "normalshop/rgbn/detail/check_options.h"
#include "normalshop/rgbn/detail/line_fields.h"
#include "normalshop/rgbn/detail/normal_layer.h"
#include "normalshop/rgbn/light_direction.h"
#include "normalshop/rgbn/smooth.h"

namespace normalshop {

namespace {

/// A rim must turn away from the light by at least this sine to cast a shadow.
constexpr float least_fall = 0.3F;

/// The way towards the light: pixels to visit in turn and the share of darkness each would give.
struct March {
  std::vector<Vec2i> steps;
  std::vector<float> dark;
  std::vector<Vec2i> strides;  ///< from a pixel of the way to the next and to the one after that
  Vec2f to_light;              ///< y up
};

March plan_march(const DiscontinuityShadowOptions& o) {
  March march;
  march.to_light = light_vector({o.azimuth, 0.0F}).head<2>();
  for (float r = 1.0F; r < o.length + 1.0F; r += 1.0F) {
    const Vec2i step(static_cast<int>(std::lround(r * march.to_light.x())),
                     static_cast<int>(std::lround(-r * march.to_light.y())));
    march.steps.push_back(step);
    march.dark.push_back(o.strength * (1.0F - smoothstep(0.0F, o.length + 1.0F, r - 0.5F)));
  }
  const auto at = [&](std::size_t k) { return k == 0 ? Vec2i(0, 0) : march.steps[k - 1]; };
  for (std::size_t k = 1; k <= march.steps.size(); ++k) {
    for (const Vec2i& stride : {Vec2i(at(k) - at(k - 1)), Vec2i(at(k) - at(k < 2 ? 0 : k - 2))}) {
      const auto& known = march.strides;
      if (std::find(known.begin(), known.end(), stride) == known.end()) {
        march.strides.push_back(stride);
      }
    }
  }
  return march;
}

bool jumps(const Vec3f& a, const Vec3f& b, float least_cosine) { return a.dot(b) < least_cosine; }

/// Whether n, which is nearer to the light than `other`, falls off towards it like a rim.
bool in_front(const Vec3f& n, const Vec3f& other, const March& march) {
  const float fall = -n.head<2>().dot(march.to_light);
  return fall > least_fall && fall > -other.head<2>().dot(march.to_light);
}

/// Pixels beyond a step on the way to the light, without groups of them that are smaller than
/// `shortest`, which noise and grain are full of.
Image<LinePoint> find_steps(const NormalLayer& layer, const Rect& area, const March& march,
                            const DiscontinuityShadowOptions& options) {
  const float least_cosine = guard_cosine(options.jump);
  const auto steps_from = [&](const Vec3f& n, const Vec2i& from) {
    if (!layer.rect().contains(from.x(), from.y())) return false;
    const Vec3f& other = layer(from.x(), from.y());
    return !has_direction(other) || jumps(n, other, least_cosine);
  };
  Image<LinePoint> steps(area.width(), area.height(), no_line);
  for_each_row(area, [&](int y) {
    for (int x = area.x0; x < area.x1; ++x) {
      const Vec3f& n = layer(x, y);
      const bool any = has_direction(n) &&
                       std::any_of(march.strides.begin(), march.strides.end(),
                                   [&](const Vec2i& s) { return steps_from(n, Vec2i(x, y) - s); });
      if (any) steps(x - area.x0, y - area.y0) = {0.0F, 1.0F};
    }
  });
  drop_short(steps, 1.0F, static_cast<int>(std::ceil(options.shortest)));
  return steps;
}

/// What a march looks at.
struct Scene {
  const NormalLayer& layer;
  Rect area;  ///< of the steps
  const Image<LinePoint>& steps;
  float least_cosine;

  bool is_step(const Vec2i& p) const {
    return steps(p.x() - area.x0, p.y() - area.y0).strength > 0.0F;
  }
};

/// How dark a pixel is; a step between surfaces is where `before` and the next normal disagree.
float darkness(const Scene& scene, int x, int y, const March& march) {
  Vec3f before = scene.layer(x, y);
  Vec3f earlier = before;  // a step may take two pixels where a picture was antialiased
  for (std::size_t k = 0; k < march.steps.size(); ++k) {
    const Vec2i at = Vec2i(x, y) + march.steps[k];
    if (!scene.layer.rect().contains(at.x(), at.y())) return 0.0F;
    const Vec3f& n = scene.layer(at.x(), at.y());
    if (!has_direction(n)) {
      if (has_direction(before)) return 0.0F;
      continue;
    }
    if (scene.is_step(at)) {
      if (!has_direction(before)) return march.dark[k];
      if (jumps(n, before, scene.least_cosine) || jumps(n, earlier, scene.least_cosine)) {
        return in_front(n, earlier, march) ? march.dark[k] : 0.0F;
      }
    }
    earlier = has_direction(before) ? before : n;
    before = n;
  }
  return 0.0F;
}

int march_reach(const DiscontinuityShadowOptions& o) {
  return static_cast<int>(std::ceil(o.length)) + 2;
}

}  // namespace

Rect discontinuity_shadow(ImageView<Vec3f> normals, MaskSpan target, Rect region,
                          const DiscontinuityShadowOptions& options) {
  check_options("discontinuity shadow", options);
  assert(normals.rect() == target.rect());
  region = intersect(region, target.rect());
  if (region.empty()) return {};
  const NormalLayer layer(normals, grow(region, reach(options)));
  const March march = plan_march(options);
  const Rect soft = intersect(grow(region, smoothing_reach(options.softness)), target.rect());
  const int step_reach = march_reach(options) + static_cast<int>(std::ceil(options.shortest));
  const Rect area = intersect(grow(soft, step_reach), layer.rect());
  const Image<LinePoint> steps = find_steps(layer, area, march, options);
  const Scene scene{layer, area, steps, guard_cosine(options.jump)};
  MaskImage lit(soft.width(), soft.height());
  for_each_row(soft, [&](int y) {
    for (int x = soft.x0; x < soft.x1; ++x) {
      lit(x - soft.x0, y - soft.y0) = 1.0F - darkness(scene, x, y, march);
    }
  });
  smooth(lit, {}, lit, lit.rect(), {.sigma = options.softness});
  for_each_row(region, [&](int y) {
    const float* from = lit.row(y - soft.y0) + (region.x0 - soft.x0);
    std::copy_n(from, region.width(), target.row(y) + region.x0);
  });
  return region;
}

int reach(const DiscontinuityShadowOptions& options) {
  return march_reach(options) + static_cast<int>(std::ceil(options.shortest)) + 2 +
         smoothing_reach(options.softness);
}

}  // namespace normalshop
