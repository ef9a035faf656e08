#include "normalshop/rgbn/detail/bilateral_input.h"

#include <cmath>
#include <string>

#include "normalshop/core/error.h"
#include "normalshop/rgbn/smooth.h"

namespace normalshop {

namespace {

constexpr float most_pixels = 100.0F;

void check_number(float value, float most, const char* name, const char* accepted) {
  if (value >= 0.0F && value <= most) return;
  throw InvalidInput("bilateral: " + std::string(name) + " must be a number " + accepted);
}

/// Smooths a window by the guide's Gaussian.
void blur(RgbnWindow& window, float sigma) {
  const Rect all = window.slopes.rect();
  smooth(window.slopes, window.validity, window.slopes, all, {.sigma = sigma});
  if (!window.color.empty()) {
    smooth(window.color, window.validity, window.color, all, {.sigma = sigma});
  }
}

}  // namespace

void check(const BilateralOptions& options) {
  check_number(options.sigma_space, most_pixels, "sigma_space", "from 0 to 100 pixels");
  check_number(options.guide_sigma, most_pixels, "guide_sigma", "from 0 to 100 pixels");
  check_number(options.sigma_color, 1e6F, "sigma_color", "from 0 to 1000000");
  check_number(options.sigma_normal, 1e6F, "sigma_normal", "from 0 to 1000000");
}

int kernel_radius(const BilateralOptions& options) {
  return std::max(0, static_cast<int>(std::ceil(2.0F * options.sigma_space)) - 1);
}

int reach(const BilateralOptions& options) {
  return kernel_radius(options) + reach(SmoothOptions{.sigma = options.guide_sigma});
}

BilateralInput bilateral_input(const RgbnView& source, const RgbnView& guide, const Rect& region,
                               const BilateralOptions& options) {
  const int margin = reach(options);
  const Rect held = grow(region, margin);
  BilateralInput input;
  input.source = gather_window(source, held, options.border);
  input.region = {margin, margin, margin + region.width(), margin + region.height()};
  const bool joint = !guide.slopes.empty();
  if (joint || options.guide_sigma > 0.0F) {
    input.separate_guide = gather_window(joint ? guide : source, held, options.border);
    if (options.guide_sigma > 0.0F) blur(input.separate_guide, options.guide_sigma);
  }
  return input;
}

}  // namespace normalshop
