#include "normalshop/chart/effective.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "normalshop/chart/depth_steps.h"
#include "normalshop/core/distance.h"
#include "normalshop/core/parallel.h"
#include "normalshop/core/sample.h"

namespace normalshop {

namespace {

constexpr float degrees = 3.14159265358979F / 180.0F;

}  // namespace

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
