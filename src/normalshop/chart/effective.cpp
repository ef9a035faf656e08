#include "normalshop/chart/effective.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <vector>

#include "normalshop/core/distance.h"
#include "normalshop/core/parallel.h"
#include "normalshop/core/sample.h"

namespace normalshop {

namespace {

constexpr float degrees = 3.14159265358979F / 180.0F;

/// How much deeper the base surface gets from pixel to pixel along a row and down a column, in
/// pixels. Grazing normals count as 80 degrees. Back faces are marked by `front` 0.
struct RowSlopes {
  std::vector<float> right;
  std::vector<float> down;
  std::vector<std::uint8_t> front;

  void read(const EditingChart& chart, int y) {
    const auto width = static_cast<std::size_t>(chart.grid.width());
    right.resize(width);
    down.resize(width);
    front.resize(width);
    const Vec3f* normals = chart.base_normal.row(y);
    for (std::size_t x = 0; x < width; ++x) {
      const float inverse = 1.0F / std::max(normals[x].z(), 0.17F);
      right[x] = -normals[x].x() * inverse;
      down[x] = normals[x].y() * inverse;
      front[x] = normals[x].z() > 0.0F ? 1 : 0;
    }
  }
};

/// Is there a depth step between two neighbouring pixels that see different triangles?
bool is_step(float z0, float z1, float expected0, float expected1, bool same_side, float inverse) {
  constexpr float nothing = -std::numeric_limits<float>::infinity();
  if (!(z0 > nothing) || !(z1 > nothing)) return false;
  if (!same_side) return true;
  const float expected = 0.5F * (expected0 + expected1);
  return std::abs((z1 - z0) * inverse - expected) > 2.0F + std::abs(expected);
}

/// Depth steps of a run of rows; each row is read once.
class StepFinder {
 public:
  StepFinder(const EditingChart& chart, Image<std::uint8_t>& steps)
      : chart_(chart), steps_(steps), inverse_(1.0F / chart.grid.pixel) {}

  void find(int first, int last) {
    for (int y = first; y < last; ++y) std::fill_n(steps_.row(y), steps_.width(), std::uint8_t{0});
    const int begin = std::max(first - 1, 0);
    const int end = std::min(last + 1, steps_.height());
    slopes_.read(chart_, begin);
    for (int y = begin; y < end; ++y) {
      if (y >= first && y < last) along(y);
      if (y + 1 >= end) break;
      below_.read(chart_, y + 1);
      down(y, y >= first, y + 1 < last);
      std::swap(slopes_, below_);
    }
  }

 private:
  void along(int y) {
    const std::uint32_t* ids = chart_.ids.triangle.row(y);
    const float* depth = chart_.ids.depth.row(y);
    std::uint8_t* out = steps_.row(y);
    for (int x = 0; x + 1 < steps_.width(); ++x) {
      if (ids[x] == ids[x + 1]) continue;
      const auto i = static_cast<std::size_t>(x);
      if (!is_step(depth[x], depth[x + 1], slopes_.right[i], slopes_.right[i + 1],
                   slopes_.front[i] == slopes_.front[i + 1], inverse_)) {
        continue;
      }
      out[x] = out[x + 1] = 1;
    }
  }

  void down(int y, bool mark_upper, bool mark_lower) {
    const std::uint32_t* ids = chart_.ids.triangle.row(y);
    const std::uint32_t* ids_below = chart_.ids.triangle.row(y + 1);
    const float* depth = chart_.ids.depth.row(y);
    const float* depth_below = chart_.ids.depth.row(y + 1);
    for (int x = 0; x < steps_.width(); ++x) {
      if (ids[x] == ids_below[x]) continue;
      const auto i = static_cast<std::size_t>(x);
      if (!is_step(depth[x], depth_below[x], slopes_.down[i], below_.down[i],
                   slopes_.front[i] == below_.front[i], inverse_)) {
        continue;
      }
      if (mark_upper) steps_(x, y) = 1;
      if (mark_lower) steps_(x, y + 1) = 1;
    }
  }

  const EditingChart& chart_;
  Image<std::uint8_t>& steps_;
  float inverse_;
  RowSlopes slopes_;
  RowSlopes below_;
};

}  // namespace

void find_depth_steps(const EditingChart& chart, Image<std::uint8_t>& steps) {
  steps.resize(chart.grid.width(), chart.grid.height());
  parallel_for(static_cast<std::size_t>(chart.grid.height()), 64,
               [&](std::size_t begin, std::size_t end) {
                 StepFinder(chart, steps).find(static_cast<int>(begin), static_cast<int>(end));
               });
}

void compute_weight(EditingChart& chart, const EffectiveOptions& options) {
  assert(options.full_angle >= 0.0F && options.full_angle < options.zero_angle &&
         options.zero_angle <= 90.0F && options.step_falloff >= 0.0F);
  const int width = chart.grid.width();
  assert(chart.base_normal.width() == width && chart.base_normal.height() == chart.grid.height());
  Image<std::uint8_t> steps;
  find_depth_steps(chart, steps);
  const float falloff = std::max(2.0F, options.step_falloff / chart.grid.pixel);
  const int limit = static_cast<int>(std::ceil(falloff)) + 1;
  const DistanceRows across(steps, limit);
  chart.weight.resize(width, chart.grid.height());
  const float low = std::cos(options.zero_angle * degrees);
  const float high = std::cos(options.full_angle * degrees);
  parallel_rows(chart.grid.height(), [&](int y) {
    for (int i = 0; i < across.pieces(); ++i) {
      const int begin = i * DistanceRows::piece;
      const int count = std::min(DistanceRows::piece, width - begin);
      float* weight = chart.weight.row(y) + begin;
      const Vec3f* normals = chart.base_normal.row(y) + begin;
      std::array<float, DistanceRows::piece> distance;
      const bool near = across.read(y, i, distance.data());
      for (int x = 0; x < count; ++x) weight[x] = smoothstep(low, high, normals[x].z());
      for (int x = 0; near && x < count; ++x) {
        weight[x] *= smoothstep(1.0F, falloff + 1.0F, distance[static_cast<std::size_t>(x)]);
      }
    }
  });
}

}  // namespace normalshop
