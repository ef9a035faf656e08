#pragma once

#include <tuple>

#include "normalshop/core/image.h"
#include "normalshop/core/options.h"
#include "normalshop/rgbn/light_direction.h"

namespace normalshop {

struct ToonOptions : LightDirection {
  int bands = 3;
  float dark = 0.35F;
  float wrap = 0.25F;
  float tint = 0.5F;
  float sigma = 4.0F;
  float softness = 1.0F;

  static constexpr auto fields() {
    return std::tuple_cat(
        light_fields<ToonOptions>(),
        std::tuple{
            field("bands", &ToonOptions::bands, "", 1, 32,
                  "Number of tones; 1 leaves the colours flat"),
            field("dark", &ToonOptions::dark, "1", 0.0, 1.0,
                  "Tone of the darkest band: 0 black, 1 as light as the lightest, which leaves the "
                  "colours flat"),
            field("wrap", &ToonOptions::wrap, "1", 0.0, 1.0,
                  "How far light reaches around: 0 half of a ball, 1 all of it"),
            field("tint", &ToonOptions::tint, "1", 0.0, 1.0,
                  "How blue the dark bands are; 0 keeps them neutral"),
            field("sigma", &ToonOptions::sigma, "length", 0.0, 1e4,
                  "Details of the normals smaller than about this are left out; 0 shows them all"),
            field("softness", &ToonOptions::softness, "length", 0.0, 1e4,
                  "Width of the steps between bands; at least one pixel, which antialiases "
                  "them")});
  }
};

/// Cartoon shading: s = max(0, (n . light + wrap) / (1 + wrap)) in `bands` tones that meet where s
/// is a multiple of 1 / bands, antialiased by the slope of s. Target = albedo (linear; empty:
/// white) times the tone. Normals are unit, in view axes; pixels without one (zero) stay as they
/// are. All images have one size. Returns the pixels of `region` that it may have written. Throws
/// InvalidInput for options out of range. Sources: Lake et al. 2000 (ramp), Toler-Franklin et al.
/// 2007 (on RGBN images).
Rect shade_toon(ImageView<Vec3f> normals, ColorView albedo, ColorSpan target, Rect region,
                const ToonOptions& options = {});
/// Pixels read beyond the region.
int reach(const ToonOptions& options);

}  // namespace normalshop
