#pragma once

#include <array>
#include <string_view>
#include <tuple>

#include "normalshop/core/border.h"
#include "normalshop/core/image.h"
#include "normalshop/core/options.h"

namespace normalshop {

/// With low = source * g(sigma), fine = source * g(noise_sigma) and g a Gaussian:
enum class FilterKind {
  Gaussian,             ///< low; see smooth()
  HighPass,             ///< amount (source - low)
  BandPass,             ///< amount (fine - low): a difference of Gaussians
  LaplacianOfGaussian,  ///< -amount sigma^2 (d^2/dx^2 + d^2/dy^2) low
  Unsharp,              ///< source + amount (source - low); see sharpen()
  EdgeEnhance,          ///< source + amount (fine - low); see sharpen()
  Scale,                ///< amount source
};
constexpr auto names_of(FilterKind) {
  return std::array<std::string_view, 7>{
      "gaussian", "high_pass",    "band_pass", "laplacian_of_gaussian",
      "unsharp",  "edge_enhance", "scale"};
}
/// Do these filters use noise_sigma?
constexpr bool uses_noise(FilterKind kind) {
  return kind == FilterKind::BandPass || kind == FilterKind::EdgeEnhance;
}

struct FilterOptions {
  FilterKind kind = FilterKind::Gaussian;
  float sigma = 0.0F;
  float noise_sigma = 0.0F;
  float amount = 1.0F;
  Border border = Border::Clamp;

  static constexpr auto fields() {
    return std::tuple{
        field("kind", &FilterOptions::kind,
              "Low, high or band-pass (two kinds), sharpening (two kinds), or scaling the heights"),
        field(
            "sigma", &FilterOptions::sigma, "length", 0.0, 1e6,
            "Standard deviation of the Gaussian that parts shape from details; needed by all kinds "
            "but scale; with 0 there are no details"),
        field(
            "noise_sigma", &FilterOptions::noise_sigma, "length", 0.0, 1e6,
            "Of band_pass and edge_enhance: details smaller than this count as noise; below sigma, "
            "0 counts none"),
        field("amount", &FilterOptions::amount, "1", -100.0, 100.0,
              "Of all kinds but gaussian: factor of what is passed or added; sharpening by 0 and "
              "scaling by 1 leave the input as it is"),
        field("border", &FilterOptions::border, "What is read beyond the image")};
  }
};

/// The linear filters of slopes (thesis 2.2): the result is the slope field of the height filtered
/// in the same way. High-pass and band-pass take away the shape and leave a flat normal texture;
/// sharpening adds it to the source; scaling makes shallow or exaggerated surfaces.
///
/// The Laplacian is a band-pass too: its response to a wave of angular frequency w is
/// amount (sigma w)^2 exp(-(sigma w)^2 / 2), at most 0.74 amount at any scale (w = sqrt(2) /
/// sigma), so amounts mean the same for every sigma. Below sigma 1 it is the sampled kernel's, with
/// the second moment of the second derivative.
///
/// Sizes, validity and aliasing as for smooth(), which also says how exact the Gaussian is. Pixels
/// with validity 0 keep their slopes, but for gaussian. Returns region within target. Throws
/// InvalidInput for options that are not finite or outside their ranges, and for noise_sigma that
/// is not below sigma where it is used.
Rect filter(SlopeView source, MaskView validity, SlopeSpan target, Rect region,
            const FilterOptions& options = {});
/// Pixels read beyond the region.
int reach(const FilterOptions& options);

}  // namespace normalshop
