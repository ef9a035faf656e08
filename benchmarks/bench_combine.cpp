// Models of combination and a repeated patch, on 1 MP. Peer of the models: the linear one.
#include <benchmark/benchmark.h>

#include "normalshop/core/random.h"
#include "normalshop/rgbn/combine.h"
#include "normalshop/rgbn/stamp.h"

namespace normalshop {
namespace {

constexpr int side = 1024;

SlopeImage noise_image(std::uint32_t seed) {
  SlopeImage image(side, side);
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      const auto bits = hash(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y), seed);
      image(x, y) = {static_cast<float>(bits & 0xffffU) * 0x1p-15F - 1.0F,
                     static_cast<float>(bits >> 16U) * 0x1p-15F - 1.0F};
    }
  }
  return image;
}

void combine_model(benchmark::State& state) {
  const SlopeImage base = noise_image(1);
  const SlopeImage details = noise_image(2);
  const MaskImage mask(side, side, 0.5F);
  SlopeImage out(side, side);
  const CombineOptions options{.model = static_cast<CombineModel>(state.range(0))};
  for (auto _ : state) combine(base, details, mask, out, out.rect(), options);
  state.SetLabel(std::string(name_of(options.model)));
}
BENCHMARK(combine_model)->DenseRange(0, 5)->Unit(benchmark::kMillisecond)->UseRealTime();

void stamp_repeated_patch(benchmark::State& state) {
  Patch patch;
  patch.slopes = noise_image(3);
  StampOptions options;
  options.size = static_cast<float>(state.range(0));
  options.rotation = 30.0F;
  SlopeImage details(side, side);
  MaskImage coverage(side, side);
  for (auto _ : state) {
    stamp_repeated(details, coverage, details.rect(), patch, {512.0F, 512.0F}, options);
  }
}
BENCHMARK(stamp_repeated_patch)
    ->Arg(8)
    ->Arg(256)
    ->Arg(1500)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

}  // namespace
}  // namespace normalshop

BENCHMARK_MAIN();
