#pragma once

#include <array>
#include <string_view>

#include "normalshop/chart/storage.h"
#include "normalshop/chart/view.h"
#include "normalshop/core/image.h"

namespace normalshop {

/// What a picture of the storage atlas shows. Weight: the effective chart of the view in green.
/// Effective: the same over what is lit, and why an edit would not act elsewhere: red where the
/// base surface turns away from the viewer, blue beside depth steps, in between where it fades out.
/// Charts: the atlas' charts in different colours.
enum class RenderStyle { Lit, Normals, Albedo, Weight, Effective, Charts };
constexpr auto names_of(RenderStyle) {
  return std::array<std::string_view, 6>{"lit",    "normals",   "albedo",
                                         "weight", "effective", "charts"};
}

struct RenderOptions {
  int width = 1200;  ///< pixels
  int height = 1200;
  RenderStyle style = RenderStyle::Lit;
  /// Towards the key light, in view axes (x right, y up, z towards the viewer).
  Vec3f light = {-0.55F, 0.6F, 0.75F};
  /// Degrees, of Weight and Effective: as EffectiveOptions has them.
  float full_angle = 60.0F;
  float zero_angle = 75.0F;
};

/// Draws the view (widened to the picture's shape) without a GPU, antialiased by supersampling and
/// with ambient occlusion. Linear RGB in 0..1. Throws InvalidInput for a size outside 1..16384, and
/// for angles that are not 0 <= full_angle < zero_angle <= 90.
ColorImage render(const Mesh& mesh, const StorageAtlas& storage, const View& view,
                  const RenderOptions& options = {});

}  // namespace normalshop
