#pragma once

#include <vector>

#include "normalshop/core/image.h"

/// Pictures of RGBN images. Directions are in view axes: x right, y up, z towards the viewer.
namespace normalshop {

struct Light {
  Vec3f direction;  ///< towards the light; need not be unit
  Vec3f color;      ///< linear; pi lights a white surface that faces it to 1
};

struct Material {
  float roughness = 0.42F;  ///< 0 to 1, perceptual (GGX alpha = roughness^2)
  float specular = 0.04F;   ///< reflectance at normal incidence
};

/// A studio: warm soft key from the upper left, weak fill from the right, cool rim from behind, sky
/// from above and bounce from below. `key` from elsewhere keeps the rest.
struct ShadeOptions {
  std::vector<Light> lights = studio_lights({-0.55F, 0.6F, 0.75F});
  Vec3f sky = {0.20F, 0.23F, 0.27F};
  Vec3f ground = {0.07F, 0.06F, 0.055F};
  Material material;
  float exposure = 1.0F;

  static std::vector<Light> studio_lights(const Vec3f& key);
};

/// Lights unit normals with albedo (linear; empty: neutral grey) seen orthographically along -z.
/// `occlusion` (1 open, 0 closed; empty: 1) darkens the ambient light, `shadow` (1 lit; empty: 1)
/// the first light. Linear, tone mapped to 0..1. Pixels whose normal is zero stay as they are in
/// target. All images have one size.
void shade(ImageView<Vec3f> normals, ColorView albedo, MaskView occlusion, MaskView shadow,
           ColorSpan target, const ShadeOptions& options = {});

/// Normals as colours (n + 1) / 2, as CODES, not linear light: write them without a transfer
/// function. Zero normals stay as they are in target.
void normal_colors(ImageView<Vec3f> normals, ColorSpan target);

/// A quiet dark gradient to stand behind a model, linear.
void studio_background(ColorSpan target);

/// How open each pixel is to the hemisphere around the view (1 open, 0 closed), from heights in
/// pixels towards the viewer; not finite: nothing there (result 1). Horizons within `radius` pixels
/// in 12 directions.
void ambient_occlusion(MaskView height, float radius, MaskSpan target);

/// 1 where the light with this direction reaches the height field, 0 in its shadow, soft between;
/// shadows of things up to `distance` pixels away.
void cast_shadow(MaskView height, const Vec3f& direction, float distance, MaskSpan target);

}  // namespace normalshop
