#pragma once

#include <tuple>

#include "normalshop/core/options.h"
#include "normalshop/core/vec.h"

namespace normalshop {

/// How something flat is laid on the chart, besides its size and place: first scaled, then sheared,
/// then turned. Base of the options that share these fields.
struct Placement {
  float rotation = 0.0F;
  float scale_x = 1.0F;
  float scale_y = 1.0F;
  float shear = 0.0F;
};

template <class Owner>
constexpr auto placement_fields() {
  return std::tuple{
      field<Owner, float>("rotation", &Owner::rotation, "degrees", -360.0, 360.0,
                          "Turns it counter-clockwise"),
      field<Owner, float>("scale_x", &Owner::scale_x, "1", -100.0, 100.0,
                          "Stretches it sideways; negative mirrors; not 0"),
      field<Owner, float>("scale_y", &Owner::scale_y, "1", -100.0, 100.0,
                          "Stretches it upwards; negative mirrors; not 0"),
      field<Owner, float>("shear", &Owner::shear, "1", -10.0, 10.0,
                          "Slants it: moves a point sideways by this times its height")};
}

/// The linear map of a placement, y UP on both sides; exact for multiples of 90 degrees. Throws
/// InvalidInput for a scale of 0 and for numbers that are not finite.
Mat2f placement_matrix(const Placement& placement);

}  // namespace normalshop
