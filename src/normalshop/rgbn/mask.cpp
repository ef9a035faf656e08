#include "normalshop/rgbn/mask.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "normalshop/core/distance.h"
#include "normalshop/core/error.h"
#include "normalshop/core/sample.h"
#include "normalshop/rgbn/detail/rows.h"

namespace normalshop {

namespace {

constexpr float most_pixels = 1e5F;

Rect copy_mask(MaskView mask, MaskSpan target, const Rect& region) {
  for_pixels(region, [&](int x, int y) { target(x, y) = mask_at(mask, x, y); });
  return region;
}

/// visit(x, y, distance) with the distance from the border for all pixels of the region, positive
/// inside; exact up to `limit`.
template <class Visit>
void visit_distances(MaskView mask, const Rect& region, int limit, Border border,
                     const Visit& visit) {
  Rect held = grow(region, limit);
  if (border != Border::Wrap) held = intersect(held, mask.rect());
  Image<std::uint8_t> inside(held.width(), held.height());
  Image<std::uint8_t> outside(held.width(), held.height());
  for_pixels(held, [&](int x, int y) {
    const bool is_inside = mask(border_pixel(x, mask.width(), border).index,
                                border_pixel(y, mask.height(), border).index) >= 0.5F;
    inside(x - held.x0, y - held.y0) = is_inside ? 1 : 0;
    outside(x - held.x0, y - held.y0) = is_inside ? 0 : 1;
  });
  MaskImage to_inside;
  MaskImage to_outside;
  distance_to(inside, limit, to_inside);
  distance_to(outside, limit, to_outside);
  for_pixels(region, [&](int x, int y) {
    const int i = x - held.x0;
    const int j = y - held.y0;
    visit(x, y, inside(i, j) != 0 ? to_outside(i, j) - 0.5F : 0.5F - to_inside(i, j));
  });
}

}  // namespace

Rect combine_masks(MaskView mask, MaskView other, MaskSpan target, Rect region,
                   MaskOperation operation) {
  region = intersect(region, target.rect());
  if (region.empty()) return {};
  for_pixels(region, [&](int x, int y) {
    const float m = mask_at(mask, x, y);
    const float o = mask_at(other, x, y);
    switch (operation) {
      case MaskOperation::Add:
        target(x, y) = std::max(m, o);
        break;
      case MaskOperation::Subtract:
        target(x, y) = std::min(m, 1.0F - o);
        break;
      case MaskOperation::Intersect:
        target(x, y) = std::min(m, o);
        break;
    }
  });
  return region;
}

Rect bounds(MaskView mask) {
  Rect out;
  for (int y = 0; y < mask.height(); ++y) {
    const float* row = mask.row(y);
    const auto is_set = [&](int x) { return row[x] > 0.0F; };
    int first = 0;
    while (first < mask.width() && !is_set(first)) ++first;
    if (first == mask.width()) continue;
    int last = mask.width() - 1;
    while (!is_set(last)) --last;
    out = unite(out, {first, y, last + 1, y + 1});
  }
  return out;
}

Rect invert_mask(MaskView mask, MaskSpan target, Rect region) {
  region = intersect(region, target.rect());
  if (region.empty()) return {};
  for_pixels(region, [&](int x, int y) { target(x, y) = 1.0F - mask_at(mask, x, y); });
  return region;
}

Rect grow_mask(MaskView mask, MaskSpan target, Rect region, const GrowMaskOptions& options,
               Border border) {
  const float distance = options.distance;
  if (!(std::abs(distance) <= most_pixels)) {
    throw InvalidInput("grow_mask: distance must be a number from -100000 to 100000");
  }
  region = intersect(region, target.rect());
  if (region.empty()) return {};
  if (distance == 0.0F || mask.empty()) return copy_mask(mask, target, region);
  visit_distances(mask, region, reach(options), border, [&](int x, int y, float from_border) {
    const float moved = std::clamp(from_border + distance + 0.5F, 0.0F, 1.0F);
    target(x, y) = distance > 0.0F ? std::max(mask(x, y), moved) : std::min(mask(x, y), moved);
  });
  return region;
}

int reach(const GrowMaskOptions& options) {
  return static_cast<int>(std::ceil(std::abs(options.distance))) + 2;
}

Rect feather_mask(MaskView mask, MaskSpan target, Rect region, const FeatherMaskOptions& options,
                  Border border) {
  const float half = 0.5F * options.width;
  if (!(options.width >= 0.0F && options.width <= most_pixels)) {
    throw InvalidInput("feather_mask: width must be a number from 0 to 100000");
  }
  region = intersect(region, target.rect());
  if (region.empty()) return {};
  if (half == 0.0F || mask.empty()) return copy_mask(mask, target, region);
  visit_distances(mask, region, reach(options), border, [&](int x, int y, float from_border) {
    target(x, y) = smoothstep(-half, half, from_border);
  });
  return region;
}

int reach(const FeatherMaskOptions& options) {
  return static_cast<int>(std::ceil(0.5F * options.width)) + 2;
}

}  // namespace normalshop
