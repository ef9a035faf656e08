#pragma once

#include "normalshop/chart/pull.h"

namespace normalshop {

/// The effective chart (thesis 5.4): 1 where the base surface faces the viewer and no depth step is
/// near, falling smoothly to 0. 0 <= full_angle < zero_angle <= 90, least_step and step_falloff >=
/// 0.
struct EffectiveOptions {
  float full_angle = 60.0F;  ///< degrees between base normal and viewing direction: up to here 1
  float zero_angle = 75.0F;  ///< degrees: from here 0
  /// Object units: smaller steps in depth are none. Pixels longer than half of that tell steps of
  /// two pixels and more.
  float least_step = 0.0F;
  float step_falloff = 0.01F;  ///< object units from a depth step at which the weight is 1 again

  bool operator==(const EffectiveOptions&) const = default;
};

/// The weight that the angles give for a cosine between base normal and a direction.
class FacingWeight {
 public:
  explicit FacingWeight(const EffectiveOptions& options);
  float operator()(float cosine) const;

 private:
  float low_;
  float high_;
};

/// With the lengths that edits have for a model of that size (the diagonal of its box).
EffectiveOptions effective_on(float model_size);

/// Fills chart.weight from chart.ids and chart.base_normal, which must be of the grid's size. A
/// border of the surface against nothing is no depth step: an edit may run to the rim.
void compute_weight(EditingChart& chart, const EffectiveOptions& options);

/// Lowers chart.weight to what the same angles give between base normal and another direction
/// (unit, chart axes). False when that takes away all there is within a rectangle.
bool limit_weight(EditingChart& chart, const EffectiveOptions& options, const Vec3f& direction,
                  const Rect& within);

}  // namespace normalshop
