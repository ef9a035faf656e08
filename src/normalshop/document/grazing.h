#pragma once

#include "normalshop/document/operate.h"

/// Details that the direction of an edit meets at a grazing angle: walls of letters, rough stone.
/// Their slopes grow beyond all bounds, and what an operator does to one of them would, at the
/// texels beside it, outweigh everything else. Operators therefore see such slopes limited, and
/// where they change something the edit replaces the details instead of adding to them.
namespace normalshop {

/// Slopes up to here are left as they are: 72 degrees.
inline constexpr float steep_slope = 3.0F;
/// All others end up below this: 80 degrees.
inline constexpr float steepest_slope = 6.0F;

/// Limits the slopes of a chart. Returns how far each pixel's edit must replace, 0 to 1; empty
/// where no pixel is as steep.
MaskImage limit_grazing(SlopeSpan slopes);

/// Turns what an operator, reading `before`, added into what replaces it: change and coverage of
/// result.region. It replaces as far as `grazing` (empty: 0) says, and everywhere as far as
/// `finer`, EditOperator::removes_finer(), says. A pixel without any change stays so. `base`: the
/// base surface's numbers, which bicubic reads at its borders need beyond it, too, unless `finer`
/// is 0.
void replace_details(MaskView grazing, float finer, SlopeView before, SlopeView base,
                     OperatorResult& result);

}  // namespace normalshop
