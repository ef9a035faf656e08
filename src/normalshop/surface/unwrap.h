#pragma once

#include <cstddef>
#include <tuple>

#include "normalshop/core/options.h"
#include "normalshop/core/progress.h"
#include "normalshop/surface/mesh.h"

namespace normalshop {

struct UnwrapOptions {
  float stretch = 1.2F;
  float angle = 75.0F;
  bool across_hard_edges = false;
  int size = 4096;
  int gutter = 4;

  static constexpr auto fields() {
    return std::tuple{
        field("stretch", &UnwrapOptions::stretch, "1", 1, 10,
              "Largest mean area stretch of a chart; 1 makes a chart of every plane, more makes "
              "fewer charts"),
        field("angle", &UnwrapOptions::angle, "degrees", 1, 85,
              "Largest angle between a chart's direction and the normal of a triangle in it"),
        field("across_hard_edges", &UnwrapOptions::across_hard_edges,
              "Charts may run across hard edges, where the base normals of both sides differ by 15 "
              "degrees or more; where these bound facets (over 64 parts of fewer than 8 triangles "
              "each) they always do"),
        field("size", &UnwrapOptions::size, "pixels", 64, 16384,
              "Side of the map that the atlas is made for, in texels"),
        field("gutter", &UnwrapOptions::gutter, "pixels", 0, 64,
              "Texels that stay free between charts in a map of that size; 0 lets charts touch")};
  }
};

/// What an unwrapping is worth. Triangles without area (thinner than positions can tell) are left
/// out of everything but `degenerate`.
///
/// Area stretch of a triangle: r, the ratio of its area in the map to that on the surface relative
/// to the ratio of all triangles together, or 1 / r, whichever is larger.
struct UnwrapReport {
  std::size_t triangles = 0;
  std::size_t degenerate = 0;
  std::size_t charts = 0;
  double coverage = 0.0;         ///< share of the map's area that triangles cover
  double mean_stretch = 1.0;     ///< by area on the surface
  double largest_stretch = 1.0;  ///< of any triangle
  std::size_t overlaps = 0;      ///< pairs of triangles that overlap in the map; 0
  std::size_t turned_over = 0;   ///< mirrored in the map: 0, but for needles as thin as rounding
};

/// Gives the mesh a new atlas: fills uvs, drops tangents, and makes all triangles one texture set
/// (which keeps its name if there was one alone, else "surface"). Every chart is the orthographic
/// projection of connected triangles along its own direction, which all of them face: nothing in
/// it is turned over or overlaps, and texels are alike everywhere but for the slant. Charts grow
/// from directions by variational partition (Cohen-Steiner, Alliez, Desbrun 2004; for projective
/// atlases Velho and Sossai 2007), are split where their projection overlaps itself, merged while
/// their stretch allows, and packed as pictures. A triangle without area that no chart can hold
/// lies in one point of a neighbour's.
///
/// UVs lie within 0..1. The result is the same for any number of threads. Throws InvalidInput when
/// the mesh has no triangle with an area, an index or a position is unusable, an option is out of
/// its range or its gutter leaves no room; then, or when cancelled, the mesh stays as it was.
UnwrapReport unwrap(Mesh& mesh, const UnwrapOptions& options = {}, const Progress& progress = {});

}  // namespace normalshop
