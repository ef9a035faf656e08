#pragma once

#include "normalshop/rgbn/rgbn_image.h"

namespace normalshop {

/// Unit normals in view axes (x right, y up, z towards the viewer) of an RGBN image, as curvature
/// and the styles take them: zero where validity is 0 and where a slope is no number. Returns the
/// region that it wrote.
Rect normals_of(const RgbnView& image, ImageSpan<Vec3f> normals, Rect region);

}  // namespace normalshop
