// Curvature and styles on 2048 x 2048 pixels of waves with a gap. No peer: no library that we know
// has these on pictures of normals; the plain Gaussian of the same size is here as the measure.
#include <cmath>

#include <benchmark/benchmark.h>

#include "normalshop/core/slope.h"
#include "normalshop/rgbn/curvature.h"
#include "normalshop/rgbn/discontinuity_shadow.h"
#include "normalshop/rgbn/shade_curvature.h"
#include "normalshop/rgbn/shade_exaggerated.h"
#include "normalshop/rgbn/shade_lambert.h"
#include "normalshop/rgbn/shade_lines.h"
#include "normalshop/rgbn/shade_toon.h"
#include "normalshop/rgbn/smooth.h"

namespace normalshop {
namespace {

constexpr int side = 2048;
const Vec3f paper(1.0F, 1.0F, 1.0F);

/// Waves of many sizes; nothing in the outer twentieth.
const Image<Vec3f>& waves() {
  static const Image<Vec3f> normals = [] {
    Image<Vec3f> out(side, side, Vec3f::Zero());
    for (int y = side / 20; y < side - side / 20; ++y) {
      for (int x = side / 20; x < side - side / 20; ++x) {
        const auto u = static_cast<float>(x);
        const auto v = static_cast<float>(y);
        out(x, y) = normal_from_slope({std::sin(0.02F * u + 0.01F * v) + 0.3F * std::sin(0.31F * v),
                                       std::cos(0.013F * v) + 0.2F * std::cos(0.23F * u)});
      }
    }
    return out;
  }();
  return normals;
}

template <class T, class Draw>
void run(benchmark::State& state, const T& blank, const Draw& draw) {
  const Image<Vec3f>& normals = waves();
  Image<T> out(side, side, blank);
  for (auto _ : state) draw(normals, out);
  state.counters["MP/s"] = benchmark::Counter(static_cast<double>(side) * side * 1e-6,
                                              benchmark::Counter::kIsIterationInvariantRate);
}

void smooth_sigma_4(benchmark::State& state) {
  run(state, Vec2f(0.0F, 0.0F), [](const Image<Vec3f>&, Image<Vec2f>& out) {
    smooth(out, {}, out, out.rect(), {.sigma = 4.0F});
  });
}
BENCHMARK(smooth_sigma_4)->Unit(benchmark::kMillisecond)->UseRealTime();

void mean_curvature_sigma_1(benchmark::State& state) {
  run(state, 0.0F, [](const Image<Vec3f>& normals, MaskImage& out) {
    mean_curvature(normals, out, out.rect());
  });
}
BENCHMARK(mean_curvature_sigma_1)->Unit(benchmark::kMillisecond)->UseRealTime();

void principal_curvature_sigma_1(benchmark::State& state) {
  run(state, Curvature{}, [](const Image<Vec3f>& normals, Image<Curvature>& out) {
    curvature(normals, out, out.rect());
  });
}
BENCHMARK(principal_curvature_sigma_1)->Unit(benchmark::kMillisecond)->UseRealTime();

void lambert(benchmark::State& state) {
  run(state, paper, [](const Image<Vec3f>& normals, ColorImage& out) {
    shade_lambert(normals, {}, out, out.rect());
  });
}
BENCHMARK(lambert)->Unit(benchmark::kMillisecond)->UseRealTime();

void toon(benchmark::State& state) {
  run(state, paper, [](const Image<Vec3f>& normals, ColorImage& out) {
    shade_toon(normals, {}, out, out.rect());
  });
}
BENCHMARK(toon)->Unit(benchmark::kMillisecond)->UseRealTime();

void curvature_shading(benchmark::State& state) {
  run(state, paper, [](const Image<Vec3f>& normals, ColorImage& out) {
    shade_curvature(normals, {}, out, out.rect());
  });
}
BENCHMARK(curvature_shading)->Unit(benchmark::kMillisecond)->UseRealTime();

void exaggerated(benchmark::State& state) {
  run(state, paper, [](const Image<Vec3f>& normals, ColorImage& out) {
    shade_exaggerated(normals, {}, out, out.rect());
  });
}
BENCHMARK(exaggerated)->Unit(benchmark::kMillisecond)->UseRealTime();

void shadows(benchmark::State& state) {
  run(state, 0.0F, [](const Image<Vec3f>& normals, MaskImage& out) {
    discontinuity_shadow(normals, out, out.rect());
  });
}
BENCHMARK(shadows)->Unit(benchmark::kMillisecond)->UseRealTime();

void lines(benchmark::State& state) {
  run(state, paper,
      [](const Image<Vec3f>& normals, ColorImage& out) { shade_lines(normals, out, out.rect()); });
}
BENCHMARK(lines)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace normalshop

BENCHMARK_MAIN();
