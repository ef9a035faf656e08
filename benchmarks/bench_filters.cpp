// Linear filters on 4096 x 4096 pixels of two channels. The peer of the Gaussian is OpenCV's
// GaussianBlur with its border replicated and its own choice of kernel size, on horizontal strips
// so that it uses all cores (it reads beyond a strip, so the pixels are those of one call). Ours
// and the peer's take turns in every iteration; times are of the processor, all cores together.
#include <algorithm>
#include <ctime>

#include "noise_image.h"
#include <benchmark/benchmark.h>
#include <opencv2/imgproc.hpp>

#include "normalshop/core/parallel.h"
#include "normalshop/rgbn/smooth.h"

namespace normalshop {
namespace {

constexpr int side = 4096;

double processor_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// The shortest of many runs.
struct Shortest {
  double seconds = 1e9;
  template <class Work>
  void measure(const Work& work) {
    const double start = processor_seconds();
    work();
    seconds = std::min(seconds, processor_seconds() - start);
  }
};

void blur_peer(const SlopeImage& source, SlopeImage& target, double sigma) {
  const cv::Mat from(side, side, CV_32FC2, const_cast<Vec2f*>(source.data()));
  cv::Mat to(side, side, CV_32FC2, target.data());
  constexpr int strip = side / 8;
  parallel_for(side / strip, 1, [&](std::size_t a, std::size_t b) {
    for (std::size_t i = a; i < b; ++i) {
      const cv::Range rows(static_cast<int>(i) * strip, static_cast<int>(i + 1) * strip);
      cv::Mat part = to.rowRange(rows);
      cv::GaussianBlur(from.rowRange(rows), part, cv::Size(), sigma, sigma, cv::BORDER_REPLICATE);
    }
  });
}

void gaussian(benchmark::State& state) {
  const double sigma = static_cast<double>(state.range(0)) * 0.1;
  const SlopeImage image = noise_image(side);
  SlopeImage ours(side, side, Vec2f::Zero());
  SlopeImage peers(side, side, Vec2f::Zero());
  Shortest our_time;
  Shortest peer_time;
  for (auto _ : state) {
    our_time.measure(
        [&] { smooth(image, {}, ours, image.rect(), {.sigma = static_cast<float>(sigma)}); });
    peer_time.measure([&] { blur_peer(image, peers, sigma); });
  }
  float apart = 0.0F;
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) apart = std::max(apart, (ours(x, y) - peers(x, y)).norm());
  }
  state.counters["ours_ms"] = our_time.seconds * 1e3;
  state.counters["peer_ms"] = peer_time.seconds * 1e3;
  state.counters["ratio"] = peer_time.seconds / our_time.seconds;
  state.counters["apart"] = static_cast<double>(apart);
}
BENCHMARK(gaussian)->Name("gaussian/tenths_of_sigma")->Arg(10)->Arg(20)->Arg(80)->Iterations(7);
BENCHMARK(gaussian)->Name("gaussian/tenths_of_sigma")->Arg(320)->Iterations(3);

}  // namespace
}  // namespace normalshop

BENCHMARK_MAIN();
