#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "normalshop/core/pixel_vector.h"
#include "normalshop/rgbn/segment.h"

/// How the graph of a segmentation holds its edges, private to this floor.
namespace normalshop {

/// Weights as 16 bits in the same order: 5 of exponent and 11 of mantissa of a float from 2^-20.
inline constexpr std::uint32_t no_edge = 0xFFFFU;                ///< codes of weights are smaller
inline constexpr std::uint32_t least_weight_bits = 0x35800000U;  ///< of 2^-20

/// weight >= 0; NaN counts as very large.
inline std::uint16_t code_of_weight(float weight) {
  const auto bits = std::bit_cast<std::uint32_t>(weight);
  const std::uint32_t code = bits <= least_weight_bits ? 0 : (bits - least_weight_bits) >> 12U;
  return static_cast<std::uint16_t>(std::min(code, no_edge - 1));
}
inline float weight_of_code(std::uint32_t code) {
  return code == 0 ? 0.0F : std::bit_cast<float>(least_weight_bits + (code << 12U));
}

/// Codes of four edges a pixel, in a row: to the right, down left, down, down right; beyond a side
/// of the image the pixel on the other one.
using EdgeCodes = Image<std::uint16_t>;
inline constexpr std::array<int, 4> edge_dx = {1, -1, 0, 1};
inline constexpr std::array<int, 4> edge_dy = {0, 1, 1, 1};

/// Edges between nodes by weight, equal ones in scan order.
struct EdgeList {
  struct Edge {
    std::uint32_t a;
    std::uint32_t b;
  };
  PixelVector<Edge> edges;
  std::vector<std::uint32_t> starts;  ///< first edge of each code, and the end
};

/// The edges whose ends lie in different nodes, `nodes` telling each pixel's.
EdgeList sort_edges(const EdgeCodes& codes, const Image<std::uint32_t>& nodes);

/// Keeps the lightest of all edges between the same two of `count` nodes.
EdgeList without_parallels(const EdgeList& list, std::uint32_t count);

}  // namespace normalshop
