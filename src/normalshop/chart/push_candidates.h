#pragma once

#include <cstdint>
#include <vector>

#include "normalshop/chart/edit_reach.h"
#include "normalshop/chart/storage.h"

/// Where a push has to look, private to floor 4.
namespace normalshop {

/// The triangles of one texture set that may hold points which an edit changes, and the tiles of
/// NormalMap::tile_size texels that they may lie in.
class PushCandidates {
 public:
  PushCandidates(const Mesh& mesh, const EditReach& reach, std::uint32_t texture_set, int width,
                 int height);

  /// Tells whether a triangle is one of them.
  auto wanted() const {
    return [marks = triangles_.data()](std::uint32_t triangle) { return marks[triangle] != 0; };
  }
  /// In texels.
  std::vector<Rect> tiles() const;

 private:
  bool may_change(const EditReach& reach, std::uint32_t triangle) const;
  void mark_tiles(std::uint32_t triangle);

  const Mesh& mesh_;
  std::uint32_t texture_set_;
  int width_;
  int height_;
  int tile_columns_;
  std::vector<std::uint8_t> triangles_;  // per triangle of the mesh
  std::vector<std::uint8_t> tiles_;
};

}  // namespace normalshop
