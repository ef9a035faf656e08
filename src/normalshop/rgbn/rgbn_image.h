#pragma once

#include "normalshop/core/image.h"

/// An RGBN image as operators that use more than its slopes take it. All images that are not empty
/// have one size.
namespace normalshop {

struct RgbnView {
  SlopeView slopes;
  ColorView color;    ///< linear; empty: the operator works on slopes alone
  MaskView validity;  ///< 0 to 1: how far a pixel counts; empty: 1 everywhere
};

struct RgbnSpan {
  SlopeSpan slopes;
  ColorSpan color;  ///< empty: colour is not wanted
};

}  // namespace normalshop
