#pragma once

#include <tuple>

#include "normalshop/core/image.h"
#include "normalshop/core/options.h"
#include "normalshop/rgbn/light_direction.h"

namespace normalshop {

struct ExaggeratedOptions : LightDirection {
  float scale = 1.0F;
  int levels = 8;
  float gain = 16.0F;
  float detail = 0.85F;
  float balance = -0.5F;

  static constexpr auto fields() {
    return std::tuple_cat(
        light_fields<ExaggeratedOptions>(),
        std::tuple{
            field("scale", &ExaggeratedOptions::scale, "length", 0.3, 1e3,
                  "Size of the finest details that show"),
            field("levels", &ExaggeratedOptions::levels, "", 1, 16,
                  "Number of sizes, each 1.41 times the one before"),
            field("gain", &ExaggeratedOptions::gain, "1", 0.0, 1000.0,
                  "How soon a detail is fully light or dark; 0 shows none"),
            field("detail", &ExaggeratedOptions::detail, "1", 0.0, 1.0,
                  "How strongly details show against the plain shading of the smoothest normals; "
                  "0 leaves that alone"),
            field("balance", &ExaggeratedOptions::balance, "1", -4.0, 4.0,
                  "Weight of a size is that size to this power: 0 shows all alike, negative "
                  "stresses fine details, positive large shapes")});
  }
};

/// Every detail in the light that shows it best (Rusinkiewicz, Burns and DeCarlo 2006). n_0 are the
/// normals, n_i those smoothed by scale * 2^((i - 1) / 2). A level is lit from the part of the
/// light that is perpendicular to the next smoother normal, l_i, unit unless that normal faces the
/// light within about 12 degrees, where it has no side to come from and fades out:
///     c = sum w_i clamp(gain n_i . l_(i+1), -1, 1) / sum w_i, w_i = size^balance;
/// b = (1 - detail / 2) n_levels . light is the base, which leaves room for details where it is
/// fully lit or dark. They are joined as (b + detail c) / (1 + detail b c), which stays within -1
/// and 1 and leaves b where c is 0, as on a plane. The tone is 1/2 + 1/2 of that.
///
/// Target = albedo (linear; empty: white) times the tone's linear light. Normals are unit, in view
/// axes; pixels without one (zero) stay as they are. All images have one size. Returns the pixels
/// of `region` that it may have written. Throws InvalidInput for options out of range.
Rect shade_exaggerated(ImageView<Vec3f> normals, ColorView albedo, ColorSpan target, Rect region,
                       const ExaggeratedOptions& options = {});
/// Pixels read beyond the region.
int reach(const ExaggeratedOptions& options);

}  // namespace normalshop
