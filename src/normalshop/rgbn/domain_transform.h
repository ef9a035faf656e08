#pragma once

#include <tuple>

#include "normalshop/core/border.h"
#include "normalshop/core/options.h"
#include "normalshop/rgbn/rgbn_image.h"

namespace normalshop {

struct DomainTransformOptions {
  float sigma_space = 6.0F;
  float sigma_color = 0.1F;
  float sigma_normal = 0.2F;
  float guide_sigma = 0.8F;
  int rolls = 1;
  int iterations = 2;
  Border border = Border::Clamp;

  static constexpr auto fields() {
    using Options = DomainTransformOptions;
    return std::tuple{
        field("sigma_space", &Options::sigma_space, "length", 0.0, 1e6,
              "Standard deviation where nothing differs; 0 leaves the input as it is"),
        field("sigma_color", &Options::sigma_color, "1", 0.0, 1e6,
              "Changes of colour along the way, in linear RGB, that stop the filter as sigma_space "
              "does; 0 ignores colour"),
        field(
            "sigma_normal", &Options::sigma_normal, "1", 0.0, 1e6,
            "Turns of the unit normal along the way that stop the filter as sigma_space does (0.2 "
            "is 11 degrees); 0 ignores normals"),
        field("guide_sigma", &Options::guide_sigma, "length", 0.0, 1e6,
              "Gaussian that takes noise out of what is compared; 0 compares the input itself"),
        field("rolls", &Options::rolls, "1", 0, 10,
              "How often the filtered image becomes what is compared and the input is filtered "
              "anew; 0 filters once"),
        field("iterations", &Options::iterations, "1", 1, 10,
              "Passes along rows and columns; few leave streaks"),
        field("border", &Options::border, "What is read beyond the image")};
  }
};

/// Smooths within edges at a cost that does not depend on sigma: the recursive domain transform
/// (Gastal and Oliveira 2011) of slopes and colours, guided as in rolling guidance (Zhang et al.
/// 2014), for brushes and previews. Neighbours i, j along a row or column are
///     1 + sigma_space (|n_i - n_j| / sigma_normal + |c_i - c_j| / sigma_color)
/// apart, with unit normals n and linear colours c of a guide; along such distances runs a
/// recursive filter, forth and back, rows then columns, `iterations` times with halved width. The
/// guide is the source blurred by guide_sigma and then, `rolls` times, what one iteration of the
/// filter with the last guide makes of the source.
///
/// Slopes count as at most 20. Pixels weigh by their validity; where it is 0 or the pixel isn't
/// finite they keep their bits and nothing passes through them. What is constant stays so to the
/// last bit.
///
/// Without colour sigma_color is ignored. All images have one size; target.color needs
/// source.color; target may be source. A region differs from the whole image by less than 2e-4 of
/// what slopes vary; Border::Wrap and Mirror read no further than the image is long. Returns the
/// pixels that it wrote: region within target. Throws InvalidInput for options outside their
/// ranges.
Rect domain_transform(const RgbnView& source, const RgbnSpan& target, Rect region,
                      const DomainTransformOptions& options = {});
/// Pixels read beyond the region.
int reach(const DomainTransformOptions& options);

}  // namespace normalshop
