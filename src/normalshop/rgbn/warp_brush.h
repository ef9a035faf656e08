#pragma once

#include <array>
#include <string_view>
#include <tuple>

#include "normalshop/core/options.h"
#include "normalshop/rgbn/warp_lattice.h"

/// Brushes that edit a warp: each puts a small warp in front of the lattice's, W := W o dab, and
/// what the picture shows moves. Within `radius` a dab falls off as (1 - (r / radius)^2)^3.
namespace normalshop {

/// What a brush does where the picture would fold over.
enum class OnFold {
  Limit,   ///< halves its strength until it does not; after six times it does nothing
  Refuse,  ///< throws InvalidInput that names the place
};
constexpr auto names_of(OnFold) { return std::array<std::string_view, 2>{"limit", "refuse"}; }

struct WarpBrushOptions {
  float radius = 50.0F;
  float strength = 1.0F;
  float least_area = 0.01F;
  OnFold on_fold = OnFold::Limit;

  static constexpr auto fields() {
    return std::tuple{
        field("radius", &WarpBrushOptions::radius, "length", 0.0, 1e6,
              "How far from its centre the brush acts; 0 does nothing"),
        field("strength", &WarpBrushOptions::strength, "1", -10.0, 10.0,
              "Push and grab: part of the motion; pinch: how many times the size halves, negative "
              "inflates; twirl: quarter turns counter-clockwise; 0 does nothing"),
        field("least_area", &WarpBrushOptions::least_area, "1", 1e-6, 1.0,
              "The smallest det DW that counts as no fold; 0.01 lets things become 100 times as "
              "large"),
        field("on_fold", &WarpBrushOptions::on_fold,
              "Whether the strength is limited or the brush refused where the picture would fold")};
  }
};

/// What a brush did.
struct WarpDab {
  Rect changed;           ///< the pixels whose warp changed; empty: none
  float strength = 0.0F;  ///< what was left of the strength
};

/// All brushes take places in pixels, y down, cut large motions into small ones, and leave the
/// lattice untouched when they throw. They throw InvalidInput for numbers that are not finite or
/// out of range, for a radius below two cells of the lattice, and, where the lattice repeats, for
/// one above half of it.

/// Smears along the way from `from` to `to`, dab after dab.
WarpDab push(WarpLattice& lattice, const Vec2f& from, const Vec2f& to,
             const WarpBrushOptions& options);

/// Takes hold at `from` and moves: what is there ends strength times the way to `to`, and what is
/// around follows by the falloff around `from`.
WarpDab grab(WarpLattice& lattice, const Vec2f& from, const Vec2f& to,
             const WarpBrushOptions& options);

/// Scales towards or away from the centre, there by 2^-strength.
WarpDab pinch(WarpLattice& lattice, const Vec2f& center, const WarpBrushOptions& options);

/// Turns about the centre; keeps areas.
WarpDab twirl(WarpLattice& lattice, const Vec2f& center, const WarpBrushOptions& options);

}  // namespace normalshop
