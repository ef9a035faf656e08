#pragma once

#include "normalshop/core/image.h"

namespace normalshop {

/// Continues attributes past the border of the surface: pixels with validity 0 take smooth values
/// of their surroundings (pull-push: Gortler et al. 1996), so that filters and bicubic reads near a
/// border find a signal. Valid pixels (validity > 0) keep theirs exactly. Ids are never extended.
void extend(MaskView validity, SlopeSpan values);
void extend(MaskView validity, ColorSpan values);

}  // namespace normalshop
