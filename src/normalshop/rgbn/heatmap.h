#pragma once

#include "normalshop/core/image.h"

namespace normalshop {

/// Colour of t in [0, 1] (clamped; not finite: grey) as sRGB CODES 0..1, not linear light: from
/// near black over violet and orange to pale yellow, evenly growing lightness.
Vec3f heat_color(float t);

/// target = heat_color(values / maximum). maximum > 0; one size.
void heatmap(MaskView values, float maximum, ColorSpan target);

}  // namespace normalshop
