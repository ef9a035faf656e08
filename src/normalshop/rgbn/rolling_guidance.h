#pragma once

#include <tuple>

#include "normalshop/core/border.h"
#include "normalshop/core/options.h"
#include "normalshop/rgbn/rgbn_image.h"

namespace normalshop {

struct RollingGuidanceOptions {
  float sigma_space = 3.0F;
  float sigma_color = 0.1F;
  float sigma_normal = 0.2F;
  float guide_sigma = 0.5F;
  int iterations = 3;
  Border border = Border::Clamp;

  static constexpr auto fields() {
    using Options = RollingGuidanceOptions;
    return std::tuple{
        field("sigma_space", &Options::sigma_space, "length", 0.0, 1e6,
              "Standard deviation in the image, at most 100 pixels; 0 leaves the input as it is"),
        field("sigma_color", &Options::sigma_color, "1", 0.0, 1e6,
              "Colours this far apart in linear RGB hardly mix; 0 ignores colour"),
        field("sigma_normal", &Options::sigma_normal, "1", 0.0, 1e6,
              "Unit normals this far apart hardly mix: 0.2 is 11 degrees, below 0.005 is 0.005; 0 "
              "ignores normals"),
        field("guide_sigma", &Options::guide_sigma, "length", 0.0, 1e6,
              "Structures smaller than this Gaussian vanish, the edges of larger ones come back; 0 "
              "starts from the input"),
        field("iterations", &Options::iterations, "1", 0, 20,
              "How often edges are brought back; 0 leaves the input as it is"),
        field("border", &Options::border, "What is read beyond the image")};
  }
};

/// Rolling guidance (Zhang et al. 2014): takes out what is small and keeps the edges of what is
/// large.
///     guide_0 = the source blurred by guide_sigma,  guide_{k+1} = bilateral(source, guide_k),
/// and the last guide is the result, slopes and, where they are wanted, colours. Each step is
/// bilateral() with its contract; beyond the image the source goes on as `border` says.
///
/// Images, aliasing, regions and what is returned as for bilateral(). Throws InvalidInput for
/// options outside their ranges.
Rect rolling_guidance(const RgbnView& source, const RgbnSpan& target, Rect region,
                      const RollingGuidanceOptions& options = {});
/// Pixels read beyond the region.
int reach(const RollingGuidanceOptions& options);

}  // namespace normalshop
