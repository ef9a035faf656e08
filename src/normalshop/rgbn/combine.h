#pragma once

#include "normalshop/core/image.h"

namespace normalshop {

/// Linear combination (thesis 2.3): target = base + strength * mask * details in `region`. It keeps
/// integrability and every frequency that the details don't have. An empty mask means 1 everywhere.
/// All images have one size; target may be base. Returns the region that it wrote.
Rect combine_linear(SlopeView base, SlopeView details, MaskView mask, float strength,
                    SlopeSpan target, Rect region);

}  // namespace normalshop
