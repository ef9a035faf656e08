#pragma once

#include <array>
#include <string_view>

#include "normalshop/chart/storage.h"
#include "normalshop/chart/view.h"
#include "normalshop/core/image.h"

namespace normalshop {

/// What a picture of the storage atlas shows. Weight: the effective chart of the view in green.
/// Charts: the atlas' charts in different colours.
enum class RenderStyle { Lit, Normals, Albedo, Weight, Charts };
constexpr auto names_of(RenderStyle) {
  return std::array<std::string_view, 5>{"lit", "normals", "albedo", "weight", "charts"};
}

struct RenderOptions {
  int width = 1200;  ///< pixels
  int height = 1200;
  RenderStyle style = RenderStyle::Lit;
  /// Towards the key light, in view axes (x right, y up, z towards the viewer).
  Vec3f light = {-0.55F, 0.6F, 0.75F};
};

/// Draws the view (widened to the picture's shape) without a GPU, antialiased by supersampling and
/// with ambient occlusion. Linear RGB in 0..1. Throws InvalidInput for a size outside 1..16384.
ColorImage render(const Mesh& mesh, const StorageAtlas& storage, const View& view,
                  const RenderOptions& options = {});

}  // namespace normalshop
