#include "normalshop/chart/effective.h"

#include <algorithm>
#include <array>
#include <atomic>
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

FacingWeight::FacingWeight(const EffectiveOptions& options)
    : low_(std::cos(options.zero_angle * degrees)), high_(std::cos(options.full_angle * degrees)) {
  assert(options.full_angle >= 0.0F && options.full_angle < options.zero_angle &&
         options.zero_angle <= 90.0F);
}

float FacingWeight::operator()(float cosine) const { return smoothstep(low_, high_, cosine); }

EffectiveOptions effective_on(float model_size) {
  EffectiveOptions options;
  options.least_step = 5e-4F * model_size;
  options.step_falloff = 0.004F * model_size;
  return options;
}

void compute_weight(EditingChart& chart, const EffectiveOptions& options) {
  assert(options.step_falloff >= 0.0F);
  const int width = chart.grid.width();
  assert(chart.base_normal.width() == width && chart.base_normal.height() == chart.grid.height());
  Image<std::uint8_t> steps;
  find_depth_steps(chart, options.least_step, steps);
  const float falloff = std::max(2.0F, options.step_falloff / chart.grid.pixel);
  const int limit = static_cast<int>(std::ceil(falloff)) + 1;
  const DistanceRows across(steps, limit);
  chart.weight.resize(width, chart.grid.height());
  const FacingWeight facing(options);
  parallel_rows(chart.grid.height(), [&](int y) {
    for (int i = 0; i < across.pieces(); ++i) {
      const int begin = i * DistanceRows::piece;
      const int count = std::min(DistanceRows::piece, width - begin);
      float* weight = chart.weight.row(y) + begin;
      const Vec3f* normals = chart.base_normal.row(y) + begin;
      std::array<float, DistanceRows::piece> distance;
      const bool near = across.read(y, i, distance.data());
      for (int x = 0; x < count; ++x) weight[x] = facing(normals[x].z());
      for (int x = 0; near && x < count; ++x) {
        weight[x] *= smoothstep(1.0F, falloff + 1.0F, distance[static_cast<std::size_t>(x)]);
      }
    }
  });
}

bool limit_weight(EditingChart& chart, const EffectiveOptions& options, const Vec3f& direction,
                  const Rect& within) {
  const FacingWeight facing(options);
  std::atomic<bool> had = false;
  std::atomic<bool> has = false;
  parallel_rows(chart.weight.height(), [&](int y) {
    float* weight = chart.weight.row(y);
    const Vec3f* normals = chart.base_normal.row(y);
    for (int x = 0; x < chart.weight.width(); ++x) {
      if (!(weight[x] > 0.0F)) continue;
      const bool counts = within.contains(x, y);
      if (counts) had.store(true, std::memory_order_relaxed);
      weight[x] = std::min(weight[x], facing(normals[x].dot(direction)));
      if (counts && weight[x] > 0.0F) has.store(true, std::memory_order_relaxed);
    }
  });
  return has || !had;
}

}  // namespace normalshop
