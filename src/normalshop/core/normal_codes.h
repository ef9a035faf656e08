#pragma once

#include <cmath>
#include <vector>

#include "normalshop/core/normal_map.h"

/// Rows of codes to rows of vectors and back: what NormalMap is made of. Vectors have y up.
namespace normalshop::codes {

/// Decoded vectors that are shorter or longer hold no direction.
inline constexpr float shortest_normal = 0.25F;
inline constexpr float longest_normal = 1e18F;

inline int normal_channels(const NormalConvention& convention) {
  return convention.two_channel ? 2 : 3;
}

/// The unit normal of a decoded vector; zero where it holds no direction.
inline Vec3f direction_of(const Vec3f& v) {
  const float length = v.norm();
  if (!(length >= shortest_normal && length <= longest_normal)) return Vec3f::Zero();  // NaN too
  return v / length;
}

/// The vector of one texel, with its own length.
Vec3f decode_texel(const RawImage& image, const NormalConvention& convention,
                   const CodeRange& range, int x, int y);

/// The vectors of `count` texels from (x, y) on to the right.
void decode_row(const RawImage& image, const NormalConvention& convention, int x, int count, int y,
                Vec3f* vectors);

/// Writes vectors[0] to vectors[count - 1] as the codes of texels x0 on. What codes of this type
/// can't hold keeps its direction: vectors beyond -1..1 are shortened, two-channel codes take unit
/// vectors, and what is not finite becomes the zero vector. Two-channel codes have no z below 0:
/// such vectors go to the horizon, straight up or down.
void encode_texels(const Vec3f* vectors, int count, const NormalConvention& convention,
                   RawImage& image, int x0, int y);

/// Texel x of row `to_y` takes the channels that hold no normal (from `first` on) from texel
/// columns[x] of row `from_y`; a channel that `from` lacks becomes opaque.
void copy_other_channels(const RawImage& from, int from_y, const std::vector<int>& columns,
                         RawImage& to, int to_y, int first);

}  // namespace normalshop::codes
