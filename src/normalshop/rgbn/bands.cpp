#include "normalshop/rgbn/bands.h"

#include <cmath>

#include "normalshop/core/error.h"
#include "normalshop/rgbn/detail/gaussian.h"
#include "normalshop/rgbn/detail/rows.h"
#include "normalshop/rgbn/smooth.h"

namespace normalshop {

namespace {

constexpr std::size_t most_gains = 16;

Vec2f value_of(const Band& band, int x, int y) {
  if (band.lower.empty()) return band.upper(x, y);
  return band.upper(x, y) - band.lower(x, y);
}

/// target = source + factor mask change(x, y), and the source where the factor is 0.
template <class Change>
Rect add_change(SlopeView source, MaskView mask, float factor, SlopeSpan target, Rect region,
                const Change& change) {
  assert(source.rect() == target.rect());
  region = intersect(region, target.rect());
  if (region.empty()) return {};
  for_pixels(region, [&](int x, int y) {
    const float amount = mask.empty() ? factor : factor * mask(x, y);
    const Vec2f& own = source(x, y);
    target(x, y) = amount == 0.0F ? own : Vec2f(own + amount * change(x, y));
  });
  return region;
}

void check(const EqualizeOptions& o, std::span<const float> gains) {
  const auto is_gain = [](float gain) { return std::abs(gain) <= 100.0F; };
  if (!(o.sigma > 0.0F && o.sigma <= 1e6F)) {
    throw InvalidInput("equalize: sigma must be a number above 0, at most 1000000");
  }
  if (gains.size() > most_gains) throw InvalidInput("equalize: there may be at most 16 gains");
  if (!is_gain(o.base_gain)) {
    throw InvalidInput("equalize: base_gain must be a number from -100 to 100");
  }
  if (!std::all_of(gains.begin(), gains.end(), is_gain)) {
    throw InvalidInput("equalize: gains must be numbers from -100 to 100");
  }
}

float octave_sigma(const EqualizeOptions& options, std::size_t level) {
  return std::min(std::ldexp(options.sigma, static_cast<int>(level) - 1), 1e6F);
}

}  // namespace

Rect split(SlopeView source, MaskView validity, SlopeSpan base, SlopeSpan details, Rect region,
           const SplitOptions& options) {
  if (!(options.sigma >= 0.0F && options.sigma <= 1e6F)) {
    throw InvalidInput("split: sigma must be a number from 0 to 1000000");
  }
  assert(source.rect() == base.rect() && source.rect() == details.rect());
  region = intersect(region, source.rect());
  if (region.empty()) return {};
  smooth(source, validity, details, region, {.sigma = options.sigma}, options.border);
  for_pixels(region, [&](int x, int y) {
    const Vec2f& own = source(x, y);
    const bool valid = mask_at(validity, x, y) > 0.0F;
    const Vec2f low = valid ? details(x, y) : own;
    details(x, y) = valid ? Vec2f(own - low) : Vec2f(Vec2f::Zero());
    base(x, y) = low;  // last: it may be the source
  });
  return region;
}

int reach(const SplitOptions& options) { return gaussian_reach(options.sigma); }

Rect scale_band(SlopeView source, const Band& band, MaskView mask, float gain, SlopeSpan target,
                Rect region) {
  if (!std::isfinite(gain)) throw InvalidInput("scale_band: gain must be a finite number");
  return add_change(source, mask, gain - 1.0F, target, region,
                    [&](int x, int y) { return value_of(band, x, y); });
}

Rect transplant_band(SlopeView source, const Band& band, const Band& donor, MaskView mask,
                     float strength, SlopeSpan target, Rect region) {
  if (!std::isfinite(strength)) {
    throw InvalidInput("transplant_band: strength must be a finite number");
  }
  return add_change(source, mask, strength, target, region, [&](int x, int y) {
    return Vec2f(value_of(donor, x, y) - value_of(band, x, y));
  });
}

Rect equalize(SlopeView source, MaskView validity, std::span<const float> gains, SlopeSpan target,
              Rect region, const EqualizeOptions& options) {
  check(options, gains);
  assert(source.rect() == target.rect());
  region = intersect(region, target.rect());
  if (region.empty()) return {};
  // target = source + sum over i of (gains[i] - gains[i - 1]) G_i, where 1 stands before the first.
  const auto gain = [&](std::size_t i) { return i < gains.size() ? gains[i] : options.base_gain; };
  SlopeImage change(region.width(), region.height(), Vec2f::Zero());
  bool changed = false;
  for (std::size_t i = 0; i <= gains.size(); ++i) {
    const float factor = gain(i) - (i == 0 ? 1.0F : gain(i - 1));
    if (factor == 0.0F) continue;
    changed = true;
    SlopeImage level;
    if (i > 0) level = gaussian(source, validity, region, octave_sigma(options, i), options.border);
    for_pixels(region, [&](int x, int y) {
      const int u = x - region.x0;
      const int v = y - region.y0;
      change(u, v) += factor * (level.empty() ? source(x, y) : level(u, v));
    });
  }
  for_pixels(region, [&](int x, int y) {
    const Vec2f& own = source(x, y);
    const bool edit = changed && mask_at(validity, x, y) > 0.0F;
    target(x, y) = edit ? Vec2f(own + change(x - region.x0, y - region.y0)) : own;
  });
  return region;
}

int reach(const EqualizeOptions& options, std::size_t gains) {
  return gains == 0 ? 0 : gaussian_reach(octave_sigma(options, gains));
}

}  // namespace normalshop
