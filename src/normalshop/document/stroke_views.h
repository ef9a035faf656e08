#pragma once

#include "normalshop/chart/cover.h"
#include "normalshop/document/edit.h"

namespace normalshop {

/// A view of some of the strokes on the surface.
struct StrokeView {
  View view;
  std::vector<std::uint32_t> triangles;  ///< all that it shows: those near what it draws
  std::vector<UnitStroke> strokes;       ///< what it draws: parts that face it, with arc lengths

  CoverView cover(const Mesh& mesh) const;
};

/// Views that together draw all of an edit's surface strokes, each part of them from where the
/// surface under it faces the viewer within some 25 degrees. A view shows only the surface that
/// hangs together with its parts and is near to them, so that nothing hides them, and draws
/// whatever strokes lie on that surface and face it: where two views show a place they draw the
/// same there. Throws InvalidInput, naming the field.
std::vector<StrokeView> view_strokes(const Edit& edit, const Mesh& mesh);

}  // namespace normalshop
