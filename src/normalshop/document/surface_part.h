#pragma once

#include <span>
#include <vector>

#include "normalshop/chart/cover.h"
#include "normalshop/document/edit.h"
#include "normalshop/surface/seams.h"

namespace normalshop {

/// Which triangles of a mesh an edit of the surface is for.
class PartMask {
 public:
  /// Of Edit::part: all triangles of the charts that hold its points. Without one: all. Throws
  /// InvalidInput, naming the point, for one further from the surface than a twentieth of the
  /// model's size.
  PartMask(const Edit& edit, const Mesh& mesh);

  bool all() const { return triangles_.empty(); }
  bool holds(std::uint32_t triangle) const { return all() || triangles_[triangle] != 0; }
  /// 1 or 0 for each; empty: all.
  const std::vector<std::uint8_t>& triangles() const { return triangles_; }

  /// The view, counting only where it shows front sides of the part; low above high: nowhere.
  CoverView narrowed(const CoverView& view, const Mesh& mesh) const;
  /// The seams with both sides in the part. At others one side keeps its codes, and the other what
  /// the edit gave it.
  std::vector<SeamEdge> seams_within(std::span<const SeamEdge> seams) const;

 private:
  std::vector<std::uint8_t> triangles_;
};

}  // namespace normalshop
