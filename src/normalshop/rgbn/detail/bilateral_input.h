#pragma once

#include "normalshop/rgbn/bilateral.h"
#include "normalshop/rgbn/detail/rgbn_window.h"

/// What the fast and the exact bilateral filter have in common, private to this floor.
namespace normalshop {

/// Throws InvalidInput.
void check(const BilateralOptions& options);

/// The kernel is the disk of offsets not longer than this.
int kernel_radius(const BilateralOptions& options);

/// Copies of the source and of the guide around a region, and where the region lies in them.
struct BilateralInput {
  RgbnWindow source;
  RgbnWindow separate_guide;  ///< empty where the source is the guide
  Rect region;

  const RgbnWindow& guide() const {
    return separate_guide.slopes.empty() ? source : separate_guide;
  }
  float weight(int x, int y) const {
    const float own = source.validity.empty() ? 1.0F : source.validity(x, y);
    const MaskImage& other = guide().validity;
    return other.empty() || other(x, y) > 0.0F ? own : 0.0F;
  }
};

/// `guide` without slopes stands for the source. The region lies within the image and isn't empty.
BilateralInput bilateral_input(const RgbnView& source, const RgbnView& guide, const Rect& region,
                               const BilateralOptions& options);

}  // namespace normalshop
