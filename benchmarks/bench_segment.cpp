// Segmentation of 1 MP: the graph and a further coarseness apart. Peers: OpenCV's GraphSegmentation
// where the build finds libopencv-contrib-dev, and the paper's algorithm as a plain loop over edges
// sorted by std::sort, which neither smooths nor labels.
#include <algorithm>
#include <cmath>
#include <vector>

#include <benchmark/benchmark.h>
#ifdef NORMALSHOP_HAS_XIMGPROC
#include <opencv2/ximgproc/segmentation.hpp>
#endif

#include "normalshop/core/random.h"
#include "normalshop/core/slope.h"
#include "normalshop/rgbn/segment.h"

namespace normalshop {
namespace {

constexpr int side = 1024;
constexpr float coarseness = 1.0F;
constexpr int min_size = 50;

/// Tiles of two colours with bumps and noise.
struct Scene {
  SlopeImage slopes{side, side};
  ColorImage color{side, side};

  Scene() {
    Random random(1);
    for (int y = 0; y < side; ++y) {
      for (int x = 0; x < side; ++x) {
        const auto fx = static_cast<float>(x);
        const auto fy = static_cast<float>(y);
        const auto noise = [&] { return random.uniform(-0.05F, 0.05F); };
        slopes(x, y) = {0.7F * std::sin(fx * 0.031F) + noise(),
                        0.7F * std::cos(fy * 0.047F) + noise()};
        const float tile = (x / 93 + y / 71) % 2 == 0 ? 0.2F : 0.6F;
        color(x, y) = {tile + noise(), 0.5F * tile + noise(), 0.3F + noise()};
      }
    }
  }
  RgbnView view() const { return {slopes, color, {}}; }
};

void segment_build(benchmark::State& state) {
  const Scene scene;
  for (auto _ : state) benchmark::DoNotOptimize(SegmentGraph(scene.view()));
}
BENCHMARK(segment_build)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();

/// Coarseness in hundredths; the first is below what the graph was built for.
void segment_again(benchmark::State& state) {
  const Scene scene;
  const SegmentGraph graph(scene.view());
  std::uint32_t count = 0;
  for (auto _ : state) {
    count = graph.segment(static_cast<float>(state.range(0)) * 0.01F, min_size).count;
  }
  state.counters["segments"] = count;
}
BENCHMARK(segment_again)
    ->Arg(4)
    ->Arg(10)
    ->Arg(100)
    ->Arg(1000)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

void segment_in_one_call(benchmark::State& state) {
  const Scene scene;
  for (auto _ : state) benchmark::DoNotOptimize(segment(scene.view()));
}
BENCHMARK(segment_in_one_call)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

#ifdef NORMALSHOP_HAS_XIMGPROC
/// Smoothing, sorting and joining of the same six numbers a pixel.
void segment_peer_opencv(benchmark::State& state) {
  const Scene scene;
  cv::Mat image(side, side, CV_32FC(6));
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      const Vec3f n = normal_from_slope(scene.slopes(x, y));
      float* pixel = image.ptr<float>(y, x);
      std::copy_n(n.data(), 3, pixel);
      std::copy_n(scene.color(x, y).data(), 3, pixel + 3);
    }
  }
  const auto peer = cv::ximgproc::segmentation::createGraphSegmentation(0.8, coarseness, min_size);
  cv::Mat labels;
  for (auto _ : state) peer->processImage(image, labels);
}
BENCHMARK(segment_peer_opencv)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();
#endif

/// The paper's algorithm as one writes it down, on slopes and colours that are not smoothed.
struct PlainEdge {
  float weight;
  int a;
  int b;
};

int find(std::vector<int>& parents, int i) {
  while (parents[static_cast<std::size_t>(i)] != i) {
    i = parents[static_cast<std::size_t>(i)] =
        parents[static_cast<std::size_t>(parents[static_cast<std::size_t>(i)])];
  }
  return i;
}

std::vector<PlainEdge> plain_edges(const Scene& scene) {
  std::vector<PlainEdge> edges;
  const auto weight = [&](int x0, int y0, int x1, int y1) {
    return std::sqrt(
        (normal_from_slope(scene.slopes(x0, y0)) - normal_from_slope(scene.slopes(x1, y1)))
            .squaredNorm() +
        (scene.color(x0, y0) - scene.color(x1, y1)).squaredNorm());
  };
  constexpr int ways[4][2] = {{1, 0}, {-1, 1}, {0, 1}, {1, 1}};
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      for (const auto& way : ways) {
        const int x1 = x + way[0];
        const int y1 = y + way[1];
        if (x1 < 0 || x1 >= side || y1 >= side) continue;
        edges.push_back({weight(x, y, x1, y1), y * side + x, y1 * side + x1});
      }
    }
  }
  return edges;
}

void segment_peer_plain_loop(benchmark::State& state) {
  const Scene scene;
  for (auto _ : state) {
    std::vector<PlainEdge> edges = plain_edges(scene);
    std::sort(edges.begin(), edges.end(),
              [](const PlainEdge& a, const PlainEdge& b) { return a.weight < b.weight; });
    std::vector<int> parents(side * side);
    for (int i = 0; i < side * side; ++i) parents[static_cast<std::size_t>(i)] = i;
    std::vector<int> sizes(side * side, 1);
    std::vector<float> thresholds(side * side, coarseness);
    for (const bool small : {false, true}) {
      for (const PlainEdge& edge : edges) {
        const auto a = static_cast<std::size_t>(find(parents, edge.a));
        const auto b = static_cast<std::size_t>(find(parents, edge.b));
        const bool joins = small ? std::min(sizes[a], sizes[b]) < min_size
                                 : edge.weight <= std::min(thresholds[a], thresholds[b]);
        if (a == b || !joins) continue;
        parents[b] = static_cast<int>(a);
        sizes[a] += sizes[b];
        thresholds[a] = edge.weight + coarseness / static_cast<float>(sizes[a]);
      }
    }
    benchmark::DoNotOptimize(parents.data());
  }
}
BENCHMARK(segment_peer_plain_loop)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

}  // namespace
}  // namespace normalshop

BENCHMARK_MAIN();
