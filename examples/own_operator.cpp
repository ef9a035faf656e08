/// An operator of one's own: any function of the slopes. This one limits how steep details are,
/// which tames noise and leaves gentle forms as they are.
///
///     example_own_operator INPUT.png OUTPUT.png

#include <cstdio>

#include "normalshop/core/normal_map.h"
#include "normalshop/core/parallel.h"
#include "normalshop/core/slope.h"
#include "normalshop/io/conventions.h"
#include "normalshop/io/image_file.h"

using namespace normalshop;

namespace {

struct LimitOptions {
  float steepest = 0.5F;  ///< height per length; slopes far below it hardly change
};

/// The shape of the library's operators: views in, a span that the caller owns out, options last,
/// and the rectangle that changed as the result.
Rect limit_slopes(SlopeView source, SlopeSpan target, Rect region, const LimitOptions& options) {
  const auto rows = static_cast<std::size_t>(region.height());
  parallel_for(rows, 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) {
      const int y = region.y0 + static_cast<int>(row);
      for (int x = region.x0; x < region.x1; ++x) {
        const float steepness = source(x, y).norm() / options.steepest;
        target(x, y) = source(x, y) / std::sqrt(1.0F + steepness * steepness);
      }
    }
  });
  return region;
}

void limit_file(const char* input, const char* output) {
  RawImage codes = read_image(input);
  const NormalConvention convention = guess_convention(codes).convention;
  NormalMap map(std::move(codes), convention);
  SlopeImage slopes(map.width(), map.height());
  for (int y = 0; y < map.height(); ++y) {
    for (int x = 0; x < map.width(); ++x) slopes(x, y) = slope_from_normal(map.normal(x, y));
  }
  const Rect changed = limit_slopes(slopes, slopes, slopes.rect(), {});
  for (int y = changed.y0; y < changed.y1; ++y) {
    for (int x = changed.x0; x < changed.x1; ++x) {
      map.set_normal(x, y, normal_from_slope(slopes(x, y)));
    }
  }
  write_image(output, map.encode());
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: example_own_operator INPUT OUTPUT\n");
    return 2;
  }
  try {
    limit_file(argv[1], argv[2]);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
  return 0;
}
