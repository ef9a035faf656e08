#pragma once

#include "normalshop/core/image.h"

namespace normalshop {

/// Styles choose tones as the eye grades them: 0 black, 0.5 the middle grey of a screen, 1 white.
/// Linear light of such a tone; a polynomial within 0.002 of the sRGB curve, the same everywhere.
inline float linear_tone(float tone) {
  return tone * (tone * (tone * 0.305306011F + 0.682171111F) + 0.012522878F);
}

/// A style's colour of a pixel; no albedo counts as white.
inline Vec3f colored(ColorView albedo, int x, int y, float light) {
  return albedo.empty() ? Vec3f(Vec3f::Constant(light)) : Vec3f(light * albedo(x, y));
}

}  // namespace normalshop
