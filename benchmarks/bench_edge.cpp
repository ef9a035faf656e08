// Filters that keep edges, on 1 MP. The bilateral filter's peer is OpenCV's bilateralFilter on
// three float channels with the same kernel: 709 pixels, diameter 31. Compare processor times.
#include "support/relief.h"
#include <benchmark/benchmark.h>
#include <opencv2/imgproc.hpp>

#include "normalshop/core/parallel.h"
#include "normalshop/rgbn/bilateral.h"
#include "normalshop/rgbn/domain_transform.h"
#include "normalshop/rgbn/rolling_guidance.h"

namespace normalshop {
namespace {

constexpr int side = 1024;

/// Slopes with noise and colours with the same edges.
struct Picture {
  Picture() : slopes(test::with_noise(test::relief(side), 5.0F, 3)), color(side, side) {
    for (int y = 0; y < side; ++y) {
      for (int x = 0; x < side; ++x) {
        color(x, y) = Vec3f::Constant(0.5F) + 0.1F * normal_from_slope(slopes(x, y));
      }
    }
  }
  SlopeImage slopes;
  ColorImage color;
};

const Picture& picture() {
  static const Picture one;
  return one;
}

void count_pixels(benchmark::State& state) {
  state.counters["MP/s"] =
      benchmark::Counter(side * side * 1e-6, benchmark::Counter::kIsIterationInvariantRate);
}

constexpr BilateralOptions wide{.sigma_space = 8.0F, .guide_sigma = 0.0F};

void bilateral_peer_opencv(benchmark::State& state) {
  ColorImage color = picture().color;
  const cv::Mat source(side, side, CV_32FC3, color.data());
  cv::Mat out;
  for (auto _ : state) cv::bilateralFilter(source, out, 31, 0.1, 8.0);
  count_pixels(state);
}

void bilateral_6d_slopes(benchmark::State& state) {
  SlopeImage out(side, side);
  const RgbnView source = {picture().slopes, picture().color, {}};
  for (auto _ : state) bilateral(source, {out, {}}, out.rect(), wide);
  count_pixels(state);
}

void bilateral_6d_slopes_and_colours(benchmark::State& state) {
  SlopeImage out(side, side);
  ColorImage color(side, side);
  const RgbnView source = {picture().slopes, picture().color, {}};
  for (auto _ : state) bilateral(source, {out, color}, out.rect(), wide);
  count_pixels(state);
}

void bilateral_normals(benchmark::State& state) {
  SlopeImage out(side, side);
  for (auto _ : state) bilateral({picture().slopes, {}, {}}, {out, {}}, out.rect(), wide);
  count_pixels(state);
}

void rolling_guidance_normals(benchmark::State& state) {
  SlopeImage out(side, side);
  for (auto _ : state) rolling_guidance({picture().slopes, {}, {}}, {out, {}}, out.rect());
  count_pixels(state);
}

void domain_transform_normals_one_core(benchmark::State& state) {
  const ThreadLimit limit(1);
  SlopeImage out(side, side);
  for (auto _ : state) domain_transform({picture().slopes, {}, {}}, {out, {}}, out.rect());
  count_pixels(state);
}

void domain_transform_two_rolls_one_core(benchmark::State& state) {
  const ThreadLimit limit(1);
  SlopeImage out(side, side);
  for (auto _ : state) {
    domain_transform({picture().slopes, {}, {}}, {out, {}}, out.rect(), {.rolls = 2});
  }
  count_pixels(state);
}

void domain_transform_6d_one_core(benchmark::State& state) {
  const ThreadLimit limit(1);
  SlopeImage out(side, side);
  ColorImage color(side, side);
  const RgbnView source = {picture().slopes, picture().color, {}};
  for (auto _ : state) domain_transform(source, {out, color}, out.rect());
  count_pixels(state);
}

/// A dab of a brush: 64 x 64 pixels with what is read around them.
void domain_transform_dab(benchmark::State& state) {
  SlopeImage out(side, side);
  for (auto _ : state) {
    domain_transform({picture().slopes, {}, {}}, {out, {}}, {500, 500, 564, 564});
  }
}

#define NORMALSHOP_BENCHMARK(name) \
  BENCHMARK(name)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime()
NORMALSHOP_BENCHMARK(bilateral_peer_opencv);
NORMALSHOP_BENCHMARK(bilateral_6d_slopes);
NORMALSHOP_BENCHMARK(bilateral_6d_slopes_and_colours);
NORMALSHOP_BENCHMARK(bilateral_normals);
NORMALSHOP_BENCHMARK(rolling_guidance_normals);
NORMALSHOP_BENCHMARK(domain_transform_normals_one_core);
NORMALSHOP_BENCHMARK(domain_transform_two_rolls_one_core);
NORMALSHOP_BENCHMARK(domain_transform_6d_one_core);
NORMALSHOP_BENCHMARK(domain_transform_dab);

}  // namespace
}  // namespace normalshop

BENCHMARK_MAIN();
