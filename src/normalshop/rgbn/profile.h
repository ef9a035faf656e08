#pragma once

#include <array>
#include <string_view>

#include "normalshop/core/curve.h"

namespace normalshop {

/// Height across a stroke. Bump: raised, round. Crease: a sharp valley between soft shoulders, its
/// slope jumps at u = 0. Scratch: a round valley between raised lips. Step: a change of level, for
/// closed strokes. Custom: the user's curve.
enum class ProfileShape { Bump, Crease, Scratch, Step, Custom };
constexpr auto names_of(ProfileShape) {
  return std::array<std::string_view, 5>{"bump", "crease", "scratch", "step", "custom"};
}

/// A stroke's height h(u) for u in [-1, 1], u = signed distance from the stroke / half its width:
/// positive left of an open stroke (as seen, looking along it) and inside a closed one. The largest
/// height is 1 (bump, step), the deepest valley -1 (crease, scratch).
///
/// h(-1) = 0 and h has slope and curvature 0 at both ends (Custom: slope). At u = 1 the level is 0
/// too, except for closed strokes with Step (1) or Custom: an open stroke must not change the level
/// (thesis 2.4.1). Custom curves are made to comply: a smooth ramp (open) or a constant (closed) is
/// subtracted.
class Profile {
 public:
  struct Options {
    ProfileShape shape = ProfileShape::Bump;
    bool closed = false;
    Curve curve;  ///< of Custom: points (u, height)
  };
  /// Throws InvalidInput for Step with closed = false, and for Custom when the curve is empty or
  /// has points outside [-1, 1].
  explicit Profile(const Options& options);

  struct Value {
    float height;
    float slope;  ///< dh/du; of a crease at u = 0: 0
  };
  /// Outside [-1, 1] the level continues.
  Value at(float u) const;
  /// The same with a slope jump (a crease's bottom) spread evenly over `radius` on both sides: the
  /// slope of the height averaged over that width, so that pixels don't draw it as stairs.
  Value at(float u, float radius) const;
  /// h(1): what the inside of a closed stroke is raised by.
  float level() const { return level_; }
  ProfileShape shape() const { return shape_; }

 private:
  Value custom(float u) const;

  ProfileShape shape_;
  Curve curve_;
  bool closed_;
  float first_ = 0.0F;
  float last_ = 0.0F;
  float level_ = 0.0F;
};

}  // namespace normalshop
