#pragma once

#include <vector>

#include "normalshop/chart/effective.h"

namespace normalshop {

/// How a surface is covered with views.
struct CoverOptions {
  int views = 0;  ///< how many at most; 0: as many as show something better than the others do
  EffectiveOptions effective;
};

/// A view of the whole surface, and the part of it for which it counts: in object units from its
/// centre, y up.
struct CoverView {
  View view;
  Vec2f low;
  Vec2f high;
};

/// Views that together show the surface as squarely as views can, the most telling first. What no
/// view shows (deep folds, closed
/// cavities) is left out. Deterministic. Throws InvalidInput when the mesh has no surface.
///
/// Source: thesis 4.4 asks the user for such views; here they are chosen greedily among directions
/// spread over the sphere, by the area that each shows better than those before it.
std::vector<CoverView> cover_surface(const Mesh& mesh, const CoverOptions& options);

/// How much a view counts where its weight is 1, by the cosine between base normal and viewing
/// direction: the eighth power, from 30 degrees a third of one that faces the surface.
inline float facing_share(float cosine) {
  const float squared = cosine * cosine;
  const float fourth = squared * squared;
  return fourth * fourth;
}

}  // namespace normalshop
