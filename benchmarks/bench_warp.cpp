// Warps of 1 MP, one call each. Peer: OpenCV's remap of two channels with its bicubic filter, which
// gets ready positions, knows no Jacobian and rounds positions to 1/32 pixel; on one thread, like
// the rows named one_thread.
#include <cmath>

#include "noise_image.h"
#include <benchmark/benchmark.h>
#include <opencv2/imgproc.hpp>

#include "normalshop/core/parallel.h"
#include "normalshop/rgbn/sketch_warp.h"
#include "normalshop/rgbn/warp_brush.h"

namespace normalshop {
namespace {

constexpr int side = 1024;
const Rect area = {0, 0, side, side};

void count_pixels(benchmark::State& state) {
  state.counters["MP/s"] =
      benchmark::Counter(side * side * 1e-6, benchmark::Counter::kIsIterationInvariantRate);
}

/// Enlarged by 1.5 and turned a little, so that one sample a pixel is taken everywhere, or with
/// brushes on it, which enlarge here and reduce there.
WarpLattice turned() {
  WarpLattice lattice(area, 4.0F);
  compose(lattice, lattice.all_nodes(), [](const Vec2d& p) {
    WarpPoint point;
    point.jacobian << 0.65, -0.15, 0.15, 0.65;
    point.position = point.jacobian * (p - Vec2d(500.0, 500.0)) + Vec2d(512.0, 512.0);
    return point;
  });
  return lattice;
}

WarpLattice brushed() {
  WarpLattice lattice(area, 4.0F);
  twirl(lattice, {512.0F, 512.0F}, {.radius = 500.0F, .strength = 0.7F});
  pinch(lattice, {300.0F, 400.0F}, {.radius = 250.0F, .strength = -0.7F});
  return lattice;
}

void warp_slopes(benchmark::State& state, const WarpLattice& lattice) {
  const ThreadLimit limit(1);
  const SlopeImage image = noise_image(side);
  SlopeImage out(side, side);
  for (auto _ : state) warp({image, {}, {}}, {out, {}}, area, map_of(lattice));
  count_pixels(state);
}
void warp_one_thread(benchmark::State& state) { warp_slopes(state, turned()); }
void warp_brushed_one_thread(benchmark::State& state) { warp_slopes(state, brushed()); }
BENCHMARK(warp_one_thread)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

void warp_peer_opencv_remap(benchmark::State& state) {
  cv::setNumThreads(1);
  SlopeImage image = noise_image(side);
  SlopeImage out(side, side);
  const WarpLattice lattice = turned();
  SlopeImage places(side, side);
  std::vector<WarpPoint> run(side);
  for (int y = 0; y < side; ++y) {
    lattice.points(0, y, run);
    for (int x = 0; x < side; ++x) {
      places(x, y) = run[static_cast<std::size_t>(x)].position.cast<float>();
    }
  }
  const cv::Mat source(side, side, CV_32FC2, image.data());
  const cv::Mat positions(side, side, CV_32FC2, places.data());
  cv::Mat target(side, side, CV_32FC2, out.data());
  for (auto _ : state) {
    cv::remap(source, target, positions, cv::Mat(), cv::INTER_CUBIC, cv::BORDER_REPLICATE);
  }
  count_pixels(state);
}
BENCHMARK(warp_peer_opencv_remap)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

BENCHMARK(warp_brushed_one_thread)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

void lattice_points_one_thread(benchmark::State& state) {
  const WarpLattice lattice = brushed();
  std::vector<WarpPoint> run(side);
  for (auto _ : state) {
    for (int y = 0; y < side; ++y) {
      lattice.points(0, y, run);
      benchmark::DoNotOptimize(run.data());
    }
  }
  count_pixels(state);
}
BENCHMARK(lattice_points_one_thread)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

void least_area_of_lattice(benchmark::State& state) {
  const WarpLattice lattice = brushed();
  for (auto _ : state) benchmark::DoNotOptimize(least_area(lattice).determinant);
}
BENCHMARK(least_area_of_lattice)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

/// There and back again, so that it does not come near to a fold.
void twirl_dab(benchmark::State& state) {
  WarpLattice lattice(area, 4.0F);
  WarpBrushOptions options{.radius = static_cast<float>(state.range(0)), .strength = 0.1F};
  for (auto _ : state) {
    twirl(lattice, {500.0F, 500.0F}, options);
    options.strength = -options.strength;
  }
}
BENCHMARK(twirl_dab)->Arg(50)->Arg(400)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

/// A boundary around 600 x 600 pixels and strokes for about so many unknowns.
void sketch(benchmark::State& state) {
  Stroke boundary;
  for (int i = 0; i < 100; ++i) {
    const float t = 6.2831853F * static_cast<float>(i) / 100.0F;
    boundary.push_back({{512.0F + 300.0F * std::cos(t), 512.0F + 300.0F * std::sin(t)}});
  }
  std::vector<SketchPair> pairs;
  for (int i = 0; i < 3; ++i) {
    const float y = 400.0F + 100.0F * static_cast<float>(i);
    pairs.push_back({{{{400.0F, y}}, {{620.0F, y}}}, {{{410.0F, y + 8.0F}}, {{620.0F, y - 8.0F}}}});
  }
  // 3 x 1885 pixels of boundary (value and gradient) and 3 x 220 pixels of strokes.
  const float spacing = (3.0F * 1885.0F + 660.0F) / static_cast<float>(state.range(0));
  const SketchWarpOptions options{.spacing = 4.0F, .point_spacing = spacing};
  for (auto _ : state) benchmark::DoNotOptimize(sketch_warp(boundary, pairs, options).miss);
}
BENCHMARK(sketch)->Arg(500)->Arg(1000)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

}  // namespace
}  // namespace normalshop

BENCHMARK_MAIN();
