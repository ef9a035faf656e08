// Projection of slopes to the nearest surface. The peer solves the usual masked least squares
// (five-point stencil, half-pixel averaged slopes) by Eigen's conjugate gradients with incomplete
// Cholesky; it stops at a residual of 1e-4, ours at an error of the slopes of 1e-7.

#include <cmath>
#include <cstdint>
#include <vector>

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>
#include <benchmark/benchmark.h>

#include "normalshop/core/random.h"
#include "normalshop/rgbn/curl.h"
#include "normalshop/rgbn/project.h"

namespace normalshop {
namespace {

/// A smooth rotation, a smooth height and noise.
SlopeImage slopes(int size) {
  SlopeImage image(size, size);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const auto bits = hash(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y), 3);
      const float u = static_cast<float>(x) / static_cast<float>(size);
      const float v = static_cast<float>(y) / static_cast<float>(size);
      image(x, y) = {std::sin(6.0F * v) + static_cast<float>(bits & 0xffffU) * 0x1p-17F,
                     std::cos(5.0F * u) + static_cast<float>(bits >> 16U) * 0x1p-17F};
    }
  }
  return image;
}

enum class Shape { Full, Disc, Snakes };

MaskImage mask_of(Shape shape, int size) {
  MaskImage mask(size, size, 1.0F);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const double u = (x + 0.5) / size;
      const double v = (y + 0.5) / size;
      if (shape == Shape::Disc && std::hypot(u - 0.5, v - 0.5) > 0.48) mask(x, y) = 0.0F;
      if (shape != Shape::Snakes) continue;
      const double turn = 16.0 * v;  // a meander of 16 turns with 20 holes in each
      const double f = turn - std::floor(turn);
      const bool end = static_cast<int>(turn) % 2 == 1 ? u > 0.95 : u < 0.05;
      const double h = u * 20.0 - std::floor(u * 20.0) - 0.5;
      const bool hole = std::hypot(0.8 * h, f - 0.6) < 0.18;
      if (hole || (f < 0.15 && turn > 1.0 && !end)) mask(x, y) = 0.0F;
    }
  }
  return mask;
}

void report(benchmark::State& state, double size, int iterations) {
  state.counters["iterations"] = iterations;
  state.counters["ns/pixel"] =
      benchmark::Counter(size * size * 1e-9, benchmark::Counter::kIsIterationInvariantRate |
                                                 benchmark::Counter::kInvert);
}

void project_slopes(benchmark::State& state, Shape shape) {
  const int size = static_cast<int>(state.range(0));
  const SlopeImage image = slopes(size);
  const MaskImage mask = mask_of(shape, size);
  SlopeImage out(size, size);
  Projection done;
  for (auto _ : state) {
    done = project_to_integrable(image, mask, {.slopes = out}, out.rect());
  }
  report(state, size, done.iterations);
  state.counters["share before"] = done.removed_share;
  state.counters["share after"] = curl_share(out, mask);
}
BENCHMARK_CAPTURE(project_slopes, full, Shape::Full)
    ->Arg(512)
    ->Arg(1024)
    ->Arg(2048)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();
BENCHMARK_CAPTURE(project_slopes, disc, Shape::Disc)
    ->Arg(512)
    ->Arg(1024)
    ->Arg(2048)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();
BENCHMARK_CAPTURE(project_slopes, snakes, Shape::Snakes)
    ->Arg(512)
    ->Arg(1024)
    ->Arg(2048)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

/// Half-pixel averaged slopes along the edges between pixels, assembled and solved.
int peer(const SlopeImage& image, const MaskImage& mask, Eigen::VectorXd& height) {
  Image<int> index(image.width(), image.height(), -1);
  int count = 0;
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      if (mask(x, y) > 0.0F) index(x, y) = count++;
    }
  }
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::VectorXd right = Eigen::VectorXd::Zero(count);
  const auto edge = [&](int a, int b, double target) {
    if (a < 0 || b < 0) return;
    entries.emplace_back(a, a, 1.0);
    entries.emplace_back(b, b, 1.0);
    entries.emplace_back(a, b, -1.0);
    entries.emplace_back(b, a, -1.0);
    right[a] -= target;
    right[b] += target;
  };
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      const Vec2d here = image(x, y).cast<double>();
      if (x + 1 < image.width()) {
        edge(index(x, y), index(x + 1, y),
             0.5 * (here.x() + static_cast<double>(image(x + 1, y).x())));
      }
      if (y + 1 < image.height()) {
        edge(index(x, y), index(x, y + 1),
             -0.5 * (here.y() + static_cast<double>(image(x, y + 1).y())));
      }
    }
  }
  for (int i = 0; i < count; ++i) entries.emplace_back(i, i, 1e-9);
  Eigen::SparseMatrix<double> matrix(count, count);
  matrix.setFromTriplets(entries.begin(), entries.end());
  Eigen::ConjugateGradient<Eigen::SparseMatrix<double>, Eigen::Lower | Eigen::Upper,
                           Eigen::IncompleteCholesky<double>>
      solver;
  solver.setTolerance(1e-4);
  solver.compute(matrix);
  height = solver.solve(right);
  return static_cast<int>(solver.iterations());
}

void project_peer_eigen(benchmark::State& state, Shape shape) {
  const int size = static_cast<int>(state.range(0));
  const SlopeImage image = slopes(size);
  const MaskImage mask = mask_of(shape, size);
  Eigen::VectorXd height;
  int iterations = 0;
  for (auto _ : state) iterations = peer(image, mask, height);
  report(state, size, iterations);
}
BENCHMARK_CAPTURE(project_peer_eigen, disc, Shape::Disc)
    ->Arg(512)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();
BENCHMARK_CAPTURE(project_peer_eigen, snakes, Shape::Snakes)
    ->Arg(512)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

void curl_of_slopes(benchmark::State& state) {
  const int size = static_cast<int>(state.range(0));
  const SlopeImage image = slopes(size);
  MaskImage out(size, size);
  for (auto _ : state) curl(image, {}, out, out.rect());
  report(state, size, 0);
}
BENCHMARK(curl_of_slopes)
    ->Arg(2048)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

}  // namespace
}  // namespace normalshop

BENCHMARK_MAIN();
