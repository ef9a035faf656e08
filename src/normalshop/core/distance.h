#pragma once

#include <cstdint>

#include "normalshop/core/image.h"

/// Euclidean distances from pixel centre to pixel centre.
namespace normalshop {

/// Distance in pixels to the nearest pixel that is set (1, all others 0), exact up to `limit`, else
/// `limit`: the nearest in each row first, then the least over the rows within `limit`.
void distance_to(const Image<std::uint8_t>& set, int limit, MaskImage& distance);

/// The same, read piece by piece by a caller that needs no whole image of it. Rows are cut into
/// pieces of `piece` pixels; those without a set pixel near cost nothing.
class DistanceRows {
 public:
  static constexpr int piece = 64;

  DistanceRows(const Image<std::uint8_t>& set, int limit);
  int pieces() const { return used_.width(); }  ///< of a row; the last one may be shorter
  /// Distances of piece i of row y; false, and nothing written, when all of them are `limit`.
  bool read(int y, int i, float* out) const;

 private:
  void fill(const Image<std::uint8_t>& set, int y);
  void fill_piece(const std::uint8_t* row, int begin, float* out) const;

  int limit_;
  Image<float> squared_;      ///< squared distance along the row
  Image<std::uint8_t> used_;  ///< per piece and row: `squared_` is filled
};

}  // namespace normalshop
