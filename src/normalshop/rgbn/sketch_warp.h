#pragma once

#include <span>
#include <tuple>

#include "normalshop/core/options.h"
#include "normalshop/rgbn/stroke.h"
#include "normalshop/rgbn/warp_lattice.h"

namespace normalshop {

/// What is on `source` shall come to lie on `target`. Pressure is not used.
struct SketchPair {
  Stroke source;
  Stroke target;
  /// Both strokes are outlines. They are matched by their shapes: where they start and which way
  /// they run does not matter. Open strokes are matched as they were drawn, start to start; one
  /// point each pins a point.
  bool closed = false;
};

struct SketchWarpOptions {
  float spacing = 4.0F;
  float point_spacing = 8.0F;
  float least_area = 0.01F;

  static constexpr auto fields() {
    return std::tuple{
        field("spacing", &SketchWarpOptions::spacing, "pixels", 1.0, 1e4,
              "Distance of the lattice's nodes; small ones follow the strokes more closely"),
        field("point_spacing", &SketchWarpOptions::point_spacing, "length", 0.5, 1e6,
              "Distance of the points that are fitted along the strokes; large ones give way to "
              "smoother warps"),
        field("least_area", &SketchWarpOptions::least_area, "1", 1e-6, 1.0,
              "The smallest det DW that counts as no fold")};
  }
};

struct SketchWarp {
  WarpLattice lattice;  ///< over the boundary's surroundings
  LeastArea least;      ///< where it comes closest to folding
  int steps = 1;        ///< into which the motion was cut
  double miss = 0.0;    ///< how far the worst fitted point ends from its place, pixels
};

/// A warp from pairs of strokes (thesis 2.4, Pereira et al.): an interpolation by Hermite-Birkhoff
/// radial functions of points at equal parts of the strokes' lengths, with W = identity and DW = I
/// on the closed stroke `boundary`, evaluated into a lattice and corrected there until the fitted
/// points are met within 1e-4 pixels, or where they crowd within cells (point_spacing < spacing) as
/// well as they can be. Outside the boundary, and inside of it up to the diagonal of a lattice's
/// cell, the warp is exactly the identity, which it joins continuously with its derivative.
///
/// Sketches of borders (where the outline of a thing is, where it shall be) are closed pairs,
/// sketches of the interior open ones.
///
/// A warp that folds over (det DW < least_area) is cut into 2, 4 or 8 steps along straight ways,
/// each solved and composed. About 1500 unknowns at most: with many strokes the fitted points stand
/// farther apart. A solve takes O(unknowns^3), evaluation nodes x points.
///
/// Throws InvalidInput for numbers that are not finite or out of range, a boundary of fewer than 3
/// points or without an inside, an empty stroke, a point pinned to a line, target points outside
/// the boundary or beside it where the warp is the identity, points missed by more than 0.05
/// pixels, strokes that cross and contradict each other, and warps that fold over nevertheless; the
/// message names the place. No pairs: identity.
SketchWarp sketch_warp(const Stroke& boundary, std::span<const SketchPair> pairs,
                       const SketchWarpOptions& options = {});

}  // namespace normalshop
