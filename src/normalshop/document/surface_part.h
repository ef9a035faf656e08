#pragma once

#include <span>
#include <vector>

#include "normalshop/chart/cover.h"
#include "normalshop/chart/storage.h"
#include "normalshop/document/edit.h"
#include "normalshop/surface/seams.h"

namespace normalshop {

/// The edit with the feather of its part in object units: a texel is as long as that of which half
/// of the surface has smaller ones.
Edit with_feather_in_units(Edit edit, const Mesh& mesh, const StorageAtlas& storage);

/// Which triangles of a mesh an edit of the surface is for, and how far it acts on them.
class PartMask {
 public:
  /// Of Edit::part: all triangles of the charts that hold its points. Without these: all. Throws
  /// InvalidInput, naming the point, for one further from the surface than a twentieth of the
  /// model's size, and for a mask of a texture set that the model does not have.
  PartMask(const Edit& edit, const Mesh& mesh);

  bool all() const { return triangles_.empty(); }
  bool holds(std::uint32_t triangle) const { return all() || triangles_[triangle] != 0; }
  /// 1 or 0 for each; empty: all.
  const std::vector<std::uint8_t>& triangles() const { return triangles_; }

  /// Is there a mask?
  bool weighs() const { return !masks_.empty(); }
  /// What it says in a chart, its feather included.
  MaskImage weights(const Mesh& mesh, const EditingChart& chart) const;

  /// The view, counting only where it shows front sides of the part; low above high: nowhere.
  CoverView narrowed(const CoverView& view, const Mesh& mesh) const;
  /// The seams with both sides in the part. At others one side keeps its codes, and the other what
  /// the edit gave it.
  std::vector<SeamEdge> seams_within(std::span<const SeamEdge> seams) const;

 private:
  std::vector<std::uint8_t> triangles_;
  std::vector<std::shared_ptr<const MaskImage>> masks_;  // by texture set; empty: none
  float feather_ = 0.0F;
};

}  // namespace normalshop
