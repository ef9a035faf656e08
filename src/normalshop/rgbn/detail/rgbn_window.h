#pragma once

#include <cmath>

#include "normalshop/core/border.h"
#include "normalshop/rgbn/rgbn_image.h"

/// A rectangle of an RGBN image with what lies beyond the border, private to this floor.
namespace normalshop {

struct RgbnWindow {
  SlopeImage slopes;
  ColorImage color;    ///< empty where the image's is
  MaskImage validity;  ///< empty where every pixel counts 1

  RgbnView view() const { return {slopes, color, validity}; }
};

/// Room for a window, its pixels undefined.
RgbnWindow make_window(const Rect& size, bool color);

/// Copies `where`, which may reach beyond the image. Pixels that don't count, because their
/// validity is not above 0 or because they hold numbers that are not finite, become 0 everywhere.
/// The image has at least one pixel.
RgbnWindow gather_window(const RgbnView& image, const Rect& where, Border border);

/// Whether all pixels of `where`, which lies in the image, count 1 and hold finite numbers.
bool all_count(const RgbnView& image, const Rect& where);

/// The largest slope that filters average: a grazing pixel counts as one of this slope, so that it
/// does not outweigh all others (thesis 2.2 weighs normals by 1 / n_z).
inline constexpr float steepest_average = 20.0F;

inline Vec2f limit_slope(const Vec2f& slope) {
  const float square = slope.squaredNorm();
  if (!(square > steepest_average * steepest_average)) return slope;
  return slope * (steepest_average / std::sqrt(square));
}

/// The pixels of whichever image is wanted.
inline Rect rect_of(const RgbnSpan& target) {
  return target.slopes.empty() ? target.color.rect() : target.slopes.rect();
}

/// target = source in `region`.
void copy_region(const RgbnView& source, const RgbnSpan& target, const Rect& region);

/// Writes what a filter made of a pixel. A slope that is still what limit_slope() made of the
/// source's leaves the source as it is.
inline void write_filtered(const RgbnView& source, const RgbnSpan& target, int x, int y,
                           const Vec2f& slope, const Vec3f& color) {
  if (!target.slopes.empty()) {
    const Vec2f own = source.slopes(x, y);
    const Vec2f limited = limit_slope(own);
    target.slopes(x, y) = slope == limited ? own : slope;
  }
  if (!target.color.empty()) target.color(x, y) = color;
}

}  // namespace normalshop
