#pragma once

#include <tuple>

#include "normalshop/core/image.h"
#include "normalshop/core/options.h"

namespace normalshop {

struct DiscontinuityShadowOptions {
  float azimuth = 135.0F;
  float length = 24.0F;
  float strength = 0.6F;
  float jump = 40.0F;
  float shortest = 12.0F;
  float softness = 1.5F;

  static constexpr auto fields() {
    return std::tuple{
        field("azimuth", &DiscontinuityShadowOptions::azimuth, "degrees", -360.0, 360.0,
              "Where the light comes from, counter-clockwise: 0 the right, 90 above, 135 the upper "
              "left"),
        field("length", &DiscontinuityShadowOptions::length, "length", 0.0, 1e3,
              "How far the shadows reach; 0 casts none"),
        field("strength", &DiscontinuityShadowOptions::strength, "1", 0.0, 1.0,
              "Darkness beside the edge that casts it; 0 casts none"),
        field("jump", &DiscontinuityShadowOptions::jump, "degrees", 1.0, 180.0,
              "Least angle between the normals of neighbours that counts as a step in depth; 180 "
              "leaves the outline alone"),
        field("shortest", &DiscontinuityShadowOptions::shortest, "length", 0.0, 1e3,
              "Smaller edges than this cast no shadow, as in grain and noise; 0 lets all cast one"),
        field("softness", &DiscontinuityShadowOptions::softness, "length", 0.0, 1e3,
              "Sigma by which the shadows are blurred; 0 leaves their edges hard")};
  }
};

/// Shadows without depths: how lit a pixel is (1 fully) where something in front stands between it
/// and the light. Marching from the pixel towards the light in the picture, the first step between
/// surfaces decides: neighbours whose normals differ by `jump`, in a group of such pixels that is
/// at least `shortest` wide or high. It casts a shadow when the surface beyond it turns away from
/// the light (its rim falls off towards the pixel) more than the surface before it; then the shadow
/// fades out over `length`. Where there is nothing (zero), a surface counts as in front: an outline
/// casts a shadow on the paper. The result serves as `shadow` of shade() in shade.h or multiplies a
/// style.
///
/// Normals are unit, in view axes. All images have one size. Returns the pixels that it wrote.
/// Throws InvalidInput for options out of range. Source: Toler-Franklin et al. 2007, idea.
Rect discontinuity_shadow(ImageView<Vec3f> normals, MaskSpan target, Rect region,
                          const DiscontinuityShadowOptions& options = {});
/// Pixels read beyond the region.
int reach(const DiscontinuityShadowOptions& options);

}  // namespace normalshop
