#pragma once

#include <vector>

#include "normalshop/rgbn/shade.h"

namespace normalshop {

/// Any number of lights; nothing is left when there are none and `ambient` is 0.
struct LambertOptions {
  std::vector<Light> lights = {{{-0.5F, 0.5F, 0.7071F}, {3.1415927F, 3.1415927F, 3.1415927F}}};
  Vec3f ambient = {0.0F, 0.0F, 0.0F};  ///< linear, added from all sides alike
};

/// Matte shading of unit normals in view axes:
///     target = albedo * (ambient + sum over lights of color / pi * max(0, n . direction)),
/// linear and without tone mapping, so it can be compared with photographs and may exceed 1; an
/// empty albedo is white. shade() of shade.h is the glossy one with a film's tones. Pixels without
/// a normal (zero) stay as they are. All images have one size. Returns the pixels of `region` that
/// it may have written. Throws InvalidInput for a light that is not finite or has no direction.
Rect shade_lambert(ImageView<Vec3f> normals, ColorView albedo, ColorSpan target, Rect region,
                   const LambertOptions& options = {});

}  // namespace normalshop
