// Operators of floor 2, single calls on 1 MP unless the name says otherwise. Peer of the Gaussian:
// OpenImageIO's ImageBufAlgo::convolve with a separable kernel of the same radius, and a plain
// separable loop.
#include <cmath>

#include "noise_image.h"
#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <benchmark/benchmark.h>

#include "normalshop/rgbn/combine.h"
#include "normalshop/rgbn/emboss.h"
#include "normalshop/rgbn/heatmap.h"
#include "normalshop/rgbn/pen.h"
#include "normalshop/rgbn/shade.h"
#include "normalshop/rgbn/sharpen.h"
#include "normalshop/rgbn/smooth.h"
#include "normalshop/rgbn/stamp.h"

namespace normalshop {
namespace {

constexpr int side = 1024;

void count_pixels(benchmark::State& state, double pixels) {
  state.counters["MP/s"] =
      benchmark::Counter(pixels * 1e-6, benchmark::Counter::kIsIterationInvariantRate);
}

void smooth_slopes(benchmark::State& state) {
  const SlopeImage image = noise_image(side);
  SlopeImage out(side, side);
  const SmoothOptions options{.sigma = static_cast<float>(state.range(0))};
  for (auto _ : state) smooth(image, {}, out, image.rect(), options);
  count_pixels(state, side * side);
}
BENCHMARK(smooth_slopes)
    ->Arg(1)
    ->Arg(3)
    ->Arg(5)
    ->Arg(8)
    ->Arg(9)
    ->Arg(12)
    ->Arg(30)
    ->Arg(100)
    ->Arg(500)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

void smooth_masked(benchmark::State& state) {
  const SlopeImage image = noise_image(side);
  const MaskImage valid(side, side, 0.5F);
  SlopeImage out(side, side);
  const SmoothOptions options{.sigma = static_cast<float>(state.range(0))};
  for (auto _ : state) smooth(image, valid, out, image.rect(), options);
  count_pixels(state, side * side);
}
BENCHMARK(smooth_masked)->Arg(5)->Arg(30)->Unit(benchmark::kMillisecond)->UseRealTime();

void smooth_peer_plain_loop(benchmark::State& state) {
  const SlopeImage image = noise_image(side);
  SlopeImage between(side, side);
  SlopeImage out(side, side);
  const int radius = 4 * static_cast<int>(state.range(0));
  std::vector<float> weights;
  for (int k = -radius; k <= radius; ++k) {
    const double t = static_cast<double>(k) / static_cast<double>(state.range(0));
    weights.push_back(static_cast<float>(std::exp(-0.5 * t * t)));
  }
  const auto pass = [&](const SlopeImage& from, SlopeImage& to, int dx, int dy) {
    for (int y = 0; y < side; ++y) {
      for (int x = 0; x < side; ++x) {
        Vec2f sum = Vec2f::Zero();
        for (int k = -radius; k <= radius; ++k) {
          sum += weights[static_cast<std::size_t>(k + radius)] *
                 from(std::clamp(x + k * dx, 0, side - 1), std::clamp(y + k * dy, 0, side - 1));
        }
        to(x, y) = sum;
      }
    }
  };
  for (auto _ : state) {
    pass(image, between, 1, 0);
    pass(between, out, 0, 1);
  }
  count_pixels(state, side * side);
}
BENCHMARK(smooth_peer_plain_loop)->Arg(5)->Unit(benchmark::kMillisecond)->UseRealTime();

void smooth_peer_openimageio(benchmark::State& state) {
  SlopeImage image = noise_image(side);
  const OIIO::ImageSpec spec(side, side, 2, OIIO::TypeDesc::FLOAT);
  OIIO::ImageBuf source(spec, image.data());
  OIIO::ImageBuf between(spec);
  OIIO::ImageBuf out(spec);
  const auto length = static_cast<float>(8 * state.range(0) + 1);
  const OIIO::ImageBuf across = OIIO::ImageBufAlgo::make_kernel("gaussian", length, 1.0F);
  const OIIO::ImageBuf down = OIIO::ImageBufAlgo::make_kernel("gaussian", 1.0F, length);
  for (auto _ : state) {
    OIIO::ImageBufAlgo::convolve(between, source, across);
    OIIO::ImageBufAlgo::convolve(out, between, down);
  }
  count_pixels(state, side * side);
}
BENCHMARK(smooth_peer_openimageio)->Arg(5)->Unit(benchmark::kMillisecond)->UseRealTime();

void sharpen_slopes(benchmark::State& state) {
  const SlopeImage image = noise_image(side);
  SlopeImage out(side, side);
  const SharpenOptions options{.sigma = 5.0F, .noise_sigma = 1.0F};
  for (auto _ : state) sharpen(image, {}, out, image.rect(), options);
  count_pixels(state, side * side);
}
BENCHMARK(sharpen_slopes)->Unit(benchmark::kMillisecond)->UseRealTime();

void combine_slopes(benchmark::State& state) {
  SlopeImage image = noise_image(side);
  const MaskImage mask(side, side, 0.5F);
  SlopeImage out(side, side);
  for (auto _ : state) combine_linear(image, image, mask, 0.5F, out, image.rect());
  count_pixels(state, side * side);
}
BENCHMARK(combine_slopes)->Unit(benchmark::kMillisecond)->UseRealTime();

/// A wave of 1000 points through 4000 x 4000 pixels.
void pen_wave_4000(benchmark::State& state) {
  Stroke stroke;
  for (int i = 0; i < 1000; ++i) {
    const float t = static_cast<float>(i) * 0.001F;
    stroke.push_back({{100.0F + 3800.0F * t, 2000.0F + 1500.0F * std::sin(12.0F * t)}});
  }
  PenOptions options;
  options.width = static_cast<float>(state.range(0));
  SlopeImage details(4000, 4000);
  MaskImage coverage(4000, 4000);
  for (auto _ : state) {
    pen(details, coverage, details.rect(), std::span<const Stroke>(&stroke, 1), options);
  }
}
BENCHMARK(pen_wave_4000)->Arg(3)->Arg(16)->Arg(200)->Unit(benchmark::kMillisecond)->UseRealTime();

/// A dab of 64 pixels in the middle of a short stroke, as a brush asks for it; the chart around it
/// is not touched.
void pen_dab_64(benchmark::State& state) {
  const Stroke stroke{{{480.0F, 500.0F}}, {{512.0F, 512.0F}}, {{540.0F, 530.0F}}};
  PenOptions options;
  options.width = 60.0F;
  SlopeImage details(side, side);
  MaskImage coverage(side, side);
  const Rect dab{480, 480, 544, 544};
  for (auto _ : state) pen(details, coverage, dab, std::span<const Stroke>(&stroke, 1), options);
}
BENCHMARK(pen_dab_64)->Unit(benchmark::kMillisecond)->UseRealTime();

/// The last dab of a stroke of 100 points, as far apart as a tenth of the width, as live editing
/// asks for it: the box around its last 5 points.
void pen_dab_wide(benchmark::State& state) {
  const auto width = static_cast<float>(state.range(0));
  Stroke stroke;
  Vec2f at(1200.0F, 200.0F);
  for (int i = 0; i < 100; ++i) {
    stroke.push_back({at});
    const float angle = 0.039F * static_cast<float>(i);
    at += 0.1F * width * Vec2f(std::cos(angle), std::sin(angle));
  }
  PenOptions options;
  options.profile = ProfileShape::Bump;
  options.width = width;
  options.height = 0.1F * width;
  SlopeImage details(2400, 2400);
  MaskImage coverage(2400, 2400);
  Vec2f low = at;
  Vec2f high = at;
  for (std::size_t i = stroke.size() - 5; i < stroke.size(); ++i) {
    low = low.cwiseMin(stroke[i].position);
    high = high.cwiseMax(stroke[i].position);
  }
  const int wide = reach(options);
  const Rect dab = intersect({static_cast<int>(low.x()) - wide, static_cast<int>(low.y()) - wide,
                              static_cast<int>(high.x()) + wide, static_cast<int>(high.y()) + wide},
                             details.rect());
  for (auto _ : state) pen(details, coverage, dab, std::span<const Stroke>(&stroke, 1), options);
  count_pixels(state, static_cast<double>(dab.width()) * dab.height());
}
BENCHMARK(pen_dab_wide)->Arg(97)->Arg(391)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

void pen_closed_step_2000(benchmark::State& state) {
  Stroke stroke;
  for (int i = 0; i < 400; ++i) {
    const float t = static_cast<float>(i) * 6.2831853F / 400.0F;
    stroke.push_back({{1000.0F + 800.0F * std::cos(t), 1000.0F + 700.0F * std::sin(t)}});
  }
  PenOptions options;
  options.profile = ProfileShape::Step;
  options.closed = true;
  options.width = 40.0F;
  SlopeImage details(2000, 2000);
  MaskImage coverage(2000, 2000);
  for (auto _ : state) {
    pen(details, coverage, details.rect(), std::span<const Stroke>(&stroke, 1), options);
  }
}
BENCHMARK(pen_closed_step_2000)->Unit(benchmark::kMillisecond)->UseRealTime();

void stamp_patch(benchmark::State& state) {
  Patch patch;
  patch.slopes = noise_image(512);
  StampOptions options;
  options.size = static_cast<float>(state.range(0));
  options.rotation = 30.0F;
  SlopeImage details(side, side);
  MaskImage coverage(side, side);
  for (auto _ : state) stamp(details, coverage, details.rect(), patch, {512.0F, 512.0F}, options);
}
BENCHMARK(stamp_patch)->Arg(64)->Arg(512)->Arg(1000)->Unit(benchmark::kMillisecond)->UseRealTime();

/// 20 rings of two contours with 40 points each.
void emboss_20_letters_3000x2000(benchmark::State& state) {
  Outline outline;
  for (int letter = 0; letter < 20; ++letter) {
    for (const float radius : {0.35F, -0.2F}) {
      std::vector<Vec2f> contour;
      for (int i = 0; i < 40; ++i) {
        const float t = 6.2831853F * static_cast<float>(i) / 40.0F;
        contour.push_back(
            {static_cast<float>(letter) + std::abs(radius) * std::cos(t), radius * std::sin(t)});
      }
      outline.push_back(contour);
    }
  }
  EmbossOptions options;
  options.size = 140.0F;
  SlopeImage details(3000, 2000);
  MaskImage coverage(3000, 2000);
  const Outline middle = centered(outline);
  for (auto _ : state) {
    emboss(details, coverage, details.rect(), middle, {1500.0F, 1000.0F}, options);
  }
}
BENCHMARK(emboss_20_letters_3000x2000)->Unit(benchmark::kMillisecond)->UseRealTime();

void shade_normals(benchmark::State& state) {
  const ColorImage normals(side, side, Vec3f(0.3F, 0.2F, 0.9F).normalized());
  ColorImage out(side, side);
  for (auto _ : state) shade(normals, normals, {}, {}, out);
  count_pixels(state, side * side);
}
BENCHMARK(shade_normals)->Unit(benchmark::kMillisecond)->UseRealTime();

void occlusion_of_heights(benchmark::State& state) {
  const MaskImage height(side, side, 0.0F);
  MaskImage out(side, side);
  for (auto _ : state) ambient_occlusion(height, 40.0F, out);
  count_pixels(state, side * side);
}
BENCHMARK(occlusion_of_heights)->Unit(benchmark::kMillisecond)->UseRealTime();

void heatmap_of_values(benchmark::State& state) {
  const MaskImage values(side, side, 0.4F);
  ColorImage out(side, side);
  for (auto _ : state) heatmap(values, 1.0F, out);
  count_pixels(state, side * side);
}
BENCHMARK(heatmap_of_values)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace normalshop

BENCHMARK_MAIN();
