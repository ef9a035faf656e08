#pragma once

#include <tuple>

#include "normalshop/core/image.h"
#include "normalshop/core/options.h"

namespace normalshop {

struct CurvatureShadeOptions {
  float scale = 1.0F;
  int levels = 6;
  float gain = 5.0F;
  float balance = 0.0F;
  float guard = 60.0F;

  static constexpr auto fields() {
    return std::tuple{
        field("scale", &CurvatureShadeOptions::scale, "length", 0.3, 1e3,
              "Size of the finest details that show"),
        field("levels", &CurvatureShadeOptions::levels, "", 1, 16,
              "Number of sizes, each 1.41 times the one before"),
        field("gain", &CurvatureShadeOptions::gain, "1", 0.0, 1000.0,
              "How strongly bends turn light or dark; 0 is an even middle grey"),
        field("balance", &CurvatureShadeOptions::balance, "1", -4.0, 4.0,
              "Weight of a size is that size to this power: 0 shows all alike, negative stresses "
              "fine details, positive large shapes"),
        field("guard", &CurvatureShadeOptions::guard, "degrees", 0.0, 180.0,
              "Neighbours whose normals differ by more count as different surfaces; 180 joins "
              "everything")};
  }
};

/// Ridges light and furrows dark, whatever the light: the tone is 1/2 + 1/2 sum w_i tanh(gain r_i
/// H_i) / sum w_i with H_i the mean curvature at scale r_i = scale * 2^(i / 2), and w_i = r_i^
/// balance. Target = albedo (linear; empty: white) times the tone's linear light. Normals are unit,
/// in view axes; pixels without one (zero) stay as they are. All images have one size. Returns the
/// pixels of `region` that it may have written. Throws InvalidInput for options out of range.
/// Source: Toler-Franklin et al. 2007.
Rect shade_curvature(ImageView<Vec3f> normals, ColorView albedo, ColorSpan target, Rect region,
                     const CurvatureShadeOptions& options = {});
/// Pixels read beyond the region.
int reach(const CurvatureShadeOptions& options);

}  // namespace normalshop
