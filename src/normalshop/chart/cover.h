#pragma once

#include <memory>
#include <vector>

#include "normalshop/chart/effective.h"

namespace normalshop {

/// How a surface is covered with views.
struct CoverOptions {
  /// How many at most show the outer surface; 0: as many as show something better than others do.
  int views = 0;
  EffectiveOptions effective;

  bool operator==(const CoverOptions&) const = default;
};

/// A view of the whole surface, and the part of it for which it counts: in object units from its
/// centre, y up.
struct CoverView {
  View view;
  Vec2f low;
  Vec2f high;
  /// What it shows: positions and triangles of the mesh, all triangles that hide these shrunk to
  /// points, and no back faces; null: all.
  std::shared_ptr<const Mesh> shown;

  void rasterize(const Mesh& mesh, const ChartGrid& grid, IdBuffer& out) const;
};

/// Views that together show the surface as squarely as views can, the most telling first. Surface
/// that is hidden from all sides (inside a mouth, behind a lid) is shown by further views without
/// what hides it. Deterministic. Throws InvalidInput when the mesh has no surface.
///
/// Source: thesis 4.4 asks the user for such views; here they are chosen greedily among directions
/// spread over the sphere, by the area that each shows better than those before it.
std::vector<CoverView> cover_surface(const Mesh& mesh, const CoverOptions& options);

/// Views to be kept from edit to edit.
struct SurfaceCover {
  CoverOptions options;
  std::vector<CoverView> views;  ///< cover_surface() with the options; empty: not asked for yet
};

/// How much a view counts where its weight is 1, by the cosine between base normal and viewing
/// direction: the eighth power, from 30 degrees a third of one that faces the surface.
inline float facing_share(float cosine) {
  const float squared = cosine * cosine;
  const float fourth = squared * squared;
  return fourth * fourth;
}

}  // namespace normalshop
