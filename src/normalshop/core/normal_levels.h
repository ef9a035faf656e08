#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "normalshop/core/image.h"
#include "normalshop/core/normal_map.h"

namespace normalshop {

/// Fills how much of texels x to x + count - 1 of row y counts, 0 to 1 each.
using CoverageReader = std::function<void(int x, int count, int y, float* coverage)>;

/// Variance and covariance of slopes around their mean.
struct SlopeVariance {
  float xx = 0.0F;
  float xy = 0.0F;
  float yy = 0.0F;
};

/// The mip levels of a normal map, as means of slopes (tangent space) or of unit vectors (other
/// spaces) over the area of each texel, and what the mean loses: the variance of the slopes below
/// it, which a renderer sees as roughness. Level 1 has half the map's width and height, rounded
/// down but at least 1; the last has one texel. Where a size is odd a texel covers two and a
/// fraction of those below it: every level is the area mean of the one below, and of one mean.
///
/// Texels that don't count (coverage 0, and those without direction) add nothing: no level mixes
/// what lies between charts into them. The results are the same bits for any number of threads.
///
/// Sources: thesis 5.3.2 (multiresolution atlas); Olano and Baker, "LEAN Mapping" (2010), of which
/// the moments are: M - B B^T is kept instead of M, which float would cancel out. In other spaces
/// the variance comes from the mean's length: Toksvig, "Mipmapping Normal Maps" (2004).
class NormalLevels {
 public:
  /// Without `covered` every texel counts. Throws InvalidInput when the map is empty.
  explicit NormalLevels(const NormalMap& map, const CoverageReader& covered = {});

  /// Texels of the map changed: recomputes those above them, to the bits of building all anew. The
  /// map has its size and space still.
  void update(const NormalMap& map, const Rect& texels, const CoverageReader& covered = {});

  /// The last level; 0 for a map of one texel. Levels count from 1.
  int last() const { return static_cast<int>(levels_.size()); }
  int width(int level) const { return at(level).width; }
  int height(int level) const { return at(level).height; }

  /// Share of the texel's area that counts.
  float coverage(int level, int x, int y) const { return at(level).row(y, 0)[x]; }
  /// Of the mean slopes or vectors, unit. Where nothing counts, that of the first coarser level
  /// where something does; zero if there is none.
  Vec3f normal(int level, int x, int y) const;
  /// 0 where nothing counts. In other spaces than tangent the same in all directions.
  SlopeVariance variance(int level, int x, int y) const;
  /// The level as a map of its own, in the convention's way of writing; its space is the map's.
  RawImage encode(int level, CodeType type, const NormalConvention& convention) const;
  /// Bytes that the levels take.
  std::size_t size_bytes() const;

 private:
  /// Rows of numbers, one plane behind the other: coverage, then means, then moments.
  struct Level {
    int width;
    int height;
    int planes;
    Image<float> values;
    float* row(int y, int plane) { return values.row(y) + std::ptrdiff_t{plane} * width; }
    const float* row(int y, int plane) const {
      return values.row(y) + std::ptrdiff_t{plane} * width;
    }
  };
  const Level& at(int level) const { return levels_[static_cast<std::size_t>(level) - 1]; }
  Level& at(int level) { return levels_[static_cast<std::size_t>(level) - 1]; }
  class Builder;

  NormalSpace space_;
  std::vector<Level> levels_;
};

/// What a surface of the given roughness looks like where slopes of that variance are not
/// resolved: alpha'^2 = alpha^2 + xx + yy, with GGX's (and Beckmann's) alpha = roughness^2, as glTF
/// has it. alpha^2 is twice the slopes' variance along an axis, of which the mean of both axes is
/// taken (LEAN, section 3; Olano and Baker 2010). At most 1. `roughness` is 0 to 1.
float widened_roughness(float roughness, const SlopeVariance& variance);

/// widened_roughness() of a level's texels as one channel of codes, 0 to 1. Throws InvalidInput
/// when the level is not one of 1 to levels.last(), or the roughness not 0 to 1.
RawImage roughness_map(const NormalLevels& levels, int level, float roughness, CodeType type);

}  // namespace normalshop
