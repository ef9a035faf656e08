#pragma once

#include <span>

#include "normalshop/core/image.h"

/// The recursions of the domain transform, private to this floor.
namespace normalshop {

/// Lines that are filtered side by side: columns, or rows after they are transposed.
inline constexpr int domain_lanes = 16;
/// Planes that are filtered in one go.
inline constexpr int domain_planes = 3;

/// Filters up to domain_planes planes of domain_lanes columns down and up again: in row y of
/// `count` becomes value = own + w (neighbour - own), where w is `weights` of that row and its
/// upper neighbour, squared `squarings` times. Rows are `stride` floats apart.
void filter_lanes(std::span<float* const> planes, const float* weights, std::ptrdiff_t stride,
                  int count, int squarings);

/// to[domain_lanes * x + r] = row r [x], x below `count`, a multiple of 4. Rows are `stride` floats
/// apart; there are `rows` of them, others read the last.
void transpose_lanes(const float* from, std::ptrdiff_t stride, int rows, int count, float* to);
/// The way back; only `rows` are written.
void transpose_back(const float* from, float* to, std::ptrdiff_t stride, int rows, int count);

}  // namespace normalshop
