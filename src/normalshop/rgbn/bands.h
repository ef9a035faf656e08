#pragma once

#include <span>
#include <tuple>

#include "normalshop/core/border.h"
#include "normalshop/core/image.h"
#include "normalshop/core/options.h"

/// Frequency bands of slopes (thesis 2.2 and 2.5): the base surface, the details over it, and what
/// lies between two scales. All images of a call have one size.
namespace normalshop {

struct SplitOptions {
  float sigma = 4.0F;
  Border border = Border::Clamp;

  static constexpr auto fields() {
    return std::tuple{field("sigma", &SplitOptions::sigma, "length", 0.0, 1e6,
                            "Standard deviation of the Gaussian that makes the base; with 0 there "
                            "are no details"),
                      field("border", &SplitOptions::border, "What is read beyond the image")};
  }
};

/// base = source * g(sigma), details = source - base in `region`. base + details is the source
/// again, within a rounding of each (6e-8 |base| + 6e-8 |details|). Pixels with validity 0 are all
/// base. Validity and errors as for smooth(); base may be source, details neither. Returns region
/// within the images.
Rect split(SlopeView source, MaskView validity, SlopeSpan base, SlopeSpan details, Rect region,
           const SplitOptions& options = {});
/// Pixels read beyond the region.
int reach(const SplitOptions& options);

/// What `upper` has and `lower` has not: upper - lower; an empty lower is 0. The details over any
/// base are {source, base}, whichever filter made the base; the base itself is {base, {}}; a band
/// is two Gaussians, the finer first.
struct Band {
  SlopeView upper;
  SlopeView lower;
};

/// target = source + (gain - 1) mask (band of the source): gain 0 takes the band away, 1 leaves the
/// source bit for bit, as does mask 0. target may be any of the images. Returns region within
/// target. Throws InvalidInput for a gain that is not finite.
Rect scale_band(SlopeView source, const Band& band, MaskView mask, float gain, SlopeSpan target,
                Rect region);

/// target = source + strength mask (donor's band - the source's band): with 1 the donor's band
/// replaces the source's, with 0 the source is left bit for bit. Details of one image on the shape
/// of another are {donor, donor_base} over {source, base}. Otherwise as scale_band.
Rect transplant_band(SlopeView source, const Band& band, const Band& donor, MaskView mask,
                     float strength, SlopeSpan target, Rect region);

struct EqualizeOptions {
  float sigma = 1.0F;
  float base_gain = 1.0F;
  Border border = Border::Clamp;

  static constexpr auto fields() {
    return std::tuple{
        field("sigma", &EqualizeOptions::sigma, "length", 0.0, 1e6,
              "Standard deviation below which the finest band lies; above 0, and doubled from band "
              "to band"),
        field("base_gain", &EqualizeOptions::base_gain, "1", -100.0, 100.0,
              "Factor of the shape that is left below all bands; 1 leaves it as it is"),
        field("border", &EqualizeOptions::border, "What is read beyond the image")};
  }
};

/// An equaliser: with G_0 = source and G_i = source * g(2^(i-1) sigma),
///     target = sum over i of gains[i] (G_i - G_(i+1)) + base_gain G_n,    n = gains.size().
/// gains[0] is of the details below sigma, each further one of an octave. Gains that are all 1
/// leave the input bit for bit; between equal ones nothing is filtered. Validity as for smooth();
/// pixels with 0 keep their slopes. target may be source. Returns region within target. Throws
/// InvalidInput for more than 16 gains, for options and gains that are not finite or outside -100
/// to 100, and unless sigma is from above 0 to 1000000.
Rect equalize(SlopeView source, MaskView validity, std::span<const float> gains, SlopeSpan target,
              Rect region, const EqualizeOptions& options = {});
/// Pixels read beyond the region, with that many gains.
int reach(const EqualizeOptions& options, std::size_t gains);

}  // namespace normalshop
